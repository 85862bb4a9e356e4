"""Contact microphones in MuJoCo: `pip install asperity[mujoco]`.

>>> import asperity.mujoco, mujoco  # doctest: +SKIP
>>> mic = asperity.mujoco.ContactMic(model, data, geom="table", materials={"table": "wood", "ball": "steel"})  # doctest: +SKIP
>>> mujoco.mj_step(model, data); mic.step()  # doctest: +SKIP
>>> mic.read(0.1)  # doctest: +SKIP
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from asperity._microphones import Microphones, Thing, _F32, _again
from asperity._scene import Body, SceneFile, Surface, _Surface

Heard = str | Mapping[str, Any]
"""A material's name, or a table: material, and where wanted surface (a `Surface`, `Solid`, …) and body (a `Body`)."""

_FORM = {mujoco.mjtGeom.mjGEOM_SPHERE: "sphere", mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule", mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder"}


class ContactMic:
    """What a contact microphone on a geom hears.

    model, data: of MuJoCo; a list of data is as many worlds. geom: name of the geom that the microphone is on, or a list of names.
    materials: what geoms are made of, by name; "*" is every other one, and what is not named is not heard. A name of
    `names_of("material")` is flat ground of that roughness; {"material": …, "surface": …, "body": …} has a surface and a body of its own.
    at: place of the microphone in the geom's own space, m, where its body's modes have shapes. seed: of every random number; world k has
    `seed` + k. sr: samples a second. sensor: a profile such as "adxl1005". quantity: "acceleration", "velocity" or "displacement". gravity:
    True for an accelerometer, which reads its body's own motion as well. keep: seconds that `read` can reach back. log: keeps contact logs.

    `pickle` keeps how it was made, without model, data and what was heard: call `attach`. Raises ValueError in one sentence.
    """

    def __init__(
        self,
        model: Any = None,
        data: Any = None,
        *,
        geom: str | Sequence[str],
        materials: Mapping[str, Heard],
        at: Sequence[float] | None = None,
        seed: int = 1,
        sr: float = 16_000,
        sensor: str | os.PathLike[str] | None = None,
        quantity: str = "acceleration",
        gravity: bool = False,
        keep: float = 10.0,
        threads: int | None = None,
        log: bool = False,
    ) -> None:
        self._made_of: dict[str, Any] = {
            "geom": geom, "materials": dict(materials), "at": at, "seed": seed, "sr": sr, "sensor": sensor, "quantity": quantity,
            "gravity": gravity, "keep": keep, "threads": threads, "log": log,
        }  # fmt: skip
        self._microphones: Microphones | None = None
        if model is not None:
            self.attach(model, data)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), (), self._made_of)

    def attach(self, model: Any, data: Any) -> None:
        """Listens to this model and data from now on, with nothing heard yet."""
        made_of = self._made_of
        geoms = [made_of["geom"]] if isinstance(made_of["geom"], str) else list(made_of["geom"])
        scene, things = _scene(model, geoms, made_of)
        several = isinstance(data, Sequence)
        self._data = list(data) if several else [data]
        self._microphones = Microphones(
            scene, things, worlds=len(self._data), seed=made_of["seed"], sr=made_of["sr"], step_s=float(model.opt.timestep),
            keep=made_of["keep"], gravity=model.opt.gravity.tolist() if made_of["gravity"] else None, threads=made_of["threads"],
            log=made_of["log"],
        )  # fmt: skip
        self._axes = (slice(None) if several else 0, slice(None) if not isinstance(made_of["geom"], str) else 0)
        self._sums = model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
        # MuJoCo keeps these arrays where they are.
        self._still = [(d.geom_xpos[None], d.geom_xmat[None], d.cvel[None], d.subtree_com[None]) for d in self._data]
        self._take = self._microphones._native.step

    def step(self) -> None:
        """Takes the contacts of the step that MuJoCo has made. What is heard of it is heard from its beginning on.

        Raises ValueError where the time has not grown (`reset` after `mj_resetData`) or the simulation has numbers that are not finite;
        then nothing was taken.
        """
        if self._microphones is None:
            raise ValueError("microphone: is attached to nothing; call attach(model, data)")
        for index, data in enumerate(self._data):
            time = np.array((data.time,))
            if data.ncon:
                contact = data.contact
                rows = contact.geom, contact.pos, contact.frame[:, :3], data.efc_force
                self._take(index, time, None, *rows, 0.0, *self._still[index], (contact.efc_address, self._sums))
            else:
                self._take(index, time, None, *_NOTHING, 0.0, *self._still[index])

    def read(self, seconds: float) -> _F32:
        """The newest seconds, float32 (samples,); with a list of geoms (geoms, samples), with a list of data (worlds, …)."""
        return self._heard.read(seconds)[self._axes]

    def reset(self, mask: npt.ArrayLike | None = None) -> None:
        """Begins anew, where a mask (worlds,) is true or everywhere."""
        self._heard.reset(mask)

    @property
    def microphones(self) -> Microphones:
        """The microphones beneath: `log`, `events`, `stats`."""
        return self._heard

    @property
    def _heard(self) -> Microphones:
        if self._microphones is None:
            raise ValueError("microphone: is attached to nothing; call attach(model, data)")
        return self._microphones


