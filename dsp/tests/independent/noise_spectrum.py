"""Spectrum of the micro-relief from its equation, and the constants fitted from it.

A gradient-noise octave with independent gradients of unit covariance has the 2-D power spectrum
|F(k_x)|^2 |D(k_y)|^2 + |D(k_x)|^2 |F(k_y)|^2 (F, D: transforms of w(d) and of d w(d)); along a straight line
it is integrated over the direction across. Octaves add in power.

Prints: variance and peak wavelength of one octave (dsp/src/gradient_noise_2d.rs); level, tail boost and
ratio polynomials (dsp/src/fractal_noise/gains.rs); third-octave levels expected at 0.1 m/s and 44.1 kHz
(dsp/tests/noise_figures.rs).      Run: python3 noise_spectrum.py   (numpy)
"""
import numpy as np


def fade(t):
    return t * t * t * (t * (t * 6 - 15) + 10)


M = 4096
d = (np.arange(-M, M) + 0.5) / M
w = 1 - fade(np.abs(d))
K = np.linspace(0, 24, 2401)
E = np.exp(-2j * np.pi * np.outer(K, d)) / M
F, D = (E @ w).real, np.abs(E @ (w * d))


def line_psd(f, theta, across=np.linspace(-12, 12, 2401)):
    c, s = np.cos(theta), np.sin(theta)
    kx, ky = f[:, None] * c - across * s, f[:, None] * s + across * c
    at = lambda k, table: np.interp(np.abs(k), K, table, right=0)
    psd = at(kx, D) ** 2 * at(ky, F) ** 2 + at(kx, F) ** 2 * at(ky, D) ** 2
    return psd.sum(1) * (across[1] - across[0])


f = np.geomspace(1e-3, 8, 400)
B = np.mean([line_psd(f, t) for t in np.radians([7.5, 37.5, 67.5])], 0)
print("variance", 2 * np.trapezoid(B, f), "peak wavelength, cells", 1 / f[np.argmax(f * B)])

CELLS = 16.384e-3 / 2.0 ** np.arange(12)


def total(k, alpha, weights, cells=CELLS, first=0):
    octaves = enumerate(zip(weights, cells), start=first)
    return sum(
        v**2 * 2.0 ** ((1 - alpha) * (i - 4)) * a * np.interp(k * a, f, B, left=B[0], right=0) for i, (v, a) in octaves
    )


ENDLESS = 16.384e-3 / 2.0 ** np.arange(-6, 30)
R = np.linspace(0, 1, 13)
level, boost = [], []
for alpha in 2.5 - 1.5 * R:
    k = np.geomspace(1e3 / 2**0.5, 1e3 * 2**0.5, 400)
    level.append(1 / np.sqrt(2 * np.trapezoid(total(k, alpha, np.ones(36), ENDLESS, -6), k)))
    k = np.geomspace(1 / 8e-3, 1 / 25e-6, 300)
    ideal = total(k, alpha, np.ones(36), ENDLESS, -6)
    error = lambda b: np.mean(np.log10(total(k, alpha, np.append(np.ones(11), b)) / ideal) ** 2)
    candidates = np.arange(1.05, 1.45, 0.0025)
    boost.append(candidates[np.argmin([error(b) for b in candidates])] - 1)
ratio = 2 ** (-0.75 * (1 - R))
for name, y, degree in (("level", level, 4), ("tail_boost", boost, 3), ("ratio", ratio, 4), ("1/ratio", 1 / ratio, 4)):
    y = np.array(y)
    c = np.polyfit(R, y, degree, w=1 / y)
    print(name, c[::-1].tolist(), "error", np.abs(np.polyval(c, R) / y - 1).max())

for r in (0.0, 1 / 3, 2 / 3, 1.0):
    alpha = 2.5 - 1.5 * r
    gain = np.interp(r, R, level)
    expected = []
    for centre in (20, 100, 500, 2500):
        k = np.geomspace(centre / 2 ** (1 / 6), centre * 2 ** (1 / 6), 100) / 0.1
        weights = np.append(np.ones(11), 1 + np.interp(r, R, boost))
        expected.append(10 * np.log10(2 * gain**2 * np.trapezoid(total(k, alpha, weights), k)))
    print("alpha", alpha, "third octaves at 20, 100, 500, 2500 Hz, dB re rms_at_1mm:", np.round(expected, 2).tolist())
