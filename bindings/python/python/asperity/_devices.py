"""Haptic channels as what devices take, live: frames for a headset's controller, levels for a pad's motors."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from asperity import _native
from asperity._live import Scene


class HeadsetFrame(NamedTuple):
    """One call of `xrApplyHapticFeedback` with `XrHapticParametricVibrationEXT`: both envelopes have the same times."""

    stage: str
    """"first", "intermediate" or "last" of its stream."""
    time_ns: npt.NDArray[np.int64]
    """Nanoseconds since the stream began."""
    amplitude: npt.NDArray[np.float32]
    """0 to 1."""
    frequency: npt.NDArray[np.float32]
    """0 to 1 of the range."""
    band_hz: tuple[float, float] | None
    """Range of the frequencies, Hz, which a first frame alone says."""


class HeadsetFrames:
    """A haptic channel of a running scene as frames of `XR_EXT_haptic_parametric`, which your own OpenXR binding hands over.

    scene: while its renderer plays. rate_hz: points a second. band_hz: range of the device. full_scale: the sample value that counts as
    amplitude 1. first_frame_s: the least length of a stream's first frame, as the runtime says. holds_s: what a late reader still finds.

    >>> import asperity as asp
    >>> scene = asp.Scene(asp.Solid("granite"), sr=48_000)
    >>> frames = asp.HeadsetFrames(scene)
    >>> _ = scene.renderer.render(4800)
    >>> [frame.stage for frame in frames.read(0.1)], frames.counts
    ([], {'framed': 0, 'silent': 10, 'dropped': 0})

    Raises ValueError where there is no such channel or a number is out of its range.
    """

    def __init__(
        self,
        scene: Scene,
        channel: int = 0,
        *,
        rate_hz: float = 100.0,
        band_hz: Sequence[float] = (55.0, 200.0),
        full_scale: float = 1.0,
        first_frame_s: float = 0.05,
        holds_s: float = 0.5,
    ) -> None:
        low, high = band_hz
        native = _native.LiveFrames(scene._native, channel, rate_hz, (low, high), full_scale, first_frame_s, holds_s)
        self._native = native

    def read(self, now_s: float) -> Iterator[HeadsetFrame]:
        """The frames that are to be handed over at `now_s` of any clock that only rises, in this order."""
        while (told := self._native.read(now_s)) is not None:
            stage, times, amplitudes, frequencies, band_hz = told
            levels, tones = np.array(amplitudes, np.float32), np.array(frequencies, np.float32)
            yield HeadsetFrame(stage, np.array(times, np.int64), levels, tones, None if band_hz is None else (band_hz[0], band_hz[1]))

    def restart(self) -> None:
        """The runtime has refused a frame, lost its focus or begun another session: the next frame is the first of a stream."""
        self._native.restart()

    @property
    def counts(self) -> dict[str, int]:
        """Points by what became of them: framed, silent (no call needed), dropped (too old, ahead of the clock, or overwritten)."""
        return dict(zip(("framed", "silent", "dropped"), self._native.counts(), strict=True))


class PadLevels:
    """How hard a heavy and a light motor of a pad turn with a haptic channel of a running scene: pairs of 0 to 1, for `rumble` of pygame,
    SDL or evdev. Iterating gives those that have come since, at `rate_hz`. full_scale: the sample value at which a motor turns fully.

    Raises ValueError where there is no such channel or a number is out of its range.
    """

    def __init__(self, scene: Scene, channel: int = 0, *, rate_hz: float = 60.0, full_scale: float = 1.0, holds_s: float = 0.5) -> None:
        if not full_scale > 0:
            raise ValueError(f"full_scale: {full_scale} is refused; must be above 0")
        self._native = _native.LiveLevels(scene._native, channel, rate_hz, holds_s)
        self._full_scale = full_scale

    def newest(self) -> tuple[float, float]:
        """The newest levels; the same again when nothing is new."""
        return self._shares(self._native.newest())

    def __iter__(self) -> Iterator[tuple[float, float]]:
        while (levels := self._native.read()) is not None:
            yield self._shares(levels)

    @property
    def lost(self) -> int:
        """Levels that were overwritten before they were read."""
        return self._native.lost()

    def _shares(self, levels: Sequence[float]) -> tuple[float, float]:
        heavy, light = (min(1.0, level / self._full_scale) for level in levels)
        return heavy, light
