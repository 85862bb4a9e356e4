"""Periods of one damped mode rubbed by a steady sweep, by scipy's DOP853 with events at both ends of every slip.

Shares nothing with the kernel but the equations: m y'' + 2 m d y' + m (w^2 + d^2) y = F, F = N mu(u) while it slips with u = V - y' > 0, y' = V
while it sticks, until the force that this needs exceeds mu_s N. Prints the rows asserted in dsp/tests/stick_slip.rs.
"""

import numpy as np
from scipy.integrate import solve_ivp

CASES = [
    # f, d, m, N, V, mu_s, mu_k, u_s
    (110.0, 4.0, 0.20, 2.0, 0.004, 0.8, 0.30, 0.002),
    (220.0, 20.0, 0.05, 1.0, 0.010, 0.6, 0.20, 0.005),
    (440.0, 30.0, 0.02, 3.0, 0.030, 0.9, 0.35, 0.010),
    (880.0, 15.0, 0.01, 1.5, 0.010, 0.7, 0.30, 0.004),
]

for f, d, m, n, v, ms, mk, us in CASES:
    w2 = (2 * np.pi * f) ** 2 + d * d
    mu = lambda u: mk + (ms - mk) / (1 + abs(u) / us)
    slip = lambda t, x: [x[1], n * mu(v - x[1]) / m - 2 * d * x[1] - w2 * x[0]]
    caught = lambda t, x: v - x[1]
    caught.terminal, caught.direction = True, -1
    # Stuck: m w2 y + 2 m d v = mu_s N is where it lets go.
    y_off = (ms * n / m - 2 * d * v) / w2
    t, begun = 0.0, []
    for cycle in range(40):
        begun.append(t)
        # The instant of letting go has u = 0: step off it by the acceleration that the falling curve leaves.
        # u grows from 0 by an unstable root; a seed of 1e-9 of V stands for it (a factor of 100 changes the period by the 6th digit).
        run = solve_ivp(slip, (0, 40 / f), [y_off, v * (1 - 1e-9)], "DOP853", events=caught, rtol=1e-11, atol=1e-15)
        if not run.t_events[0].size:
            break
        y_on = run.y_events[0][0][0]
        t += run.t_events[0][0] + (y_off - y_on) / v
    if cycle < 39:
        print("no stick:", f)
        continue
    print([f, d, m, n, v, ms, mk, us, float(f"{(begun[-1] - begun[4]) / (len(begun) - 5):.9e}")])
