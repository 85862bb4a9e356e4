"""Reference motion of the micro-contact, made without any code of this crate.

scipy's DOP853 (8th order, relative tolerance 1e-11) integrates the two equations of motion in
continuous time; every touch and release is located by the solver and the integration restarted
there. Prints one CSV row for each profile and sample time: name, t, x_s, x_f, v_s.

    pip install numpy scipy
    python micro_contact_reference.py > micro_contact_reference.csv

The profiles are those of tests/profiles/mod.rs, formula for formula.
"""

import math
import sys

import numpy as np
from scipy.integrate import solve_ivp

MS, KS, BS, MF, KM = 0.15e-3, 1000.0, 2.0, 20e-3, 5e4
DURATION, JUMP, RATE, POINTS = 0.4, 2.0 / 44100.0, 44100.0, 24
GOLDEN = 0.6180339887498949


def rise(t, width):
    x = min(max(t / width, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


def frac(x):
    return x - math.floor(x)


def sine(a, f):
    return lambda t: a * math.sin(2 * math.pi * f * t)


def sawtooth(a, f):
    fall = f * JUMP

    def height(t):
        x = frac(f * t)
        return a * x / (1 - fall) if x < 1 - fall else a * (1 - rise(x - 1 + fall, fall))

    return height


def ridge(a, w, period):
    return lambda t: a * math.exp(-(((frac(t / period) - 0.5) * period / w) ** 2))


def step(a):
    return lambda t: a * (rise(t - 0.1, JUMP) - rise(t - 0.25, JUMP))


def fractal(alpha, rms, speed, seed):
    k = np.arange(44)
    wavelength = 0.032 * 2.0 ** (-k / 4)
    amplitude = rms * 2.0 ** ((k / 4 - 5) * (1 - alpha) / 2) / math.sqrt(2)
    phase = 2 * math.pi * np.modf((k * k + seed) * GOLDEN)[0]
    omega = 2 * math.pi * speed / wavelength
    return lambda t: float(np.dot(amplitude, np.sin(omega * t + phase)))


def sweep(a, wavelength, speed):
    return lambda t: a * math.sin(2 * math.pi * (0.5 * speed / DURATION * t * t) / wavelength)


def cusps(a, f):
    return lambda t: a * abs(math.sin(math.pi * f * t))


def chord(a, f, b, g):
    return lambda t: a * math.sin(2 * math.pi * f * t) + b * math.sin(2 * math.pi * g * t)


def constant(f):
    return lambda t: f


def force_step(a, b):
    return lambda t: a + (b - a) * rise(t - 0.1, JUMP)


def swing(mean, a, f):
    return lambda t: mean + rise(t, 0.02) * a * math.sin(2 * math.pi * f * t)


PROFILES = [
    ("sine 0.1 m/s", sine(5e-5, 100.0), constant(0.5)),
    ("sine 1 m/s", sine(5e-5, 1000.0), constant(0.5)),
    ("sawtooth", sawtooth(2e-4, 100.0), constant(0.5)),
    ("ridge", ridge(5e-4, 0.004, 0.05), constant(0.5)),
    ("step", step(1e-4), constant(0.5)),
    ("fractal 1", fractal(1.0, 5e-6, 0.2, 0.0), constant(0.5)),
    ("fractal 1.5", fractal(1.5, 5e-6, 0.2, 1.0), constant(0.5)),
    ("fractal 2", fractal(2.0, 5e-6, 0.2, 2.0), constant(0.5)),
    ("fractal 2.5", fractal(2.5, 5e-6, 0.2, 3.0), constant(0.5)),
    ("fractal 1 light", fractal(1.0, 5e-6, 0.2, 4.0), constant(0.02)),
    ("force step", fractal(2.0, 5e-6, 0.2, 5.0), force_step(0.0, 5.0)),
    ("sweep", sweep(5e-5, 1e-3, 1.0), constant(0.5)),
    ("sine 3 mm", sine(8e-5, 47.0), constant(0.3)),
    ("sine fast light", sine(2e-5, 1730.0), constant(0.2)),
    ("cusps", cusps(1e-4, 130.0), constant(0.8)),
    ("cusps light", cusps(3e-5, 410.0), constant(0.1)),
    ("narrow ridges", ridge(1e-4, 0.0008, 0.011), constant(0.6)),
    ("chord", chord(4e-5, 211.0, 6e-6, 2417.0), constant(0.4)),
    ("fractal 1.25 heavy", fractal(1.25, 8e-6, 0.1, 6.3), constant(2.0)),
    ("fractal 1.75", fractal(1.75, 4e-6, 0.15, 7.7), constant(0.5)),
    ("fractal 2.25 light", fractal(2.25, 6e-6, 0.18, 8.1), constant(0.1)),
    ("force swing", fractal(1.6, 5e-6, 0.2, 9.9), swing(0.6, 0.5, 5.0)),
    ("fine sawtooth", sawtooth(4e-5, 330.0), constant(1.0)),
    ("slow sweep", sweep(1e-4, 2.3e-3, 0.7), constant(0.7)),
]


def solve(shape, force):
    """Motion at the sample times; the leash is left out (no profile here reaches it)."""

    def height(t):
        return rise(t, 0.02) * shape(t)

    def flow(pressed):
        def f(t, z):
            xf, vf, xs, vs = z
            strut = KS * (xs - xf) + BS * (vs - vf)
            push = KM * (height(t) - xs) if pressed else 0.0
            return [vf, (strut - force(t)) / MF, vs, (push - strut) / MS]

        return f

    def gap(t, z):
        return z[2] - height(t)

    gap.terminal = True
    times = np.round(np.linspace(0.03, 0.39, POINTS) * RATE) / RATE
    f0 = force(0.0)
    z, t, pressed = [-f0 / KM - f0 / KS, 0.0, -f0 / KM, 0.0], 0.0, True
    rows = []
    while len(rows) < POINTS:
        gap.direction = 1.0 if pressed else -1.0
        wanted = [x for x in times if x > t]
        s = solve_ivp(flow(pressed), (t, DURATION), z, "DOP853", t_eval=wanted,
                      events=gap, rtol=1e-11, atol=1e-16, max_step=1e-5)
        for tt, zz in zip(s.t, np.reshape(s.y, (4, -1)).T if len(s.t) else []):
            if any(abs(tt - x) < 1e-12 for x in wanted):
                rows.append((tt, zz[2], zz[0], zz[3]))
        if s.status != 1:
            break
        # Past the event by a hair, so that the next regime starts on its own side.
        t, z = s.t_events[0][0], list(s.y_events[0][0])
        pressed = not pressed
        z[2] += (-1e-15 if pressed else 1e-15)
    return rows


print("profile,t_s,pad_m,finger_m,pad_velocity_m_s")
for name, shape, force in PROFILES:
    for t, xs, xf, vs in solve(shape, force):
        print(f"{name},{t:.12e},{xs:.10e},{xf:.10e},{vs:.8e}")
    sys.stdout.flush()
