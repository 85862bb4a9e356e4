"""Reference figures for tests/analysis_against_numpy.rs, straight from the definitions (numpy only)."""
import numpy as np

W, H = 96, 64
y, x = np.mgrid[0:H, 0:W]
picture = ((7 * x * x + 13 * x * y + 5 * y * y + 3 * x) % 257 + 4 * x).astype(float)


def sfm(dx, dy):
    a = picture[max(0, -dy):H - max(0, dy), max(0, -dx):W - max(0, dx)]
    b = picture[max(0, dy):H - max(0, -dy), max(0, dx):W - max(0, -dx)]
    return np.mean((a - b) ** 2)


for shift in [(0, 0), (1, 0), (-17, 5), (48, 32), (-48, 11), (3, -32)]:
    print("sfm", shift, repr(sfm(*shift)))

# Columns: every unit of height between the lowest and the highest of a texel and its four neighbours is a voxel of its own.
levels = np.round((picture - picture.min()) * (min(W, H) // 4 - 1) / (picture.max() - picture.min())).astype(int)
voxels = []
for j in range(H):
    for i in range(W):
        beside = [levels[b, a] for a, b in ((i, j), (i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1))
                  if 0 <= a < W and 0 <= b < H]
        voxels += [(i, j, z) for z in range(min(beside), max(beside) + 1)]
voxels = np.array(voxels)
rows = []
for side in (1, 2, 4, 8, 16, 32):
    whole = voxels[(voxels[:, 0] < W // side * side) & (voxels[:, 1] < H // side * side)]
    # A column counts once in each cube it touches.
    touched = np.unique(np.column_stack([whole[:, :2], whole[:, :2] // side, whole[:, 2] // side]), axis=0)
    _, counts = np.unique(touched[:, 2:], axis=0, return_counts=True)
    p = counts / counts.sum()
    part = (W // side * side) * (H // side * side) / (W * H)
    rows.append((-np.log(side), np.log(len(counts) / part), -(p * np.log(p)).sum() - np.log(part),
                 -np.log((p ** 2).sum() * part)))
rows = np.array(rows)
for k, name in enumerate(("box", "information", "correlation"), 1):
    print(name, repr(np.polyfit(rows[:, 0], rows[:, k], 1)[0]))

lag = 17
squares = np.concatenate([((picture[:, lag:] - picture[:, :-lag]) ** 2).ravel(),
                          ((picture[lag:] - picture[:-lag]) ** 2).ravel()])
heights = (picture - picture.min()) * 7.0 / np.sqrt(squares.mean())
line = []
for side in (3, 5, 7, 9, 13, 17):
    r = side // 2
    centre = heights[8:H - 8, 8:W - 8]
    m = sum((abs(heights[8 + j:H - 8 + j, 8 + i:W - 8 + i] - centre) <= r).astype(int)
            for j in range(-r, r + 1) for i in range(-r, r + 1))
    line.append((np.log(side), np.log(np.mean(1.0 / m))))
line = np.array(line)
print("probability", repr(-np.polyfit(line[:, 0], line[:, 1], 1)[0]))

hurst = []
for z in (picture, picture.T):
    one, two = abs(np.diff(z, axis=1)).mean(axis=1), abs(z[:, 2:] - z[:, :-2]).mean(axis=1)
    hurst.append(np.log2(two / one))
print("madogram", repr(3 - np.median(np.concatenate(hurst))))