_NOTHING = (np.zeros((0, 2), np.int32), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))


def _scene(model: Any, geoms: list[str], made_of: Mapping[str, Any]) -> tuple[SceneFile, list[Thing | None]]:
    """The scene of a model, and its geoms as things."""
    names = [model.geom(index).name or f"#{index}" for index in range(model.ngeom)]
    materials: dict[str, Heard] = made_of["materials"]
    for kind, wanted in (("geom", geoms), ("materials", [name for name in materials if name != "*"])):
        for name in wanted:
            if name not in names:
                meant = get_close_matches(name, names, 1)
                raise ValueError(f'{kind}: "{name}" is unknown; ' + (f'write "{meant[0]}"' if meant else "must be a geom of the model"))
    bodies: list[Body] = []
    surfaces: list[_Surface] = []
    files: dict[str, Any] = {}
    things: list[Thing | None] = []
    for index, name in enumerate(names):
        heard = materials.get(name, materials.get("*"))
        if heard is None:
            if name in geoms:
                raise ValueError(f'materials: "{name}" has none, and the microphone is on it; name its material')
            things.append(None)
            continue
        table: Mapping[str, Any] = {"material": heard} if isinstance(heard, str) else heard
        if "material" not in table or set(table) - {"material", "surface", "body"}:
            raise ValueError(f'materials: "{name}" is {sorted(table)}; must be material, and surface and body where wanted')
        material = table["material"]
        body = table.get("body") or (_stock(model, index, material) if name in geoms else Body(None, material))
        bodies.append(Body(body.modes, body.material or material, name, body.keys, body.files))
        ground = table.get("surface") or Surface(np.zeros((2, 2)), 0.2)
        clash = [path for path in ground.files if path in files and not np.array_equal(files[path], ground.files[path])]
        if clash:
            raise ValueError(f'materials: "{name}" has a surface called "{ground.name}" as another one has; give each a name')
        files |= ground.files
        surfaces.append(_Surface(name, ground.keys, ground.files, bodies[-1]))
        owner = int(model.geom_bodyid[index])
        mobility = float(model.body_invweight0[owner, 0])
        things.append(
            Thing(
                material, name if name in geoms else None, name, 1.0 / mobility if mobility > 0 else float("inf"),
                _FORM.get(model.geom_type[index], "flat"), float(model.geom_size[index, 0]), owner, int(model.body_rootid[owner]),
            )
        )  # fmt: skip
    place = {"factor": 1.0} if made_of["at"] is None else {"at_m": [float(x) for x in made_of["at"]]}
    sensor = {} if made_of["sensor"] is None else {"sensor": os.fspath(made_of["sensor"])}
    pickups = [{"name": name, "body": name, "quantity": made_of["quantity"], **place, **sensor} for name in geoms]
    return SceneFile(surfaces, bodies, pickups=pickups), things


def _stock(model: Any, index: int, material: str) -> Body:
    """The stock body that a geom is nearest to."""
    kind, size = model.geom_type[index], model.geom_size[index]
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        return Body.stock("plate", 0.5, material)
    sides = 2.0 * np.sort(size if kind == mujoco.mjtGeom.mjGEOM_BOX else model.geom_aabb[index, 3:])
    # As much of it as of the geom, within a factor of six.
    shape = "plate" if sides[0] < 0.1 * sides[1] else ("bar" if np.prod(sides) < 0.02 * sides[2] ** 3 else "block")
    return Body.stock(shape, float(np.clip(sides[2], 0.01, 2.0)), material)
