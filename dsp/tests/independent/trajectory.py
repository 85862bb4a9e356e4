"""Figures for dsp/tests/trajectory_figures.rs: the path stage by scipy's Butterworth on dead-reckoned events.

Run: python3 trajectory.py   (numpy, scipy)
"""
import numpy as np
from scipy.signal import butter, lfilter

FS = 44100
b, a = butter(2, 30, fs=FS)
events_s = np.arange(0, 0.5, 1 / 60)
sample = np.round(events_s * FS).astype(int)


def position(t):
    return 0.05 * np.sin(2 * np.pi * 2.0 * t)


def velocity(t):
    return 0.05 * 2 * np.pi * 2.0 * np.cos(2 * np.pi * 2.0 * t)


def bends():
    """How the velocity changes after each report: the parabola through the last three, as far as it has foretold better than a straight line."""
    t, p, v = sample / FS, position(sample / FS), velocity(sample / FS)
    period, missed, bent, out = 1 / 60, np.zeros(2), (0.0, 0.0, 0.0), []
    for k in range(len(t)):
        trust, parabola = 0.0, (0.0, 0.0, 0.0)
        if k > 0:
            gap = t[k] - t[k - 1]
            a, j, until = bent
            tau = min(gap, until)
            faster = a * tau + j * tau**2 / 2
            further = a * tau**2 / 2 + j * tau**3 / 6 + faster * (gap - tau)
            for which, share in enumerate((0, 1)):
                place = p[k] - p[k - 1] - v[k - 1] * gap - share * further
                speed = v[k] - v[k - 1] - share * faster
                missed[which] = 0.5 * missed[which] + place**2 + (0.5 * gap * speed) ** 2
        if k > 1:
            c = np.polyfit(t[k - 2 : k + 1] - t[k], v[k - 2 : k + 1], 2)
            parabola = (c[1], 2 * c[0], 1.25 * period)
            trust = max(0.0, 1 - 4 * missed[1] / missed[0]) if missed[0] > 0 else 0.0
        bent = parabola
        out.append((trust * parabola[0], trust * parabola[1], parabola[2]))
        if k > 0:
            # The running event period: the first interval, then a quarter of each new one.
            period += (1.0 if k == 1 else 0.25) * (gap - period)
    return np.array(out)


n = np.arange(int(0.5 * FS))
index = np.searchsorted(sample, n, side="right") - 1
t0 = sample[index] / FS
age = (n - sample[index]) / FS
a_, j_, until = bends()[index].T
tau = np.minimum(age, until)
bend = a_ * tau**2 / 2 + j_ * tau**3 / 6 + (a_ * tau + j_ * tau**2 / 2) * (age - tau)
for name, x in (("extrapolate", position(t0) + velocity(t0) * age + bend), ("hold", position(t0))):
    y = lfilter(b, a, x)
    print(name, [float(f"{y[k]:.12g}") for k in (5000, 11025, 16000, 20000)])
