"""Touch into signal: what a finger feels and what an object sounds like, as numpy arrays.

>>> import asperity as asp, numpy as np
>>> heights_m = 1e-4 * np.random.default_rng(1).random((256, 256))
>>> surface = asp.Surface(heights_m, extent=0.14).on(asp.Body.stock("plate", 0.14, "ceramic"))
>>> take = asp.stroke(surface, speed=0.08, force=0.6, duration=0.5, sr=48_000)
>>> take.audio.shape, take.haptic.shape
((72000,), (1, 72000))

All numbers are SI units; arrays of heights are metres, rows from top to bottom. What the engine refuses comes as `ValueError` (or
`FileNotFoundError`) with the engine's own sentence: which file or field, what is wrong, what would be right.
"""

from asperity import batch, contacts, haptics, texture
from asperity._devices import HeadsetFrame, HeadsetFrames, PadLevels
from asperity._fit import Fit, fit
from asperity._live import Renderer, Scene, play
from asperity._microphones import Microphones, Thing
from asperity._native import VERSION as __version__
from asperity._native import names_of
from asperity._render import TouchWarning, render, stroke
from asperity._scene import Body, Brownian, Lattice, Sand, SceneFile, Solid, Surface
from asperity._shape import Shape, modes
from asperity._take import Take
from asperity._tip import Tip, TipStep

__all__ = [
    "Body",
    "Brownian",
    "Fit",
    "HeadsetFrame",
    "HeadsetFrames",
    "Lattice",
    "Microphones",
    "PadLevels",
    "Renderer",
    "Sand",
    "Scene",
    "SceneFile",
    "Shape",
    "Solid",
    "Surface",
    "Take",
    "Thing",
    "Tip",
    "TipStep",
    "TouchWarning",
    "__version__",
    "batch",
    "contacts",
    "fit",
    "haptics",
    "modes",
    "names_of",
    "play",
    "render",
    "stroke",
    "texture",
]
