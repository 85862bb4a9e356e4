"""Pulse of an impact that parts with restitution e, and its fit by three elastic pulses with the same onset.

Integrates m x'' = -k x^1.5 (1 + a x'/v), a (1 + e) = ln((1 + a) / (1 - a e)), with scipy; fits shares and lengths of three
pulses p(t / r tau) as cubic polynomials of 1 - e to the spectra up to 5 / tau by least squares, and prints them, the restitution
with which the bodies part, and how far third octaves and peaks are off. The figures are used in dsp/src/hertz/restitution.rs.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, least_squares

RESTITUTIONS = np.array([0.97, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05])


def pulse(e):
    a = 0.0 if e == 1 else brentq(lambda a: a * (1 + e) - np.log((1 + a) / (1 - a * e)), 1e-6, (1 - 1e-12) / e)
    law = lambda t, s: [s[1], -max(s[0], 0.0) ** 1.5 * (1 + a * s[1])]
    done = lambda t, s: s[0] if t > 1e-3 else 1.0
    done.terminal, done.direction = True, -1
    run = solve_ivp(law, [0, 40], [0.0, 1.0], rtol=1e-11, atol=1e-14, events=done, dense_output=True)
    t = np.linspace(0, run.t[-1], 4096)
    x, v = run.sol(t)
    force = np.maximum(x, 0) ** 1.5 * (1 + a * v)
    return -v[-1], t, force / np.trapezoid(force, t)


_, t1, force1 = pulse(1.0)
tau = t1[-1]
x = np.linspace(0, 12, 4801)
elastic = np.trapezoid(force1 * np.exp(-2j * np.pi * np.outer(x / tau, t1)), t1, axis=1)
f = np.arange(0, 5, 0.05)
shape = lambda u: np.interp(u, t1 / tau, force1 * tau, left=0, right=0)
spectrum = lambda f: np.interp(f, x, elastic.real) + 1j * np.interp(f, x, elastic.imag)
targets = [pulse(e) for e in RESTITUTIONS]
wanted = [np.trapezoid(y * np.exp(-2j * np.pi * np.outer(f / tau, t)), t, axis=1) for _, t, y in targets]


def parts(q, e):
    powers = (1 - e) ** np.arange(4)
    shares = [q[i] @ powers[1:] for i in range(2)]
    return [*shares, 1 - sum(shares)], [max(0.01, first + row @ powers[1:]) for first, row in zip(q[5], q[2:5])]


def rows(q):
    q = q.reshape(-1, 3)
    return [*q[:5], q[5]]


def residual(q):
    out = []
    for e, exact in zip(RESTITUTIONS, wanted):
        made = sum(w * spectrum(f * r) for w, r in zip(*parts(rows(q), e)))
        apart = (made - exact) / np.maximum(abs(exact), 0.02)
        out += [apart.real, apart.imag]
    return np.concatenate([*out, 1e-3 * q])


start = np.zeros((6, 3))
start[:2, 0], start[5] = 0.3, [0.5, 0.75, 1.0]
fit = least_squares(residual, start.ravel(), max_nfev=500).x
print(np.round(fit.reshape(-1, 3), 4), "\n(two shares, three lengths, the lengths at e = 1)")
centres = 2 ** (np.arange(-8, 7) / 3)
bands = [(f >= c * 2 ** (-1 / 6)) & (f < c * 2 ** (1 / 6)) for c in centres]
for e, exact, (parted, t, force) in zip(RESTITUTIONS, wanted, targets):
    w, r = parts(rows(fit), e)
    made = sum(w * spectrum(f * r) for w, r in zip(w, r))
    apart = [10 * np.log10(np.mean(abs(made[b]) ** 2) / np.mean(abs(exact[b]) ** 2)) for b in bands if b.any()]
    peak = max(sum(w / r * shape(u / r) for w, r in zip(w, r)) for u in np.linspace(0, 1, 1000))
    print(f"e {e}: parts with {parted:.4f}, lasts {t[-1] / tau:.3f} tau, third octaves {np.round(apart, 1)} dB,"
          f" peak {peak:.3f} for {force.max() * tau:.3f}")
