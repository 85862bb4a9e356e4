"""Figures for tests/height_map_figures.rs: scipy's cubic spline interpolation of a small map.

Run: python3 spline.py   (numpy, scipy)
"""
import numpy as np
from scipy.ndimage import map_coordinates

x, y = np.meshgrid(np.arange(7), np.arange(5))
texels = ((x * 37 + y * 91 + x * x * y * 13) % 101) / 101.0
points = [(0.0, 0.0), (0.3, 0.7), (3.25, 1.5), (6.4, 4.2), (-0.35, 2.1), (5.9, -0.45)]  # texel coordinates x, y
for wrap, mode in (("Repeat", "grid-wrap"), ("Mirror", "reflect"), ("Clamp", "nearest")):
    v = map_coordinates(texels, [[p[1] for p in points], [p[0] for p in points]], order=3, mode=mode, prefilter=True)
    print(wrap, [float(f"{q:.9f}") for q in v])
