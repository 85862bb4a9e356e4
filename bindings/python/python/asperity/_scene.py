"""What a scene consists of: surfaces from arrays, bodies that ring, and the scene file that holds them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any, TypeVar, Union

import numpy as np
import numpy.typing as npt

from asperity import _native

Path = Union[str, "os.PathLike[str]"]
Image = Union[npt.ArrayLike, Path]
Extent = float | tuple[float, float]
Files = dict[str, Any]
S = TypeVar("S", bound="_Surface")


@dataclass(frozen=True)
class Body:
    """Something that rings.

    Body(modes="tile.modes.json") rings as a modes file says, `Body.stock("plate", 0.14, "ceramic")` as a stock shape does,
    `asperity.fit(...).body()` as a recording; Body() is silent. material: a preset of `names_of("material")` or a table of constants.
    Further keys are those of [[body]] in docs/formats/scene.md. Raises FileNotFoundError where the modes file is missing, ValueError where the
    material is none.
    """

    modes: Path | None = None
    material: str | Mapping[str, float] | None = None
    name: str = "body"
    keys: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        if self.modes is not None and os.fspath(self.modes) not in self.files:
            _there(self.modes, "modes")
        if isinstance(self.material, str):
            _known("material", self.material)

    @classmethod
    def stock(cls, shape: str, size_m: float, material: str | Mapping[str, float], name: str = "body") -> Body:
        """A stock shape of `names_of("stock")`, its longest side or diameter `size_m` metres."""
        _known("stock", shape)
        return cls(None, material, name, {"stock": shape, "size_m": size_m})

    def table(self) -> dict[str, Any]:
        """Its table of a scene file."""
        table: dict[str, Any] = {"name": self.name, **self.keys}
        if self.modes is not None:
            path = os.fspath(self.modes)
            table["modes"] = path if path in self.files else os.path.abspath(path)
        if self.material is not None:
            table["material"] = self.material if isinstance(self.material, str) else dict(self.material)
        return table


@dataclass(frozen=True)
class _Surface:
    """A surface as a table of a scene file, and the arrays that it names."""

    name: str
    keys: dict[str, Any]
    files: Files = field(repr=False)
    body: Body | None = None

    def on(self: S, body: Body) -> S:
        """The same surface on a body, which rings when it is touched."""
        other = copy(self)
        object.__setattr__(other, "body", body)
        return other

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height that uv 1 spans, m."""
        return float(self.keys["width_m"]), float(self.keys["height_m"])

    def table(self) -> dict[str, Any]:
        """Its table of a scene file."""
        table = {"name": self.name, **self.keys}
        if self.body is not None:
            table["body"] = self.body.name
        return table


def _sides(extent: Extent, aspect: float = 1.0) -> dict[str, float]:
    """Width and height; one number is the width, and the height follows."""
    if isinstance(extent, int | float | np.floating | np.integer):
        return {"width_m": float(extent), "height_m": float(extent) * aspect}
    width_m, height_m = extent
    return {"width_m": float(width_m), "height_m": float(height_m)}


def _known(kind: str, name: str) -> None:
    """Refuses a name that is none of `names_of(kind)`; `-` and `_` are one."""
    names = _native.names_of(kind)
    if name.replace("-", "_") not in (known.replace("-", "_") for known in names):
        meant = get_close_matches(name, names, 1)
        right = f'write "{meant[0]}"; ' if meant else ""
        raise ValueError(f'{kind}: "{name}" is unknown; {right}must be one of: {", ".join(names)}')


def _there(path: Path, what: str) -> None:
    """Refuses a file that does not exist."""
    if not os.path.exists(path):
        where = "" if os.path.isabs(path) else f" in {os.getcwd()}"
        raise FileNotFoundError(f"{what}: {os.fspath(path)}: no such file{where}; name a file that exists")


def _is_path(image: object) -> bool:
    return isinstance(image, str | os.PathLike)


def _picture(image: Image, at: str, files: Files, what: str) -> tuple[str, float]:
    """Under which name a scene finds a picture, and its height over its width; what it holds is kept in `files`."""
    if isinstance(image, str | os.PathLike):
        _there(image, what)
        return os.path.abspath(os.fspath(image)), 1.0
    array = np.asarray(image)
    if array.ndim != 2 or 0 in array.shape:
        raise ValueError(f"{what}: has the shape {array.shape}; must be (rows, columns)")
    if array.dtype.kind == "f":
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            row, column = bad[0]
            raise ValueError(f"{what}: row {row}, column {column} is {array[row, column]}; must be finite")
        array = array.astype(np.float32)
    elif array.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"{what}: is {array.dtype}; must be float (metres), uint8 or uint16")
    files[at] = np.ascontiguousarray(array)
    return at, array.shape[0] / array.shape[1]


