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


n = np.arange(int(0.5 * FS))
index = np.searchsorted(sample, n, side="right") - 1
t0 = sample[index] / FS
age = (n - sample[index]) / FS
for name, x in (("extrapolate", position(t0) + velocity(t0) * age), ("hold", position(t0))):
    y = lfilter(b, a, x)
    print(name, [float(f"{y[k]:.12g}") for k in (5000, 11025, 16000, 20000)])
