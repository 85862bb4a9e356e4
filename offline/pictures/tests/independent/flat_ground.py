"""Figures for tests/flat_ground.rs: fast marching from a flat ground, written apart with numpy and heapq.

Run: python3 flat_ground.py
"""
import heapq
import numpy as np

N = 48
y, x = np.mgrid[0:N, 0:N].astype(float)
z = 4 * np.exp(-((x - 20) ** 2 + 2 * (y - 26) ** 2) / 60)
p = z - np.concatenate([z[:, :1], z[:, :-1]], axis=1)
q = z - np.concatenate([z[:1], z[:-1]], axis=0)
image = 1 / np.sqrt(1 + p * p + q * q)
# Nothing is known of the borders but that the Gaussian has ended there: the image tiles.
pad = lambda a, dx, dy: np.roll(a, (dy, dx), (0, 1))
smooth = 0.5 * image + 0.125 * sum(pad(image, *d) for d in [(1, 0), (-1, 0), (0, 1), (0, -1)])
low, high = smooth.min(), smooth.max()
level = ((smooth - low) * 255 / (high - low)).astype(int)
crowd = np.bincount(level.ravel(), minlength=256)
common = max(range(128, 256), key=lambda i: (crowd[i - 4 : i + 5].sum(), i))
facing = low + (common + 0.5) * (high - low) / 255
scatter = lambda f: max(np.sort(smooth[smooth > f] - f)[(smooth > f).sum() // 2] / 0.6745, 0.01 / 3 * f)
spread = scatter(facing)
for _ in range(3):
    facing = smooth[abs(smooth - facing) <= 2 * spread].mean()
    spread = scatter(facing)
ground = smooth >= facing - 3 * spread
# Connected through the border it is one area but for the summit's own flat top.
label = np.zeros((N, N), int)
count = 0
for start in zip(*np.nonzero(ground)):
    if label[start]:
        continue
    count += 1
    stack = [start]
    label[start] = count
    while stack:
        i, j = stack.pop()
        for a, b in ((i + 1) % N, j), ((i - 1) % N, j), (i, (j + 1) % N), (i, (j - 1) % N):
            if ground[a, b] and not label[a, b]:
                label[a, b] = count
                stack.append((a, b))
seeds = label == 1 + np.argmax([(label == k).sum() for k in range(1, count + 1)])
slope = np.where(ground, 0, np.sqrt(np.maximum((facing / smooth) ** 2 - 1, 0)))
height = np.where(seeds, 0.0, np.inf)
heap = [(0.0, i, j) for i, j in zip(*np.nonzero(seeds))]
done = np.zeros((N, N), bool)
while heap:
    _, i, j = heapq.heappop(heap)
    if done[i, j]:
        continue
    done[i, j] = True
    for a, b in ((i + 1) % N, j), ((i - 1) % N, j), (i, (j + 1) % N), (i, (j - 1) % N):
        if done[a, b]:
            continue
        u = min(height[a, (b - 1) % N], height[a, (b + 1) % N])
        v = min(height[(a - 1) % N, b], height[(a + 1) % N, b])
        f, (lo, hi) = slope[a, b], sorted((u, v))
        h = lo + f if hi - lo >= f else 0.5 * (lo + hi + np.sqrt(2 * f * f - (hi - lo) ** 2))
        if h < height[a, b]:
            height[a, b] = h
            heapq.heappush(heap, (h, a, b))
for at in [(20, 26), (16, 24), (24, 29), (12, 26)]:
    print(f"({at[0]}, {at[1]}, {height[at[1], at[0]]:.12f}),")
