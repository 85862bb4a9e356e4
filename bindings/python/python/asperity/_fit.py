"""Fit: one recorded hit becomes modes."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native
from asperity._progress import Progress, shown
from asperity._scene import Body

_MODE = (
    "frequency_hz", "decay_per_s", "amplitude", "phase_rad",
    "frequency_std_hz", "decay_std_per_s", "amplitude_std", "phase_std_rad", "energy",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Fit:
    """The modes of a recording, and what they leave of it.

    modes: structured array with frequency_hz, decay_per_s, amplitude, phase_rad, their standard deviations (…_std…) and energy, most
    energy first: y(t) = sum of amplitude · exp(-decay_per_s t) · sin(2π frequency_hz t + phase_rad), t from `onset_s`.
    recording, resynthesis, residual: float64 (samples,) at `sr`.
    """

    modes: npt.NDArray[np.void]
    sr: float
    source: str
    impulse: float
    onset_s: float
    start_offset_s: float
    end_s: float
    noise_floor_db: float
    resynthesis_snr_db: float
    snr_from_onset_db: float
    struck_peak_db: float
    warnings: list[str]
    recording: npt.NDArray[np.float64] = field(repr=False)
    resynthesis: npt.NDArray[np.float64] = field(repr=False)
    residual: npt.NDArray[np.float64] = field(repr=False)
    burst: tuple[float, npt.NDArray[np.float64]] | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        return f"Fit({self.source!r}, {len(self.modes)} modes, {self.snr_from_onset_db:.1f} dB from the onset)"

    def json(self) -> str:
        """The text of its modes file, as docs/formats/modes.md has it."""
        modes: list[dict[str, Any]] = []
        for mode in self.modes:
            std = {key: mode[name] for key, name in zip(_MODE[:4], _MODE[4:8], strict=True)}
            finite = {key: float(value) if np.isfinite(value) else None for key, value in std.items()}
            plain = {key: float(mode[key]) for key in _MODE[:4]}
            modes.append({**plain, "std": finite, "energy": float(mode["energy"])})
        file: dict[str, Any] = {"format": "asperity.modes", "version": 1, "source": self.source}
        file |= {"impulse_n_s": self.impulse, "modes": modes}
        if self.burst is not None:
            rate, samples = self.burst
            file["residual"] = {"sample_rate_hz": rate, "samples": samples.astype(np.float32).tolist()}
        return json.dumps(file, indent=2, allow_nan=False)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the modes file, in place of the one there only when all is written."""
        part = f"{os.fspath(path)}.part"
        with open(part, "w", encoding="utf-8") as file:
            file.write(self.json())
        os.replace(part, path)

    def body(self, name: str = "body", material: str | None = None) -> Body:
        """A body that rings so, for `Surface.on` and `SceneFile`. material: what it is made of, of `names_of("material")`."""
        path = f"{name}.modes.json"
        return Body(path, material, name, files={path: self.json().encode()})


def fit(
    y: npt.ArrayLike | str | os.PathLike[str],
    sr: float | None = None,
    impulse: float = 0.01,
    *,
    max_modes: int = 150,
    from_hz: float = 20.0,
    to_hz: float | None = None,
    min_level_db: float = -90.0,
    strike: int | None = None,
    start_s: float | None = None,
    burst_s: float | None = None,
    name: str = "array",
    progress: Progress = None,
) -> Fit:
    """Fits one recorded hit.

    y: samples (n,) at `sr` Hz, full scale 1; several channels (channels, n), of which the loudest is taken; or the path of a WAV, FLAC
    or Ogg Vorbis file. impulse: what the recorded strike delivered, N·s. max_modes: most modes. from_hz, to_hz: their band. min_level_db:
    drops modes so far below the strongest. strike: which strike of several, from 1; the best unless told otherwise. start_s: fits from
    so long after the onset. burst_s: keeps so much of the residual as an excitation that impacts play.

    Runs without the GIL; Ctrl-C stops it. Raises ValueError or FileNotFoundError in the engine's words.
    """
    if not (np.isfinite(impulse) and impulse > 0):
        raise ValueError(f"impulse: {impulse} is refused; must be above 0 N·s")
    samples, path = (None, os.fspath(y)) if isinstance(y, str | os.PathLike) else (_loudest(y), None)
    if samples is not None and sr is None:
        raise ValueError("sr: is missing; give the sample rate of y in Hz")
    with shown(progress, "fitting") as tell:
        made = _native.fit(
            samples, path, float(sr or 0.0), name, max_modes=max_modes, from_hz=from_hz, to_hz=to_hz, min_level_db=min_level_db,
            strike=strike, start_s=start_s, burst_s=burst_s, progress=tell,
        )  # fmt: skip
    rows = np.empty(len(made["modes"]), [(name, "f8") for name in _MODE])
    for column, field_name in enumerate(_MODE):
        rows[field_name] = made["modes"][:, column]
    return Fit(impulse=impulse, **{**made, "modes": rows})


def _loudest(y: npt.ArrayLike) -> npt.NDArray[np.float64]:
    array = np.asarray(y)
    if array.dtype.kind not in "fiu" or array.ndim not in (1, 2) or array.size == 0:
        raise ValueError(f"y: has the shape {array.shape} and the type {array.dtype}; must be (n,) or (channels, n) numbers")
    if array.dtype.kind != "f":
        # Integers are what WAV readers give: their full scale is that of their type.
        array = array / -float(np.iinfo(array.dtype).min) if array.dtype.kind == "i" else _unsigned(array)
    if array.ndim == 2:
        array = array[np.argmax(np.sum(np.square(array, dtype=np.float64), axis=1))]
    return np.ascontiguousarray(array, dtype=np.float64)


def _unsigned(array: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    if array.dtype != np.uint8:
        raise ValueError(f"y: is {array.dtype}; must be float, signed integers, or uint8 about 128")
    return (array.astype(np.float64) - 128.0) / 128.0
