"""Tools on pictures and height maps: what is in them, and surfaces made from them."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native
from asperity._progress import Progress, shown

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
