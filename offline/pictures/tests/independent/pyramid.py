"""Figures for tests/metamer.rs and tests/pyramid.rs: a steerable pyramid written with numpy alone.

Run: python3 pyramid.py
The filters are those of Simoncelli and Freeman as printed in the module doc of src/pyramid.rs, written
down once more here, undecimated, with numpy's FFT.
"""
import math

import numpy as np


def image(width, height):
    """A deterministic image that holds every frequency: a chirp times a ramp, plus a bump."""
    y, x = np.mgrid[0:height, 0:width].astype(float)
    return (np.sin(0.013 * x * x + 0.021 * y * y + 0.017 * x * y) * (1 + 0.02 * y)
            + np.exp(-((x - 20) ** 2 + (y - 15) ** 2) / 30))


def high(r):
    with np.errstate(divide="ignore"):
        h = np.cos(np.pi / 2 * np.log2(np.maximum(r, 1e-300) / np.pi))
    return np.where(r >= np.pi, 1.0, np.where(r <= np.pi / 2, 0.0, h))


def low(r):
    return np.sqrt(np.maximum(0.0, 1 - high(r) ** 2))


def bands(picture, count, orientations):
    height, width = picture.shape
    wx = 2 * np.pi * np.fft.fftfreq(width)[None, :]
    wy = 2 * np.pi * np.fft.fftfreq(height)[:, None]
    r, theta = np.hypot(wx, wy), np.arctan2(wy, wx)
    spectrum = np.fft.fft2(picture)
    norm = (2.0 ** (orientations - 1) * math.factorial(orientations - 1)
            / math.sqrt(orientations * math.factorial(2 * orientations - 2)))
    filters = [high(r)]
    chain = np.ones_like(r)
    for band in range(count):
        chain = chain * low(2.0 ** band * r)
        for k in range(orientations):
            angular = norm * np.abs(np.cos(theta - np.pi * k / orientations)) ** (orientations - 1)
            filters.append(chain * high(2.0 ** (band + 1) * r) * angular)
    filters.append(chain * low(2.0 ** count * r))
    assert np.allclose(sum(f * f for f in filters), 1.0, atol=1e-12)
    return [np.fft.ifft2(spectrum * f).real for f in filters]


if __name__ == "__main__":
    for width, height in [(64, 48), (63, 45)]:
        print(f"{width} x {height}")
        for index, band in enumerate(bands(image(width, height), 3, 4)):
            print(f"    ({index}, {band.std():.12f}, {band[7, 11]:.12f}),")
