"""Shape of the elastic Hertz pulse, and its fit by polynomials in w = 4 u (1 - u).

Integrates m x'' = -k x^1.5 with scipy (DOP853, rtol 1e-13), scales time by the contact time and force by its
area, and prints: the constants of contact time and compression, the fits with their relative L2 errors, a table of the
shape, and the spectrum of the pulse at a few f * tau. The figures are used in dsp/src/hertz and dsp/tests/hertz.rs.
"""

import numpy as np
from scipy.integrate import quad, solve_ivp

# m = k = 1, v = 1
done = lambda t, s: s[0]
done.terminal, done.direction = True, -1
run = solve_ivp(lambda t, s: [s[1], -max(s[0], 0.0) ** 1.5], [0, 10], [0.0, 1.0], method="DOP853",
                rtol=1e-13, atol=1e-15, events=done, dense_output=True)
tau = run.t_events[0][0]
xmax = (5 / 4) ** 0.4
print(f"tau v / xmax = {tau / xmax:.8f}")
# tau = c (m^2 / (R E^2 v))^(1/5) with k = 4/3 E sqrt(R): xmax = (15/16)^0.4 (m^2 v^4 / (E^2 R))^0.2
print(f"material form = {tau / xmax * (15 / 16) ** 0.4:.8f}")
force = lambda u: max(run.sol(u * tau)[0], 0.0) ** 1.5 * tau / 2  # area 1 over u in 0..1: J = 2 m v
print(f"area = {quad(force, 0, 1, epsabs=1e-12, limit=200)[0]:.10f}  peak = {force(0.5):.8f}")

u = (np.arange(4000) + 0.5) / 4000
p = np.array([force(v) for v in u])
w = 4 * u * (1 - u)
# ∫ w^j du over 0..1
from math import factorial
area = lambda j: 4.0**j * factorial(j) ** 2 / factorial(2 * j + 1)
for degree in (4, 5, 6):
    powers = np.arange(1, degree + 1)
    basis = np.stack([w**j for j in powers], axis=1)
    # Least squares with the area held at 1: eliminate the first coefficient.
    areas = np.array([area(j) for j in powers])
    reduced = basis[:, 1:] - np.outer(basis[:, 0], areas[1:] / areas[0])
    rest = np.linalg.lstsq(reduced, p - basis[:, 0] / areas[0], rcond=None)[0]
    c = np.concatenate([[(1 - areas[1:] @ rest) / areas[0]], rest])
    err = basis @ c - p
    print(degree, [f"{x:.10f}" for x in c], "L2", np.sqrt(np.mean(err**2) / np.mean(p**2)), "max/peak",
          np.abs(err).max() / p.max())
print("shape at u = 0.05 ... 0.5:", [f"{force(x):.7f}" for x in np.arange(1, 11) * 0.05])
f = [0.1, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0]
uu, ww = np.polynomial.legendre.leggauss(400)
uu, ww = (uu + 1) / 2, ww / 2
pp = np.array([force(v) for v in uu])
print("spectrum at f tau =", f, [f"{np.sum(ww * pp * np.cos(2 * np.pi * x * (uu - 0.5))):.8f}" for x in f])
print("variance of the shape over u:", f"{quad(lambda x: force(x) * (x - 0.5) ** 2, 0, 1, epsabs=1e-12, limit=200)[0]:.8f}")
