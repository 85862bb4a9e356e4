"""Figures for tests/lattice.rs: a periodic cell read by scipy's interpolating cubic spline.

python3 lattice.py  (scipy 1.11 or later)
"""

import numpy as np
from scipy.ndimage import map_coordinates

W, H = 5, 4
T1, T2 = np.array([0.008, 0.001]), np.array([-0.003, 0.006])
cell = np.array([[((7 * x + 11 * y + 3 * x * y) % 13) * 1e-5 for x in range(W)] for y in range(H)])
for p in [(0.0, 0.0), (0.0123, -0.0045), (-0.1, 0.2), (0.00371, 0.00113), (1.5, -2.25)]:
    a, b = np.linalg.solve(np.column_stack([T1, T2]), np.array(p))
    at = [[(b % 1.0) * H - 0.5], [(a % 1.0) * W - 0.5]]
    print(p, repr(float(map_coordinates(cell, at, order=3, mode="grid-wrap")[0])))
