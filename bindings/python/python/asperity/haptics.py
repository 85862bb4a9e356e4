"""What phones, headsets and pads play of a vibration."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from asperity import _native
from asperity._progress import Progress, shown

_ENDS = {".android.json": "android", ".haptic": "haptic", ".ahap": "ahap", ".hjif": "hjif"}


class Clip:
    """A vibration as a device's two envelopes.

    amplitude, frequency: (points, 2), seconds and 0 to 1. original, left: float64 (samples,) at 8000 Hz: the vibration with `gain`,
    and what the device leaves of it. score: in_band_error_db, balance_db, level_bias_db, envelope_correlation (docs/ports.md).
    """

    sr = 8000.0

    def __init__(self, native: _native.NativeClip) -> None:
        self._native = native
        self.amplitude = native.amplitude()
        self.frequency = native.frequency()
        self.original, self.left = native.waves()
        self.gain = native.gain
        self.way = native.way
        self.score = dict(native.score)
        self.duration_s = native.duration_s()
        self.device, self.band_hz = native.device()

    def __repr__(self) -> str:
        return f"Clip({len(self.amplitude)} points, {self.duration_s:.2f} s, for {self.device})"

    def save(self, path: str | os.PathLike[str]) -> list[str]:
        """Writes `.haptic`, `.ahap`, `.android.json` or `.hjif`, by the end of the name; returns the paths.

        An AHAP whose strokes cannot stand beside its curves has them in NAME.transients.ahap. Raises ValueError for another end.
        """
        path = os.fspath(path)
        end = next((end for end in _ENDS if path.lower().endswith(end)), None)
        if end is None:
            raise ValueError(f"{path}: is no format that is written; must end in {', '.join(_ENDS)}")
        stem, written = path[: -len(end)], []
        for suffix, text in self._native.texts(_ENDS[end]):
            target = stem + suffix
            with open(f"{target}.part", "w", encoding="utf-8") as file:
                file.write(text)
            os.replace(f"{target}.part", target)
            written.append(target)
        return written


def reduce(
    y: npt.ArrayLike,
    sr: float,
    device: str = "quest",
    *,
    points: float | None = None,
    strokes_s: Sequence[float] = (),
    normalise: bool = False,
    source: str = "",
    progress: Progress = None,
) -> Clip:
    """Reduces a vibration to what a device plays.

    y: displacement (n,) at `sr` Hz, full scale 1. device: quest, console, iphone, lra-170, or a profile's file. points: most envelope
    points a second. strokes_s: where strokes begin, s. normalise: brings the peak to 1 even where it lies below.

    Raises ValueError where a sample is not finite or an option is refused, FileNotFoundError where the profile is missing.
    """
    samples = np.ascontiguousarray(y, dtype=np.float64)
    if samples.ndim != 1:
        raise ValueError(f"y: has the shape {samples.shape}; must be one channel (n,)")
    with shown(progress, "reducing") as tell:
        native = _native.reduce(
            samples, sr, device, points=points, strokes_s=list(strokes_s), normalise=normalise, source=source, progress=tell
        )
    return Clip(native)
