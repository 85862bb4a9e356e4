"""Microphones on bodies of simulated worlds, from the arrays that any simulator has."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native, contacts as _contacts
from asperity._scene import SceneFile, _known, sources

_F32 = npt.NDArray[np.float32]
_PROBES = "a thing of the simulator"
_FORMS = ("flat", "sphere", "capsule", "cylinder")


@dataclass(frozen=True)
class Thing:
    """A collider of a simulator: what strikes, slides and rolls.

    material: a preset of `names_of("material")`. body: the body of the scene that it rings as; it is heard by the pickups on that.
    surface: the surface of the scene that others scrape on it. mass_kg: infinite for what nothing moves. form: "flat", "sphere",
    "capsule" or "cylinder", along its own z. radius_m: of the round ones. velocity, about: rows of the arrays of velocities and of the
    places that they belong to; its own index unless told otherwise.
    """

    material: str
    body: str | None = None
    surface: str | None = None
    mass_kg: float = float("inf")
    form: str = "flat"
    radius_m: float = 0.0
    velocity: int | None = None
    about: int | None = None

    def __post_init__(self) -> None:
        _known("material", self.material)
        if self.form not in _FORMS:
            raise ValueError(f'form: "{self.form}" is unknown; must be one of: {", ".join(_FORMS)}')
        if not self.mass_kg > 0:
            raise ValueError(f"mass_kg: {self.mass_kg} is refused; must be above 0, infinite for what nothing moves")

    def told(self, index: int) -> tuple[Any, ...]:
        """As the native half takes it."""
        row = index if self.velocity is None else self.velocity
        about = index if self.about is None else self.about
        return (self.body, self.surface, self.material, 1.0 / self.mass_kg, self.form, self.radius_m, row, about)


class Microphones:
    """What pickups on bodies hear of the contacts of one or many worlds.

    scene: a `SceneFile` with `pickups`. things: the simulator's colliders by index; None is not heard. worlds: how many; world k has the
    seed `seed` + k, and the bits that it has alone. sr: samples a second. step_s: length of the first step. keep: seconds that `read`
    can reach back. gravity: its vector in m/s², if accelerometers are to read how their bodies move as a whole. threads: that render
    worlds at once; as many as there are processors unless told otherwise. log: keeps contact logs.

    `pickle` keeps what it is made of, not what it has heard. Raises ValueError or FileNotFoundError in the engine's words.
    """

    def __init__(
        self,
        scene: SceneFile,
        things: Sequence[Thing | None],
        *,
        worlds: int = 1,
        seed: int = 1,
        sr: float = 16_000,
        step_s: float = 0.002,
        keep: float = 10.0,
        gravity: Sequence[float] | None = None,
        threads: int | None = None,
        log: bool = False,
    ) -> None:
        self._made_of = (scene, list(things)), {
            "worlds": worlds, "seed": seed, "sr": sr, "step_s": step_s, "keep": keep, "gravity": gravity, "threads": threads, "log": log,
        }  # fmt: skip
        for name, value in (("worlds", worlds), ("step_s", step_s), ("keep", keep)):
            if not 0 < value < float("inf"):
                raise ValueError(f"{name}: {value} is refused; must be above 0")
        if not scene.pickups:
            raise ValueError("scene: has no pickups; name their bodies in SceneFile(pickups=[...])")
        path, files = sources(scene)
        told = [None if thing is None else thing.told(index) for index, thing in enumerate(things)]
        self.worlds, self.sr, self.keep = worlds, float(sr), keep
        self._native = _native.Microphones(
            path, files, told, worlds, seed, self.sr, step_s, round(keep * sr), None if gravity is None else list(gravity),
            threads or os.cpu_count() or 1, log,
        )  # fmt: skip

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), *self._made_of)

    @property
    def scene(self) -> SceneFile:
        """The scene with the probes that its logs name: `asp.render(mics.scene, mics.events(k), seed=…, sr=…)` reads what world k has."""
        faces = [{"name": f"{_PROBES}, face of {face} m", "face_m": face, "asperities": 64} for face in (0.05, 0.25)]
        probes = [{"name": _PROBES, "tip_mass_kg": 0.0}, *faces]
        return replace(self._made_of[0][0], probe=[{"preset": "rigid", **probe} for probe in probes])

    @property
    def channels(self) -> int:
        """How many pickups a world has."""
        return self._native.channels

    @property
    def latency_s(self) -> float:
        """By how much a reading lags behind the stamp of what it is of."""
        return self._native.latency_samples / self.sr

    def step(
        self,
        t: npt.ArrayLike,
        pairs: npt.ArrayLike,
        point: npt.ArrayLike,
        normal: npt.ArrayLike,
        force: npt.ArrayLike,
        *,
        place: npt.ArrayLike,
        rotation: npt.ArrayLike,
        velocity: npt.ArrayLike,
        about: npt.ArrayLike | None = None,
        world: npt.ArrayLike | None = None,
        restitution: float = 0.0,
    ) -> None:
        """Takes a step of every world.

        t: times (worlds,) or one for all, s; each grows from step to step. A row a point of contact: pairs (n, 2) of things, point (n, 3)
        in m, normal (n, 3) from the first to the second, force (n,) along it in N, world (n,) where there are several. place (worlds,
        things, 3) in m, rotation (worlds, things, 3, 3) from a thing's own space; velocity (worlds, rows, 6): rad/s, then m/s at the
        places about (worlds, rows, 3), at `place` unless told otherwise. restitution: rebound over approach speed of what strikes.

        Raises ValueError where an array does not fit, a number is not finite or a time does not grow; then nothing was taken.
        """
        places = _array("place", place, np.float64, 3)
        turns = np.asarray(rotation, np.float64)
        if turns.shape[1:] != (places.shape[1], 3, 3):
            raise ValueError(f"rotation: has the shape {turns.shape}; must be {(self.worlds, places.shape[1], 3, 3)}")
        if world is None and self.worlds > 1:
            raise ValueError("world: is missing; must name the world of each row")
        self._native.step(
            0, np.broadcast_to(np.asarray(t, np.float64), (self.worlds,)),
            None if world is None else _array("world", world, np.int64, 1),
            _array("pairs", pairs, np.int32, 2), _array("point", point, np.float64, 2), _array("normal", normal, np.float64, 2),
            _array("force", force, np.float64, 1), restitution, places, turns.reshape(*turns.shape[:2], 9),
            _array("velocity", velocity, np.float64, 3), places if about is None else _array("about", about, np.float64, 3),
        )  # fmt: skip

    def read(self, seconds: float) -> _F32:
        """The newest `seconds` of every world up to its last step: (worlds, channels, samples) in m/s², m/s or m, behind a sensor in
        volts; 0 before its first step."""
        if not 0 <= seconds <= self.keep:
            raise ValueError(f"seconds: {seconds} is refused; must be 0 to keep, {self.keep}")
        samples = round(seconds * self.sr)
        return self._native.read(samples).reshape(self.worlds, self.channels, samples)

    def reset(self, mask: npt.ArrayLike | None = None) -> None:
        """Begins the worlds of a mask (worlds,) anew, or all: silent, at whatever time their next step has."""
        which = np.ones(self.worlds, bool) if mask is None else np.asarray(mask)
        if which.dtype != bool or which.shape != (self.worlds,):
            raise ValueError(f"mask: is {which.dtype} of the shape {which.shape}; must be bool of ({self.worlds},)")
        self._native.reset(np.flatnonzero(which).tolist())

    def log(self, world: int = 0) -> str:
        """The contact log of a world since the last call, JSON Lines whose time begins with its first step; needs `log=True`."""
        return self._native.log(world)

    def events(self, world: int = 0) -> _contacts.Contacts:
        """`log` as a structured array of `asperity.contacts`."""
        return _contacts.from_jsonl(self.log(world), f"log of world {world}")

    def stats(self, world: int = 0) -> dict[str, Any]:
        """What the engine of a world did so far."""
        stats: dict[str, Any] = json.loads(self._native.stats(world))
        return stats


def _again(kind: type, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
    return kind(*arguments, **named)


def _array(name: str, value: npt.ArrayLike, kind: type, axes: int) -> npt.NDArray[Any]:
    array = np.asarray(value)
    if array.ndim != axes or array.dtype.kind not in "fiu" or (np.issubdtype(kind, np.integer) and array.dtype.kind == "f"):
        raise ValueError(f"{name}: is {array.dtype} with {array.ndim} axes; must be {np.dtype(kind)} with {axes}")
    return array.astype(kind, copy=False)
