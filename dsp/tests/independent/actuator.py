"""Device model and high-pass by scipy: figures asserted in dsp/tests/actuator.rs.

The device is felt/drive = D/Q w0^2 / (s^2 + w0/Q s + w0^2) with the LRA profile, discretised for a held drive
(cont2discrete, zoh) and driven with a short burst; and the high-pass of 10 Hz, butter(2), on a step and a sine.
"""

import numpy as np
from scipy.signal import butter, cont2discrete, dlsim, lfilter

rate, f0, q, felt = 44100.0, 170.0, 8.0, 1.2e-5
w0 = 2 * np.pi * f0
num, den, dt = cont2discrete(([felt / q * w0 * w0], [1.0, w0 / q, w0 * w0]), 1 / rate, method="zoh")
num = num.flatten()
n = 4000
u = np.where(np.arange(n) < 300, np.sin(2 * np.pi * 150.0 * np.arange(n) / rate), 0.0)
y = lfilter(num, den, u)
# lfilter's y[k] is the state before the step with u[k]; the model answers at the end of the step.
print("device", [(k, float(f"{y[k + 1]:.10e}")) for k in (0, 50, 100, 250, 300, 1000, 3000)])
b, a = butter(2, 10.0, "high", fs=rate)
x = 1e-4 + 2e-5 * np.sin(2 * np.pi * 25.0 * np.arange(n) / rate)
z = lfilter(b, a, x - x[0])
print("high-pass", [(k, float(f"{z[k]:.10e}")) for k in (1, 100, 500, 1000, 3999)])
