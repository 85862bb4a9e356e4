"""Responses of three modes to a seeded impulse train, by scipy.signal.lfilter in double precision.

Numerators come from the impulse response a e^(-d t) sin(2 pi f t + phi) sampled at t = 0 and one step, so that this
script shares no formula with the bank beyond the definition of a mode. Prints the values asserted in dsp/tests/modal_bank.rs.
"""

import numpy as np
from scipy.signal import lfilter

modes = [(440.0, 12.0, 0.8, 0.0), (3217.5, 55.0, 0.5, 1.1), (61.7, 3.0, 1.3, -0.6)]
for rate in (44100.0, 192000.0):
    n = int(rate * 0.5)
    # Impulses at fixed times in seconds, so that the answer barely depends on the rate.
    u = np.zeros(n)
    for k, (t, j) in enumerate([(0.0, 1e-3), (0.05, -4e-4), (0.1, 7e-4)]):
        u[int(round(t * rate))] = j
    y = np.zeros(n)
    for f, d, a, phi in modes:
        h = lambda k: a * np.exp(-d * k / rate) * np.sin(2 * np.pi * f * k / rate + phi)
        r, theta = np.exp(-d / rate), 2 * np.pi * f / rate
        den = [1.0, -2 * r * np.cos(theta), r * r]
        num = [h(0), h(1) + den[1] * h(0)]
        y += lfilter(num, den, u)
    at = [int(round(t * rate)) for t in (0.0, 0.001, 0.03, 0.06, 0.11, 0.25, 0.49)]
    print(int(rate), [(i, float(f"{y[i]:.9e}")) for i in at], f"rms {np.sqrt(np.mean(y**2)):.9e}")
