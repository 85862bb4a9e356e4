"""Figures for tests/normal_map.rs: Frankot and Chellappa's integration with numpy.

Run: python3 normal_map.py
"""
import numpy as np

W, H = 32, 24
y, x = np.mgrid[0:H, 0:W].astype(float)
nx = 2 * (0.5 + 0.2 * np.sin(0.4 * x + 0.1 * y)) - 1
ny = 2 * (0.5 + 0.15 * np.cos(0.3 * x - 0.5 * y)) - 1
nz = np.sqrt(1 - nx**2 - ny**2)  # gentle slopes: blue is not needed
p, q = -nx / nz, -ny / nz  # green points down the image
p, q = p - p.mean(), q - q.mean()
wx = 2 * np.pi * np.fft.fftfreq(W)[None, :] * np.ones((H, 1))
wy = 2 * np.pi * np.fft.fftfreq(H)[:, None] * np.ones((1, W))
wx[:, W // 2] = 0
wy[H // 2, :] = 0
k2 = wx**2 + wy**2
k2[k2 == 0] = np.inf
z = np.fft.ifft2(-1j * (wx * np.fft.fft2(p) + wy * np.fft.fft2(q)) / k2).real
for at in [(0, 0), (5, 7), (31, 23), (16, 3)]:
    print(f"({at[0]}, {at[1]}, {z[at[1], at[0]]:.12f}),")
