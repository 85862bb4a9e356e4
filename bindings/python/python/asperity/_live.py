"""A scene that runs now: reports go in, blocks come out."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native, contacts as _contacts
from asperity._scene import SceneLike, sources


class Renderer:
    """The half of a callback: every call gives the samples that follow those before. Made by `Scene`."""

    def __init__(self, native: _native.LiveRenderer) -> None:
        self._native = native
        # Bound once: a callback makes nothing new.
        self._render_into = native.render_into

    @property
    def sr(self) -> float:
        """Samples a second."""
        return self._native.sr

    @property
    def haptic_channels(self) -> int:
        """How many haptic channels there are."""
        return self._native.haptic_channels

    @property
    def audio_buses(self) -> int:
        """How many audio buses there are."""
        return self._native.audio_buses

    @property
    def latency_samples(self) -> int:
        """By how many samples every output lags behind the stamps of its events, beside the path's own filter."""
        return self._native.latency_samples

    @property
    def position(self) -> int:
        """Index of the next sample."""
        return self._native.position()

    def render(self, n: int) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
        """The next `n` samples: audio (n,) or (buses, n), and haptic (channels, n), float32."""
        audio, haptic = self._native.render(n)
        return (audio[0] if len(audio) == 1 else audio), haptic

    @property
    def pickup_channels(self) -> int:
        """How many channels of pickups there are."""
        return self._native.pickup_channels

    def pickup(self, n: int) -> npt.NDArray[np.float32]:
        """The next `n` samples of the pickups alone: (channels, n) float32 in m/s², m/s or m, behind a sensor in volts."""
        return self._native.render_pickups(n)

    def channels(self, text: str) -> int:
        """Says what goes where in `render_into`: "audio=0,1 haptic=2,3" (the default with as many haptics as there are); returns how
        many channels a device must have. Raises ValueError where two signals share a channel."""
        return self._native.set_channels(text)

    def render_into(self, out: npt.NDArray[np.float32]) -> None:
        """Fills float32 (frames, device channels), C-contiguous, in place; channels without a signal are silent.

        Makes no Python object. Up to 1024 frames it keeps the GIL, because letting it go and taking it again may wait for longer than
        the block lasts. Raises TypeError for another type, ValueError for another layout.
        """
        self._render_into(out)

    def callback(self, outdata: npt.NDArray[np.float32], _frames: int, _time: object, _status: object) -> None:
        """What `sounddevice.OutputStream(callback=...)` takes."""
        self._render_into(outdata)


