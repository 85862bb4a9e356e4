"""Renders: a scene and its contacts, or one stroke."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native, contacts as _contacts
from asperity._progress import Progress, shown
from asperity._scene import SceneFile, SceneLike, _Surface, sources
from asperity._take import Take

ContactsLike = str | os.PathLike[str] | _contacts.Contacts | Sequence[Mapping[str, Any]]

_TRACE = (
    "u", "v", "height_m", "normal_force_n", "pad_m", "pad_velocity_m_s", "finger_m", "contact_force_n", "impulse_n_s",
)  # fmt: skip
_FORCE = ("x_n", "y_n", "z_n")


class TouchWarning(UserWarning):
    """What was refused, lost or left out of a render, what its reports contradict themselves in, and which output is too loud or silent, and why."""


def render(
    scene: SceneLike,
    contacts: ContactsLike | None = None,
    *,
    sr: float | None = None,
    seed: int | None = None,
    kernel: str | None = None,
    integrator: str | None = None,
    block: int = 256,
    trace: bool = False,
    force: bool | float = False,
    progress: Progress = None,
) -> Take:
    """Renders a scene and its contacts: the samples that `asperity render` writes, to the bit.

    scene: a scene file's path, a `SceneFile`, a surface or several. contacts: a structured array (`asperity.contacts`), a list of
    dictionaries, a `.jsonl` path; None for the log that the scene file names. sr: sample rate, Hz. seed: of every random number.
    kernel: "portable" gives the same bits on every processor. integrator: "exact-event" (the default), "semi-implicit-euler" (Hasti's),
    "semi-implicit-euler-explicit" or "energy-conserving". block: frames a block; the result does not depend on it. trace: keeps
    `Take.trace`, a row a sample and contact. force: keeps `Take.force`, the 3-D force at 1 kHz, or at as many Hz as it says.
    progress: a bar, or a callable that is told the part done.

    Runs without the GIL; Ctrl-C stops it. Raises ValueError or FileNotFoundError in the engine's words; warns with `TouchWarning` of
    events that were refused or lost, of contacts that contradict themselves (velocity against uv), and of each output that is too loud or silent.
    """
    path, files = sources(scene)
    if contacts is None and isinstance(scene, SceneFile | _Surface | list | tuple):
        raise ValueError("contacts: is missing; give an array of asperity.contacts, a list of events or a .jsonl file")
    rate = 1000.0 if force is True else (float(force) if force else None)
    with shown(progress, "rendering") as tell:
        made = _native.render(
            path, files, None if contacts is None else _log(contacts), sr=sr, seed=seed, kernel=kernel, integrator=integrator,
            block=block, trace=trace, force_rate=rate, progress=tell,
        )  # fmt: skip
    return _take(made, rate)


def stroke(
    surface: _Surface,
    *,
    speed: float = 0.1,
    force: float = 0.6,
    duration: float = 1.0,
    start: tuple[float, float] = (0.1, 0.5),
    direction_deg: float = 0.0,
    probe: str | Mapping[str, Any] | None = None,
    actuators: Sequence[Mapping[str, Any]] | None = None,
    audio: Mapping[str, Any] | None = None,
    tail_s: float | None = None,
    sr: float | None = None,
    seed: int | None = None,
    kernel: str | None = None,
    integrator: str | None = None,
    trace: bool = False,
    force_output: bool | float = False,
    progress: Progress = None,
) -> Take:
    """One straight stroke over a surface.

    speed: m/s. force: N that presses. force_output: keeps `Take.force`, the 3-D force, at 1 kHz or at as many Hz as it says. duration: s. start: uv, 1 spans the surface. direction_deg: 0 along u, 90 along v. probe: what
    touches, a preset of `names_of("probe")` or a table; the fingertip unless told otherwise. actuators, audio: tables of the scene
    file; without them a stroke of 0.1 m/s at 1 N lands at -26 dBFS felt and -32 dBFS heard. tail_s: ring-out, s. The rest is as in
    `render`.
    """
    if not isinstance(surface, _Surface):
        raise ValueError(f"surface: {surface!r} is refused; must be asp.Surface, Solid, Brownian, Lattice or Sand")
    if isinstance(force, bool):
        raise ValueError(f"force: {force} is refused; it is how hard the finger presses, in N: force_output=True or =1000.0 keeps Take.force")
    scene = SceneFile(surface, probe=probe, actuators=actuators, audio=audio, tail_s=tail_s)
    events = _contacts.stroke(
        speed=speed, force=force, duration=duration, extent=surface.extent, surface=surface.name, start=start,
        direction_deg=direction_deg,
    )  # fmt: skip
    return render(scene, events, sr=sr, seed=seed, kernel=kernel, integrator=integrator, trace=trace, force=force_output, progress=progress)


def _log(contacts: ContactsLike) -> tuple[str, str]:
    """The text of a log, and what messages call it."""
    if isinstance(contacts, str | os.PathLike):
        return _contacts.read(contacts), os.fspath(contacts)
    text = _contacts.to_jsonl(contacts) if isinstance(contacts, np.ndarray) else _contacts.lines(contacts)
    return text, "contacts"


def _take(made: dict[str, Any], force_rate: float | None) -> Take:
    sr = float(made["sr"])
    audio: npt.NDArray[np.float32] = made["audio"]
    stats = json.loads(made["stats"]) | {key: made[key] for key in ("kernel", "full_scale", "gain", "strike_gain", "limiter_db")}
    told = [f"{place}: is a key of the format, but this version does not act on it" for place in made["unread"]]
    for warning in told + made["warnings"]:
        warnings.warn(warning, TouchWarning, stacklevel=3)
    return Take(
        audio=audio[0] if len(audio) == 1 else audio,
        haptic=made["haptic"],
        sr=sr,
        stats=stats,
        trace=_rows(made["trace"], sr, _TRACE),
        force=_rows(made["force"], force_rate or 1.0, _FORCE),
        sand=made["sand"],
        pickup=made["pickup"],
    )


def _rows(told: Any, rate: float, names: tuple[str, ...]) -> npt.NDArray[np.void] | None:
    """Rows as a structured array, in order of time and of contacts within it."""
    if told is None:
        return None
    at, contact, values = told
    order = np.lexsort((contact, at))
    rows = np.empty(len(at), [("time_s", "f8"), ("contact", "u8"), *((name, "f8") for name in names)])
    rows["time_s"], rows["contact"] = at[order] / rate, contact[order]
    for column, name in enumerate(names):
        rows[name] = values[order, column]
    return rows
