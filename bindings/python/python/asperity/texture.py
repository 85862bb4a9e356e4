"""Tools on pictures and height maps: what is in them, and surfaces made from them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native
from asperity._progress import Progress, shown
from asperity._scene import Surface, _known

Image = npt.ArrayLike | str | os.PathLike[str]


def read(path: str | os.PathLike[str], channel: str = "luma") -> npt.NDArray[np.float64]:
    """One channel of a picture file ("luma", "r", "g", "b", "a") as (rows, columns), 0 to 1; of an EXR file as it is."""
    return _native.read_picture(path, channel)


def _plane(image: Image, what: str) -> npt.NDArray[np.float64]:
    if isinstance(image, str | os.PathLike):
        return read(image)
    array = np.asarray(image)
    if array.ndim != 2 or 0 in array.shape:
        raise ValueError(f"{what}: has the shape {array.shape}; must be (rows, columns)")
    greys = array.dtype.kind in "ui"
    plane = np.ascontiguousarray(array / np.iinfo(array.dtype).max if greys else array, dtype=np.float64)
    if not np.isfinite(plane).all():
        raise ValueError(f"{what}: holds numbers that are not finite; must be finite")
    return plane


def analyze(image: Image) -> dict[str, Any]:
    """How rough a picture or height map is, and what repeats in it.

    image: (rows, columns) of at least 64 × 64, or a path. Returns `fractal_dimension` (box, information, correlation, probability,
    recommended), `hurst`, `spectral_exponent`, `roughness` (0 to 1), `lattice` (t1_px, t2_px, confidence) or None, `wallpaper_group` or
    None, `frieze` or None, and `warnings`: the numbers of `asperity texture analyze --json`, without the warning of a coloured picture.
    """
    analysis: dict[str, Any] = json.loads(_native.analyze(_plane(image, "image")))
    return analysis


def from_normals(
    normals: Image,
    texel_m: float,
    *,
    green: str | None = None,
    derivative: str | None = None,
    keep_tilt: bool = False,
) -> tuple[npt.NDArray[np.float64], dict[str, Any]]:
    """Heights in metres (rows, columns), mean 0, of a tangent-space normal map, and what was found out about it.

    normals: (rows, columns, 3), greys of their type or floats 0 to 1; or a path. texel_m: size of a texel, m. green: opengl or directx.
    derivative: exact, central or sobel. Both are found out unless told.
    """
    if isinstance(normals, str | os.PathLike):
        planes = [read(normals, channel) for channel in "rgb"]
    else:
        array = np.asarray(normals)
        if array.ndim != 3 or array.shape[2] < 3:
            raise ValueError(f"normals: has the shape {array.shape}; must be (rows, columns, 3)")
        planes = [_plane(array[:, :, channel], "normals") for channel in range(3)]
    if not (np.isfinite(texel_m) and texel_m > 0):
        raise ValueError(f"texel_m: {texel_m} is refused; must be above 0 m")
    heights, told = _native.from_normals(*planes, green_way=green, derivative=derivative, keep_tilt=keep_tilt)
    return heights * texel_m, told


def metamer(
    look: Image, feel: Image, *, iterations: int | None = None, progress: Progress = None
) -> tuple[npt.NDArray[np.float64], dict[str, Any]]:
    """A height map as large as `look` with its arrangement that feels like `feel`, in the unit of `feel`; and how near it came.

    Both (rows, columns) of at least 64 × 64 texels of one size, or paths.
    """
    with shown(progress, "matching") as tell:
        return _native.metamer(_plane(look, "look"), _plane(feel, "feel"), iterations=iterations, progress=tell)


def from_photo(
    photo: Image,
    *,
    width_m: float | None = None,
    relief_m: float | None = None,
    light: tuple[float, float, float] | None = None,
    method: str | None = None,
    bright_is_deep: bool = False,
    calibration: float = 1.0,
    exaggerate: float = 1.0,
    progress: Progress = None,
) -> tuple[npt.NDArray[np.float64], dict[str, Any]]:
    """Heights in metres (rows, columns) of a photograph, lowest 0, and what was found out about it: those of `asperity texture from-photo`.

    photo: (rows, columns) greys of their type or floats 0 to 1, as stored (sRGB); or a path. width_m: of what it shows; a texel is 0.16 mm
    unless told otherwise. relief_m: from the lowest to the highest point; what contrast gives unless told otherwise. light: direction to
    it, x to the right, y down, z to the eye. method: integrable, tsai-shah, dark-is-deep or flat-ground, by the light unless told
    otherwise. calibration, exaggerate: factors on what contrast gives, and on the heights. Pictures of more than four million texels are
    reduced (`reduced_by`).

    Told are `texel_m`, `relief_m`, `micro_relief_m` (for `Surface`), `roughness_map` (rows, columns, 0 to 1), `method`, `sign`,
    `sign_confidence`, `light`, `fractal_dimension`, `lattice_px`, `wallpaper_group`, `tileable`, and `warnings`: what to doubt.

    Runs without the GIL; Ctrl-C stops it. Raises ValueError or FileNotFoundError in the engine's words.
    """
    colour = 0.0
    if isinstance(photo, str | os.PathLike):
        plane, colour = _native.read_photograph(photo)
    else:
        plane = _plane(photo, "photo")
    with shown(progress, "from photo") as tell:
        heights_m, roughness, told = _native.from_photo(
            plane, width_m=width_m, relief_m=relief_m, light=None if light is None else [float(x) for x in light], method=method,
            bright_is_deep=bright_is_deep, calibration=calibration, exaggerate=exaggerate, progress=tell,
        )  # fmt: skip
    return heights_m, {**told, "roughness_map": roughness, "colour": colour}


_UNITS = {"m_s2": 1.0, "g": 9.80665, "um": 1e-6}
_SIDE_M = 0.5


def from_stroke(
    stroke: npt.ArrayLike | Sequence[npt.ArrayLike],
    rate: float,
    *,
    speed: npt.ArrayLike | Sequence[npt.ArrayLike],
    force: npt.ArrayLike | Sequence[npt.ArrayLike],
    probe: str | Mapping[str, Any] = "stylus",
    unit: str = "m_s2",
    tangential: npt.ArrayLike | None = None,
    ring: str | os.PathLike[str] | None = None,
    colour: npt.ArrayLike | None = None,
    probe_error: float = 0.1,
    name: str = "stroked",
) -> tuple[Surface, dict[str, Any]]:
    """A surface of a recorded stroke, and every estimate with its standard error: those of `asperity texture from-stroke`.

    stroke: (samples,) or (axes, samples) of an accelerometer on the tool; several strokes over one surface are a list or tuple of those.
    rate: Hz. speed, force: m/s and N, a number or an array a sample; one for each stroke, as a list or tuple, or one for all. probe: what
    stroked, a preset of `names_of("probe")` or a table. unit: m_s2, g, or um (displacement). tangential: force along the surface, N, a
    sample each of the first stroke: tells friction. ring: modes file of the body, whose sound the stroke then is. colour: (n, 2) of Hz and
    dB, the rig's response. probe_error: relative error of each of the probe's constants, for the told errors.

    The surface plays at any speed and force: `asp.stroke(surface, speed=..., force=..., probe=probe)`. Told are `octaves`, `bands`,
    `alpha`, `alpha_se`, `lines`, `friction`, `explained`, `recorded`, `warnings` and the rest of `surface.json`.

    Raises ValueError in the engine's words where the recording is no stroke or the model does not explain it.
    """
    if unit not in _UNITS:
        raise ValueError(f'unit: "{unit}" is unknown; must be one of {", ".join(_UNITS)}')
    if isinstance(probe, str):
        _known("probe", probe)
    several = isinstance(stroke, list | tuple) and len(stroke) > 0 and np.ndim(stroke[0]) > 0
    strokes = list(stroke) if several else [stroke]  # type: ignore[arg-type]
    speeds, forces = (_each(track, len(strokes), what) for track, what in ((speed, "speed"), (force, "force")))
    recorded = []
    for place, axes in enumerate(strokes):
        array = np.ascontiguousarray(np.atleast_2d(np.asarray(axes, dtype=np.float64)) * _UNITS[unit])
        tracks = [_track(track, array, what) for track, what in ((speeds[place], "speed"), (forces[place], "force"))]
        # Forth and back is one speed along the path.
        recorded.append((array, float(rate), np.abs(tracks[0]) if tracks[0].size > 1 else tracks[0], tracks[1]))
    table = {"preset": probe} if isinstance(probe, str) else dict(probe)
    report, pattern, outer_scale_m = _native.from_stroke(
        recorded, json.dumps(table), displacement=unit == "um", ring=ring,
        tangential_n=None if tangential is None else [float(x) for x in np.ravel(tangential)],
        colour=None if colour is None else [(float(hz), float(db)) for hz, db in np.asarray(colour)], probe_error=probe_error,
    )  # fmt: skip
    told: dict[str, Any] = json.loads(report)
    heights, side_m = pattern if pattern is not None else (np.zeros((4, 4)), _SIDE_M)
    keys = {key: told[key] for key in ("micro_relief_m", "micro_relief_octaves_db", "friction", "compliance_m_n") if told[key] is not None}
    if pattern is not None:
        keys["wrap"] = "mirror"
    return Surface(heights, side_m, roughness=told["roughness"], name=name, outer_scale_m=outer_scale_m, **keys), told


def _each(tracks: Any, count: int, what: str) -> list[Any]:
    """A track for each stroke."""
    if not isinstance(tracks, list | tuple):
        return [tracks] * count
    if len(tracks) != count:
        raise ValueError(f"{what}: has {len(tracks)} entries for {count} strokes; give one for all, or one for each")
    return list(tracks)


def _track(track: npt.ArrayLike, axes: npt.NDArray[np.float64], what: str) -> npt.NDArray[np.float64]:
    """One number, or one a sample."""
    values = np.ascontiguousarray(np.ravel(np.asarray(track, dtype=np.float64)))
    if axes.ndim != 2 or values.size not in (1, axes.shape[-1]):
        raise ValueError(f"{what}: has {values.size} values beside a stroke of the shape {axes.shape}; give one, or one a sample")
    return values


def compare(
    maps: Sequence[Image],
    *,
    strokes: int = 200,
    width_m: float = 0.04,
    relief_m: float = 0.002,
    seed: int = 1,
    metamers: bool = False,
    iterations: int = 20,
    progress: Progress = None,
) -> dict[str, Any]:
    """Asks a machine which of two surfaces a stroke was on: 0.5 is chance, 1 is certain. The numbers of `asperity texture compare`.

    maps: 2 to 8 of (rows, columns), or paths; the first is the reference. strokes: on each, 20 to 10000. width_m: of a map. relief_m:
    height of white over black. metamers: also compares what is made of the others to feel like the first, by so many `iterations`.

    Returns `originals` and `metamers` (or None), each with `rows` (maps, maps), the `mean` over pairs, the first against the others
    (`reference`), and a surface against itself (`same`). Runs without the GIL; Ctrl-C stops it.
    """
    planes = [_plane(image, f"maps[{place}]") for place, image in enumerate(maps)]
    with shown(progress, "stroking") as tell:
        return _native.compare(
            planes, strokes=strokes, width_m=width_m, relief_m=relief_m, seed=seed, iterations=iterations if metamers else None,
            progress=tell,
        )  # fmt: skip