class Scene:
    """A scene that takes reports while `renderer` runs.

    scene: as in `asperity.render`. sr: the device's rate, Hz. clock: "live" follows the game through pauses and late reports; "exact"
    puts time t at sample t * sr, as an offline render does. A thread each for the scene and the renderer.

    Raises ValueError or FileNotFoundError in the engine's words.
    """

    def __init__(
        self,
        scene: SceneLike,
        *,
        sr: float | None = None,
        seed: int | None = None,
        kernel: str | None = None,
        integrator: str | None = None,
        clock: str = "live",
    ) -> None:
        if clock not in ("live", "exact"):
            raise ValueError(f'clock: "{clock}" is unknown; must be live or exact')
        path, files = sources(scene)
        self._native, half, self.full_scale, self.gain, self.strike_gain = _native.open(
            path, files, sr=sr, seed=seed, kernel=kernel, integrator=integrator, live=clock == "live"
        )
        self.renderer = Renderer(half)

    def report(self, t: float, event: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> None:
        """Reports an event, or several, at game time `t` in seconds: dictionaries with "event" and the keys of the contact log.

        Raises ValueError where the engine refuses one, in its words; those before it were taken.
        """
        several = [event] if isinstance(event, Mapping) else event
        self._native.report(_contacts.lines({"t": t, **one} for one in several))

    def report_all(self, contacts: _contacts.Contacts) -> None:
        """Reports every row of a structured array at its own t."""
        self._native.report(_contacts.to_jsonl(contacts))

    def begin(
        self, t: float, contact: int, surface: str, uv: Sequence[float], normal_force_n: float, actuator: int | None = 0, **keys: Any
    ) -> None:
        """A contact lands. Further keys: velocity_m_s, closing_m_s, probe, holder, gain, importance, at_m, depth_m, slip_m_s, roll_radius_m."""
        felt = {} if actuator is None else {"actuator": actuator}
        told = {"contact": contact, "surface": surface, "uv": list(uv), "normal_force_n": normal_force_n}
        self.report(t, {"event": "begin", **told, **felt, **keys})

    def move(self, t: float, contact: int, uv: Sequence[float], normal_force_n: float, **keys: Any) -> None:
        """A contact goes on. Further keys: velocity_m_s, gain, importance, at_m, depth_m, slip_m_s, roll_radius_m."""
        self.report(t, {"event": "move", "contact": contact, "uv": list(uv), "normal_force_n": normal_force_n, **keys})

    def motion(self, t: float, body: str, **keys: Any) -> None:
        """A body moves as a whole, in its own axes: acceleration_m_s2, gravity_m_s2, angular_velocity_rad_s, centre_m."""
        self.report(t, {"event": "motion", "body": body, **keys})

    def end(self, t: float, contact: int) -> None:
        """A contact lifts off."""
        self.report(t, {"event": "end", "contact": contact})

    def impact(self, t: float, body: str, speed_m_s: float, mass_kg: float, radius_m: float, striker: str = "steel", **keys: Any) -> None:
        """A rigid striker hits a body. Further keys: restitution, position, at_m, direction, other, holder, actuator, gain."""
        told = {"body": body, "speed_m_s": speed_m_s, "mass_kg": mass_kg, "radius_m": radius_m, "striker": striker}
        self.report(t, {"event": "impact", **told, **keys})

    def impact_named(
        self, t: float, name: int, body: str, speed_m_s: float, mass_kg: float, radius_m: float, striker: str = "steel", **keys: Any
    ) -> None:
        """A strike with a name (0 to 2**64 - 1), for games that predict and roll back: reported again, also for a time that has gone by, it
        still sounds once, and while it waits the newer report counts. Names are kept for the next 1024."""
        told = {"event": "impact", "body": body, "speed_m_s": speed_m_s, "mass_kg": mass_kg, "radius_m": radius_m, "striker": striker}
        self._native.report_named(name, _contacts.lines([{"t": t, **told, **keys}]))

    def play_clip(
        self, channel: int, clip: npt.ArrayLike, gain: float = 1.0, t: float = 0.0, *, sr: float, ducking: float = 1.0
    ) -> None:
        """Plays a waveform (n,) of rate `sr` on a haptic channel from game time `t` on; 1 is the channel's full scale.

        Strokes and blows of the channel have the gain `ducking`, 0 to 1, meanwhile. The user's gain, the equaliser and the limiters act on
        the sum; the ends are faded over 2 ms. 32 play at once. An `asperity.haptics.Clip` has its waveform as `left`, at its `sr`.
        """
        samples = np.asarray(clip, dtype=np.float32)
        if samples.ndim != 1:
            raise ValueError(f"clip: has {samples.ndim} dimensions; must be (n,)")
        self._native.play_clip(t, channel, samples.tolist(), sr, gain, ducking)

    def withdraw(self, name: int) -> bool:
        """Takes a strike with a name back; True where it waited and does not sound."""
        return self._native.withdraw(name)

    def set_time_scale(self, scale: float, bend_pitch: bool = False) -> None:
        """Slow motion or fast: game seconds a second of audio, 0.01 to 100, for the "exact" clock ("live" finds it by itself). With
        `bend_pitch`, 0.1 to 2, and for both clocks, all that is heard and felt bends with it: at 0.5 a bell of 800 Hz rings at 400 Hz."""
        self._native.set_time_scale(scale, bend_pitch)

    @property
    def stats(self) -> dict[str, Any]:
        """What the engine did so far."""
        stats: dict[str, Any] = json.loads(self._native.stats())
        return stats

    @property
    def surfaces(self) -> list[str]:
        """Names of the surfaces."""
        return self._native.names()[0]

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
        return self._native.names()[1]

    def why_silent(self) -> list[str]:
        """What speaks against anything being heard or felt, the likeliest first; empty when nothing does."""
        return self._native.why_silent()

    def why_clipped(self) -> list[str]:
        """Bodies and surfaces that leave more than full scale holds, by how much, and what to turn; empty when nothing does."""
        return self._native.why_clipped()

    def reset(self) -> None:
        """Game time begins anew."""
        self._native.reset()

    def mute(self, muted: bool = True) -> None:
        """Everything fades, or comes back."""
        self._native.set_muted(muted)


def play(renderer: Renderer, device: int | str | None = None, channels: str | None = None, *, blocksize: int = 64) -> Any:
    """Plays a renderer on a sound card with sounddevice: an open and started `sounddevice.OutputStream`.

    device: what sounddevice calls it; its default unless told otherwise. channels: what goes where, such as "audio=0,1 haptic=2,3";
    without it the first bus on 0 and 1, and every haptic channel after it as far as the device has channels. blocksize: frames a block,
    1 to 4096. Close the stream, or use it in a `with`.

    Raises ImportError without sounddevice (`pip install asperity[play]`), ValueError where two signals share a channel or the device has
    too few, and what sounddevice raises.
    """
    import sounddevice

    if not 1 <= blocksize <= 4096:
        raise ValueError(f"blocksize: {blocksize} is refused; must be 1 to 4096 frames")
    most = int(sounddevice.query_devices(device, "output")["max_output_channels"])
    if channels is None:
        haptics = [str(place) for place in range(2, min(most, 2 + renderer.haptic_channels))]
        channels = ("audio=0,1" if most > 1 else "audio=0") + (f" haptic={','.join(haptics)}" if haptics else "")
    width = renderer.channels(channels)
    if width > most:
        raise ValueError(f'channels: "{channels}" needs {width} channels; the device has {most}')
    stream = sounddevice.OutputStream(
        renderer.sr, blocksize=blocksize, device=device, channels=width, dtype="float32", callback=renderer.callback
    )
    stream.start()
    return stream
