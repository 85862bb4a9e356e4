"""A stroke over ridges made with numpy, saved as two WAV files: python stroke_from_array.py [FOLDER]"""

import pathlib
import sys

import numpy as np

import asperity as asp

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(parents=True, exist_ok=True)

# Ridges 1.5 mm apart and 0.2 mm high, on a texel of 0.25 mm.
x_m = np.arange(512) * 0.25e-3
ridges_m = np.tile(0.1e-3 * np.sin(2 * np.pi * x_m / 1.5e-3), (64, 1))
surface = asp.Surface(ridges_m, extent=0.128).on(asp.Body.stock("bar", 0.2, "wood"))
for speed in (0.03, 0.1, 0.3):
    take = asp.stroke(surface, speed=speed, force=0.6, duration=1.0, sr=48_000)
    spectrum = np.abs(np.fft.rfft(take.haptic[0] * np.hanning(take.haptic.shape[1])))
    peak_hz = np.argmax(spectrum) * take.sr / take.haptic.shape[1]
    print(f"{speed} m/s over 1.5 mm: felt at {peak_hz:.1f} Hz, {take.save(folder / f'ridges_{speed}')}")