def _heights(image: Image, relief_m: float | None, at: str, files: Files, what: str) -> tuple[str, float, float]:
    """A picture's name, the metres of its white over its black, and its aspect. Greys are never taken for metres."""
    name, aspect = _picture(image, at, files, what)
    greys = _is_path(image) or files[at].dtype.kind != "f"
    if greys and relief_m is None:
        kind = "a picture" if _is_path(image) else f"an array of {files[at].dtype}"
        raise ValueError(f"relief_m: is missing; {kind} needs the height of white over black in metres")
    if not greys and relief_m is not None:
        raise ValueError("relief_m: stands beside heights in metres; leave it out, or give integers")
    return name, (1.0 if relief_m is None else relief_m), aspect


def _rough(roughness: float | Image | None, name: str, files: Files) -> dict[str, Any]:
    if roughness is None:
        return {}
    if not _is_path(roughness) and np.ndim(roughness) == 0:  # type: ignore[arg-type]
        return {"roughness": float(roughness)}  # type: ignore[arg-type]
    return {"roughness": _picture(roughness, f"{name}.roughness", files, "roughness")[0]}


class Surface(_Surface):
    """A surface of heights.

    heights: float array (rows, columns) in metres, top row first; or uint8, uint16 or a picture's path, with `relief_m`, the metres of
    white over black. extent: (width, height) in metres that it covers, or the width alone. roughness: R from 0 to 1, a number, an array
    or a path. Further keys (wrap, micro_relief_m, excitation, friction, compliance_m_n, ...) are those of [[surface]] in docs/formats/scene.md.

    Raises ValueError where an array is not finite, has other axes, or holds greys without `relief_m`, and FileNotFoundError where a
    picture is missing.
    """

    def __init__(
        self,
        heights: Image,
        extent: Extent,
        *,
        relief_m: float | None = None,
        roughness: float | Image | None = None,
        name: str = "surface",
        **keys: Any,
    ) -> None:
        files: Files = {}
        path, relief_m, aspect = _heights(heights, relief_m, f"{name}.heights", files, "heights")
        source = {"displacement": path, "relief_m": relief_m}
        super().__init__(name, source | _sides(extent, aspect) | _rough(roughness, name, files) | keys, files)


class Solid(_Surface):
    """A surface cut from solid noise: a material of `names_of("solid")`.

    parameters: what differs from the preset (amplitude_m, octaves, flow_m_s, ... of docs/formats/scene.md). The rest is as in `Surface`.
    """

    def __init__(
        self,
        preset: str,
        extent: Extent = 0.14,
        *,
        parameters: Mapping[str, Any] | None = None,
        roughness: float | Image | None = None,
        name: str = "surface",
        **keys: Any,
    ) -> None:
        _known("solid", preset)
        files: Files = {}
        source = {"solid": {"preset": preset, **(parameters or {})}}
        super().__init__(name, source | _sides(extent) | _rough(roughness, name, files) | keys, files)


class Brownian(_Surface):
    """A fractional Brownian relief of Hurst exponent `hurst` (0 to 1) and `rms_m` metres rms.

    parameters: seed, cells, graph, force of docs/formats/scene.md. The rest is as in `Surface`.
    """

    def __init__(
        self,
        hurst: float,
        rms_m: float,
        extent: Extent = 0.14,
        *,
        parameters: Mapping[str, Any] | None = None,
        roughness: float | Image | None = None,
        name: str = "surface",
        **keys: Any,
    ) -> None:
        files: Files = {}
        source = {"brownian": {"hurst": hurst, "rms_m": rms_m, **(parameters or {})}}
        super().__init__(name, source | _sides(extent) | _rough(roughness, name, files) | keys, files)


class Lattice(_Surface):
    """A primitive cell repeated along two translations, each metres along u and v. Heights as in `Surface`."""

    def __init__(
        self,
        cell: Image,
        t1_m: tuple[float, float],
        t2_m: tuple[float, float],
        extent: Extent = 0.14,
        *,
        relief_m: float | None = None,
        roughness: float | Image | None = None,
        name: str = "surface",
        **keys: Any,
    ) -> None:
        files: Files = {}
        path, relief_m, _ = _heights(cell, relief_m, f"{name}.cell", files, "cell")
        source = {"lattice": {"cell": path, "t1_m": list(t1_m), "t2_m": list(t2_m)}, "relief_m": relief_m}
        super().__init__(name, source | _sides(extent) | _rough(roughness, name, files) | keys, files)


