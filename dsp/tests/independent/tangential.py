"""Skin dragged sideways by a force that is known at every instant, by scipy's DOP853.

Shares nothing with the kernel but the equation m u'' + b u' + k u = F and its constants. Prints the positions, m, asserted in
dsp/tests/tangential.rs.
"""

import numpy as np
from scipy.integrate import solve_ivp

M = 1.7e-4
RATE = 44100.0


def force(t):
    return 0.3 + 0.1 * np.sin(2 * np.pi * 90 * t) + 0.05 * np.cos(2 * np.pi * 310 * t + 0.7)


for normal in (0.2, 1.0, 4.0):
    k, b = 1480 * normal**0.35, 1.78 * normal**0.35
    start = [force(0.0) / k, 0.0]
    at = np.array([10, 100, 441, 1000, 4410]) / RATE
    run = solve_ivp(lambda t, x: [x[1], (force(t) - b * x[1] - k * x[0]) / M], (0, 0.11), start, "DOP853", at, rtol=1e-12, atol=1e-16)
    print(normal, [f"{u:.10e}" for u in run.y[0]])
