"""A finished render: what is heard and felt, to save, to plot and to listen to."""

from __future__ import annotations

import base64
import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native, _picture


@dataclass(frozen=True, eq=False)
class Take:
    """What a render gave. Sample 0 is game time 0.

    audio: float32 (samples,), or (buses, samples) where the scene has several. haptic: float32 (channels, samples), full scale as
    `stats["full_scale"]` says: a sample times it is in m or m/s². sr: samples a second. stats: what the engine counted, and the levels in
    use. trace, force: structured arrays where they were asked for, with the columns of `asperity render --trace` and `--force`: `x_n` is the
    force on the finger along u, `y_n` along v (friction points against the motion), `z_n` out of the surface, in N. sand: heights in
    metres (rows, columns) of each surface of sand after the last contact. pickup: float32 (channels, samples), a channel a pickup of the
    scene in m/s², m/s or m, behind a sensor in volts; (0, 0) where there is none.
    """

    audio: npt.NDArray[np.float32]
    haptic: npt.NDArray[np.float32]
    sr: float
    stats: dict[str, Any]
    trace: npt.NDArray[np.void] | None = None
    force: npt.NDArray[np.void] | None = None
    sand: dict[str, npt.NDArray[np.float64]] = field(default_factory=dict)
    pickup: npt.NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 0), np.float32))

    def __repr__(self) -> str:
        return f"Take(audio={self.audio.shape}, haptic={self.haptic.shape}, sr={self.sr:g}, {self.duration_s:.2f} s)"

    @property
    def duration_s(self) -> float:
        """Length, s."""
        return float(self.haptic.shape[1] / self.sr)

    def frames(self, which: str = "audio") -> npt.NDArray[np.float32]:
        """(samples, channels), as soundfile, sounddevice and PsychoPy take them: "audio", "haptic", or "both" side by side."""
        parts = {"audio": [np.atleast_2d(self.audio)], "haptic": [self.haptic]}
        parts["both"] = parts["audio"] + parts["haptic"]
        if which not in parts:
            raise ValueError(f'which: "{which}" is unknown; must be audio, haptic or both')
        return np.ascontiguousarray(np.concatenate(parts[which]).T)

    def save(self, stem: str | os.PathLike[str]) -> list[str]:
        """Writes STEM.audio.wav, STEM.haptic.wav and, with pickups, STEM.pickup.wav, 32-bit float, as the program does; returns their paths.

        Nothing is left under these names where one cannot be written.
        """
        signals = {"audio": np.atleast_2d(self.audio), "haptic": self.haptic}
        if len(self.pickup):
            signals["pickup"] = self.pickup
        paths = [f"{os.fspath(stem)}.{part}.wav" for part in signals]
        parts = [f"{path}.part" for path in paths]
        try:
            for part, samples in zip(parts, signals.values(), strict=True):
                _native.write_wav(part, np.ascontiguousarray(samples), self.sr)
            for part, path in zip(parts, paths, strict=True):
                os.replace(part, path)
        finally:
            for part in parts:
                if os.path.exists(part):
                    os.remove(part)
        return paths

    def spectrogram(
        self, which: str = "audio", channel: int = 0, n_fft: int = 2048, hop_length: int | None = None
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Frequencies (n_fft / 2 + 1,) in Hz, times (frames,) in s, and levels (frequencies, frames) in dB of a full-scale sine."""
        samples = self.frames(which)[:, channel].astype(np.float64)
        hop = hop_length or n_fft // 4
        padded = np.pad(samples, (0, max(n_fft - len(samples), 0)))
        windows = np.lib.stride_tricks.sliding_window_view(padded, n_fft)[::hop]
        window = np.hanning(n_fft)
        levels = np.abs(np.fft.rfft(windows * window, axis=1)).T / (0.5 * window.sum())
        times = (np.arange(len(windows)) * hop + 0.5 * n_fft) / self.sr
        frequencies = np.asarray(np.fft.rfftfreq(n_fft, 1.0 / self.sr), dtype=np.float64)
        levels_db = np.asarray(20.0 * np.log10(np.maximum(levels, 1e-12)), dtype=np.float64)
        return frequencies, times.astype(np.float64), levels_db

    def plot(self, ax: Any = None) -> Any:
        """Draws waves of what is heard and felt with matplotlib; returns the axes."""
        if ax is None:
            import matplotlib.pyplot as plt

            _, ax = plt.subplots(figsize=(9, 3))
        times = np.arange(self.haptic.shape[1]) / self.sr
        for index, samples in enumerate(self.frames("both").T):
            buses = len(np.atleast_2d(self.audio))
            label = f"audio {index}" if index < buses else f"haptic {index - buses}"
            ax.plot(times, samples, lw=0.5, label=label)
        ax.set_xlabel("time, s")
        ax.set_ylabel("full scale")
        ax.legend(loc="upper right")
        return ax

    def _repr_html_(self) -> str:
        """A player and a picture, for Jupyter."""
        mix = np.atleast_2d(self.audio).sum(axis=0)
        sound = base64.b64encode(_picture.wav16(mix, self.sr)).decode()
        player = f'<audio controls src="data:audio/wav;base64,{sound}"></audio>'
        return f"<div>{player}<br>{_picture.svg(self.audio, self.haptic, self.duration_s)}</div>"