class Sand(_Surface):
    """A bed of sand, which gives way. parameters: cells, depth_m, talus_deg, ... of docs/formats/scene.md."""

    def __init__(
        self,
        extent: Extent = 0.5,
        *,
        parameters: Mapping[str, Any] | None = None,
        name: str = "surface",
        **keys: Any,
    ) -> None:
        super().__init__(name, {"sand": dict(parameters or {})} | _sides(extent) | keys, {})


@dataclass(frozen=True)
class SceneFile:
    """A scene made in Python: the text of a scene file, and the arrays that it names.

    surfaces: one or several. bodies: those that no surface lies on. probe: a preset of `names_of("probe")` or a table of fields, or
    several, each with a name. actuators: tables of [[actuator]], in channel order. audio: a table of [audio], or a list of buses. tail_s: ring-out, s.
    pickups: tables of [[pickup]], in channel order (`Take.pickup`).
    Names are checked where they stand, everything else when it is rendered or opened, in the engine's words.
    """

    surfaces: _Surface | Sequence[_Surface]
    bodies: Sequence[Body] = ()
    probe: str | Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None
    actuators: Sequence[Mapping[str, Any]] | None = None
    audio: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None
    tail_s: float | None = None
    pickups: Sequence[Mapping[str, Any]] | None = None

    PATH = "scene.toml"

    def __post_init__(self) -> None:
        if isinstance(self.probe, str):
            _known("probe", self.probe)

    def tables(self) -> dict[str, Any]:
        """The scene as tables."""
        surfaces = self._surfaces()
        bodies: dict[int, Body] = {id(body): body for body in self.bodies}
        known = list(self.bodies)
        for surface in surfaces:
            if surface.body is not None and surface.body not in known:
                known.append(surface.body)
                bodies[id(surface.body)] = surface.body
        tables: dict[str, Any] = {
            "body": [body.table() for body in bodies.values()],
            "surface": [surface.table() for surface in surfaces],
        }
        if self.probe is not None:
            one = {"preset": self.probe} if isinstance(self.probe, str) else self.probe
            tables["probe"] = dict(one) if isinstance(one, Mapping) else [dict(probe) for probe in one]
        if self.actuators is not None:
            tables["actuator"] = [dict(actuator) for actuator in self.actuators]
        if self.audio is not None:
            tables["audio"] = dict(self.audio) if isinstance(self.audio, Mapping) else [dict(bus) for bus in self.audio]
        if self.pickups is not None:
            tables["pickup"] = [dict(pickup) for pickup in self.pickups]
        if self.tail_s is not None:
            tables["tail_s"] = self.tail_s
        return tables

    def _surfaces(self) -> list[_Surface]:
        return [self.surfaces] if isinstance(self.surfaces, _Surface) else list(self.surfaces)

    @property
    def text(self) -> str:
        """The text of the scene file. Raises ValueError where a number is not finite."""
        try:
            return _native.as_toml(json.dumps(self.tables(), allow_nan=False, default=_plain))
        except ValueError as error:
            at = _not_finite(self.tables(), "")
            if at is None:
                raise
            raise ValueError(f"{self.PATH}: {at}: is not finite; must be a number") from error

    @property
    def files(self) -> Files:
        """What the engine reads: the scene's text, its arrays, and its modes files."""
        files: Files = {self.PATH: self.text.encode()}
        for surface in self._surfaces():
            files |= surface.files
            if surface.body is not None:
                files |= surface.body.files
        for body in self.bodies:
            files |= body.files
        return files


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.path.abspath(os.fspath(value))
    raise TypeError(f"{type(value).__name__} is no number, text, list or table")


def _not_finite(value: Any, at: str) -> str | None:
    """Where a number is not finite."""
    if isinstance(value, Mapping):
        found = (_not_finite(inner, f"{at}.{key}" if at else str(key)) for key, inner in value.items())
    elif isinstance(value, list | tuple):
        found = (_not_finite(inner, at) for inner in value)
    else:
        return at if isinstance(value, float | np.floating) and not np.isfinite(value) else None
    return next((place for place in found if place), None)


SceneLike = Union[Path, SceneFile, Surface, Solid, Brownian, Lattice, Sand, Sequence[_Surface]]
"""A scene file's path, a scene made in Python, a surface or several."""


def sources(scene: SceneLike) -> tuple[str, Files]:
    """The path of a scene, and what of it is in memory."""
    if isinstance(scene, str | os.PathLike):
        return os.fspath(scene), {}
    if not isinstance(scene, SceneFile):
        scene = SceneFile(scene)
    return scene.PATH, scene.files
