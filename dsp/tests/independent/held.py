"""Exact eigenvalues of bodies that fingers press on: modes, skin and finger as one linear system, by numpy.

Shares nothing with the kernel but the masses and springs. A body has 12 modes with mass-normalised shapes at the pressed places; every finger adds its
skin and its finger as two more masses. Prints dsp/tests/independent/held_reference.csv, read by
dsp/tests/held.rs: mass, frequencies, decays, motions at the place, held frequency and
decay of each mode, one mode a line. Bodies are random and were not looked at when the kernel was written.
"""

import numpy as np

MS, KS, BS, MF, KM = [float(x) for x in __import__("sys").argv[1:6]]
HAND = 2 * np.pi * 5
rng = np.random.default_rng(20261123)


def poles(f, d, phi, t):
    n = len(f)
    w2 = (2 * np.pi * f) ** 2 + d * d
    size = n + 2
    m = np.diag([1.0] * n + [MS, MF])
    k = np.zeros((size, size))
    c = np.zeros((size, size))
    k[:n, :n], c[:n, :n] = np.diag(w2), np.diag(2 * d)
    # t switches the contact spring on, so that each pole can be followed.
    e = np.zeros(size)
    e[:n], e[n] = phi, -1
    k += t * KM * np.outer(e, e)
    e = np.zeros(size)
    e[n], e[n + 1] = 1, -1
    k += KS * np.outer(e, e)
    c += BS * np.outer(e, e)
    k[n + 1, n + 1] += (MS + MF) * HAND**2
    c[n + 1, n + 1] += 2 * (MS + MF) * HAND
    a = np.block([[np.zeros((size, size)), np.eye(size)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    return np.linalg.eigvals(a)


for mass in (0.1, 0.15, 0.3, 0.6, 1.0, 2.0, 5.0):
    for body in range(4):
        f = np.sort(rng.uniform(1, 1.6, 12).cumprod() * rng.uniform(80, 260))
        d = 0.5 * (2.0 + 2e-3 * 2 * np.pi * f)
        # Free bodies: a modal mass of a quarter of the body where it swings most.
        phi = 2 / np.sqrt(mass) * np.cos(rng.uniform(0, 2 * np.pi, 12))
        now = -d + 2j * np.pi * f
        for t in np.geomspace(1e-6, 1.0, 400):
            all_poles = poles(f, d, phi, t)
            now = np.array([all_poles[np.argmin(abs(all_poles - s))] for s in now])
        for a, b, c, s in zip(f, d, phi, now):
            print(f"{mass},{a:.6f},{b:.6f},{c:.6f},{s.imag / 2 / np.pi:.6f},{-s.real:.6f}")
