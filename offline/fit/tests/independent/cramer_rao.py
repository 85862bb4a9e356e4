"""Joint Cramér–Rao bound of damped sinusoids by numpy, for fit/tests/synthetic.rs.

Columns: std of frequency (Hz), decay (1/s), amplitude relative to the amplitude, phase (rad).
"""
import numpy as np

MODES = np.array([[440.0, 3.0, 1.0, 0.3], [441.0, 5.0, 0.5, -1.0], [3000.0, 60.0, 0.2, 2.0]])
RATE, COUNT, NOISE = 8000.0, 8000, 0.01

t = np.arange(COUNT) / RATE
columns = []
for f, d, a, p in MODES:
    e, w = np.exp(-d * t), 2 * np.pi * f * t + p
    columns += [2 * np.pi * t * a * e * np.cos(w), -t * a * e * np.sin(w), e * np.sin(w), a * e * np.cos(w)]
J = np.stack(columns, axis=1)
scale = 1 / np.linalg.norm(J, axis=0)
covariance = np.linalg.pinv((J * scale).T @ (J * scale), rcond=1e-14, hermitian=True) * np.outer(scale, scale)
std = NOISE * np.sqrt(np.diag(covariance)).reshape(-1, 4)
std[:, 2] /= MODES[:, 2]
print(np.array2string(std, precision=12, floatmode="unique"))
