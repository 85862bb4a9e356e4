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

levels = np.round((picture - picture.min()) * 255 / (picture.max() - picture.min())).astype(int)
rows = []
for side in (2, 4, 8, 16, 32):
    keys, counts = np.unique(
        np.stack([x.ravel() // side, y.ravel() // side, levels.ravel() // side]), axis=1, return_counts=True)
    p = counts / counts.sum()
    rows.append((-np.log(side), np.log(len(counts)), -(p * np.log(p)).sum(), -np.log((p ** 2).sum())))
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
