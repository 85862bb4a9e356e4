"""Modes of a shape: a mesh and a material become a body that rings wherever it is struck."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native
from asperity._progress import Progress, shown
from asperity._scene import Body

Mesh = str | os.PathLike[str] | tuple[npt.ArrayLike, npt.ArrayLike]
_MODE = ("frequency_hz", "decay_per_s", "amplitude", "phase_rad")
_ELASTIC = ("young_pa", "poisson", "density_kg_m3")


@dataclass(frozen=True, eq=False)
class Shape:
    """The modes of a mesh.

    modes: structured array with frequency_hz, decay_per_s, amplitude (of a strike of 1 N·s at the place that rings most) and phase_rad,
    rising. mass_kg, volume_m3, degrees_of_freedom: of what was solved. warnings: repairs and doubts, one line each.
    """

    modes: npt.NDArray[np.void]
    mass_kg: float
    volume_m3: float
    degrees_of_freedom: int
    warnings: list[str]
    text: str = field(repr=False)

    def __repr__(self) -> str:
        low, high = (self.modes["frequency_hz"][place] for place in (0, -1))
        return f"Shape({len(self.modes)} modes from {low:.1f} to {high:.1f} Hz, {1e3 * self.mass_kg:.1f} g)"

    def json(self) -> str:
        """The text of its modes file with its shapes, as docs/formats/modes.md has it."""
        return self.text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the modes file, in place of the one there only when all is written."""
        part = f"{os.fspath(path)}.part"
        with open(part, "w", encoding="utf-8") as file:
            file.write(self.text)
        os.replace(part, path)

    def body(self, name: str = "body", material: str | None = None) -> Body:
        """A body of this shape, for `Surface.on` and `SceneFile`; impacts may say `at_m`. material: of `names_of("material")`."""
        path = f"{name}.modes.json"
        return Body(path, material, name, files={path: self.text.encode()})


def modes(
    mesh: Mesh,
    material: str | Mapping[str, float] | None = None,
    *,
    size_m: float | None = None,
    thickness_m: float | None = None,
    damping_from: str | os.PathLike[str] | None = None,
    up_to_hz: float | None = None,
    max_modes: int | None = None,
    radiation: bool = False,
    progress: Progress = None,
) -> Shape:
    """Solves a mesh for its modes: the numbers of `asperity modes`.

    mesh: an .obj, .stl or .msh file in metres, or (points, triangles): float (n, 3) in metres, and integers (m, 3), anticlockwise from
    outside. material: of `names_of("material")`, or young_pa, poisson and density_kg_m3. size_m: longest side, scales the mesh.
    thickness_m: the surface is a sheet of this thickness. damping_from: a modes file of a recording of the same material. up_to_hz,
    max_modes: which modes; the lowest 64 as far as 20 kHz unless told otherwise. radiation: levels in pascals at 1 m.

    Runs without the GIL, seconds for a simple body; Ctrl-C stops it. Raises ValueError or FileNotFoundError in the engine's words.
    """
    path, surface = (os.fspath(mesh), None) if isinstance(mesh, str | os.PathLike) else (None, _surface(mesh))
    table = {} if material is None or isinstance(material, str) else dict(material)
    unknown = sorted(set(table) - set(_ELASTIC))
    if unknown:
        raise ValueError(f"material: {', '.join(unknown)}: unknown; must be of {', '.join(_ELASTIC)}")
    elastic = [None if table.get(name) is None else float(table[name]) for name in _ELASTIC]
    with shown(progress, "solving") as tell:
        made: dict[str, Any] = _native.modes(
            path, surface, material=material if isinstance(material, str) else None, elastic=elastic, damping_from=damping_from,
            size_m=size_m, thickness_m=thickness_m, up_to_hz=up_to_hz, max_modes=max_modes, radiation=radiation, progress=tell,
        )  # fmt: skip
    rows = np.empty(len(made["modes"]), [(name, "f8") for name in _MODE])
    for column, name in enumerate(_MODE):
        rows[name] = made["modes"][:, column]
    return Shape(**{**made, "modes": rows})


def _surface(mesh: tuple[npt.ArrayLike, npt.ArrayLike]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint32]]:
    points, corners = (np.asarray(part) for part in mesh)
    if corners.dtype.kind not in "iu" or corners.ndim != 2 or points.ndim != 2:
        raise ValueError("mesh: must be points (n, 3) in metres and triangles (m, 3) of whole numbers")
    if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
        raise ValueError(f"mesh: triangles name points from {corners.min()} to {corners.max()}; must be 0 to {len(points) - 1}")
    return np.ascontiguousarray(points, dtype=np.float64), np.ascontiguousarray(corners, dtype=np.uint32)
