"""A tracked tip: a pose becomes a contact with a force."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from asperity import _native
from asperity._scene import SceneLike, sources


class TipStep(NamedTuple):
    """What a step of a tracked tip comes to."""

    event: str | None
    """"begin", "move", "end", or None where nothing is touched."""
    surface: str | None
    """Name of the surface."""
    normal_force_n: float
    """Force into the surface, N; 0 where nothing is touched."""
    uv: tuple[float, float] | None
    """Texture coordinates of the contact."""
    velocity_m_s: tuple[float, float] | None
    """Velocity along u and v, m/s."""
    closing_m_s: float
    """Speed into the surface at a begin, m/s."""

    def keys(self, contact: int = 1, actuator: int | None = 0) -> dict[str, Any] | None:
        """The event for `Scene.report`, or None where nothing is touched."""
        if self.event is None:
            return None
        told: dict[str, Any] = {"event": self.event, "contact": contact}
        if self.uv is None or self.velocity_m_s is None:
            return told
        told |= {"uv": list(self.uv), "velocity_m_s": list(self.velocity_m_s), "normal_force_n": self.normal_force_n}
        if self.event == "begin":
            told |= {"surface": self.surface, "closing_m_s": self.closing_m_s}
            if actuator is not None:
                told["actuator"] = actuator
        return told


class Tip:
    """One tracked tip over surfaces that have a frame; a hand has one for each finger.

    surfaces: as the scene of `asperity.render`; each needs `frame`, a table of origin_m, u_axis and v_axis in the axes of the tracked
    positions. Out of the body is u x v. stiffness_n_m: force over depth, 200 by default. mass_kg: of the proxy that follows the tip
    along the surface, critically damped, 0.1 by default; it lags by 2 sqrt(mass / stiffness). max_force_n: 5 by default.

    >>> import asperity as asp
    >>> frame = {"origin_m": [0, 0, 0], "u_axis": [1, 0, 0], "v_axis": [0, 1, 0]}
    >>> tip = asp.Tip(asp.Solid("granite", 0.2, frame=frame))
    >>> steps = [tip.step(1 / 90, (0.1, 0.1, max(0.01 - 0.001 * n, -0.005))) for n in range(60)]
    >>> steps[-1].event, round(steps[-1].normal_force_n, 3)
    ('move', 1.0)

    Raises ValueError where a surface has no frame or a number is out of its range.
    """

    def __init__(
        self,
        surfaces: SceneLike,
        *,
        stiffness_n_m: float | None = None,
        mass_kg: float | None = None,
        max_force_n: float | None = None,
    ) -> None:
        path, files = sources(surfaces)
        self._native = _native.TrackedTip(path, files, stiffness_n_m, mass_kg, max_force_n)

    def step(self, dt: float, position_m: Sequence[float]) -> TipStep:
        """The tip is at `position_m` (x, y, z), `dt` seconds after the last step. Raises ValueError where either is no such number."""
        x, y, z = position_m
        return _step(self._native.step(dt, (float(x), float(y), float(z))))

    def lift(self) -> TipStep:
        """The game has moved the hand elsewhere: ends what it touches; the next step starts anew."""
        return _step(self._native.lift())


_Told = tuple[str | None, str | None, Sequence[float] | None, Sequence[float] | None, float, float]


def _step(told: _Told) -> TipStep:
    event, surface, uv, velocity_m_s, force_n, closing_m_s = told
    return TipStep(event, surface, force_n, _pair(uv), _pair(velocity_m_s), closing_m_s)


def _pair(numbers: Sequence[float] | None) -> tuple[float, float] | None:
    return None if numbers is None else (numbers[0], numbers[1])
