#!/usr/bin/env python3
"""Makes tile_strike.wav, the recording that `asperity demo` fits. It is synthetic: no tile was struck.

What a real recording has is in it: 0.12 s of lead-in, a contact of 0.15 ms, 26 modes of a ceramic tile,
eight early reflections, a room tail of 0.4 s, coloured noise 60 dB below the peak, 16-bit rounding.

    python3 tile_strike.py      # needs numpy; writes tile_strike.wav beside this file
"""

import pathlib
import wave

import numpy as np

RATE = 44_100
rng = np.random.default_rng(2_024)
length = int(1.7 * RATE)
onset = 0.1204 * RATE

# Bending modes of a free rectangular plate, 150 x 110 x 8 mm, with a scatter of 3 %.
c = 4.3  # E, rho and thickness of stoneware in one number
found = sorted(
    c * ((m / 0.150) ** 2 + (n / 0.110) ** 2) * (1 + 0.03 * rng.standard_normal())
    for m in range(7)
    for n in range(6)
    if m + n >= 2
)
frequency = np.array([f for f in found if f < 15_000][:26])
decay = 9.0 + 1.1e-7 * (2 * np.pi * frequency) ** 2 * (1 + 0.15 * rng.standard_normal(frequency.size))
amplitude = 0.2 / (1 + np.arange(frequency.size)) ** 0.55 * (1 + 0.4 * rng.uniform(-1, 1, frequency.size))

t = (np.arange(length) - onset) / RATE
ring = np.zeros(length)
after = t >= 0
for f, d, a in zip(frequency, decay, amplitude):
    ring[after] += a * np.exp(-d * t[after]) * np.sin(2 * np.pi * f * t[after])

# The contact: a raised cosine of 0.15 ms, whose spectrum the modes take on.
contact = np.hanning(int(0.00015 * RATE) * 2 + 1)
strike = np.convolve(ring, contact / contact.sum())[:length]

# The room: eight reflections and a tail of filtered noise.
room = np.zeros(int(0.5 * RATE))
room[0] = 1.0
for _ in range(8):
    room[int(rng.uniform(0.004, 0.03) * RATE)] += 0.06 * rng.uniform(-1, 1)
s = np.arange(room.size) / RATE
tail = rng.standard_normal(room.size) * np.exp(-6.9 * s / 0.4) * (s > 0.012)
room += 0.0025 * np.convolve(tail, [0.25, 0.5, 0.25], mode="same")
sound = np.convolve(strike, room)[:length]

white = np.fft.rfft(rng.standard_normal(length))
hz = np.maximum(np.fft.rfftfreq(length, 1 / RATE), 20)
noise = np.fft.irfft(white * (hz / 1000) ** -0.4, length)
sound *= 0.7 / np.abs(sound).max()
sound += noise / noise.std() * 0.7 * 10 ** (-60 / 20) * 0.3

path = pathlib.Path(__file__).with_name("tile_strike.wav")
with wave.open(str(path), "wb") as out:
    out.setnchannels(1)
    out.setsampwidth(2)
    out.setframerate(RATE)
    out.writeframes(np.round(sound * 32_767).astype("<i2").tobytes())
print(path, f"{frequency.size} modes from {frequency[0]:.0f} to {frequency[-1]:.0f} Hz")
