"""Contacts as structured arrays, and as the JSON Lines of a contact log.

A row is an event, its fields the keys of the log (docs/formats/log.md): what is missing is NaN, -1 or "".

>>> from asperity import contacts
>>> rows = contacts.stroke(speed=0.1, force=0.5, duration=0.1, extent=(0.14, 0.14))
>>> rows["event"][0], rows["event"][-1], contacts.from_jsonl(contacts.to_jsonl(rows)).shape == rows.shape
('begin', 'end', True)
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from asperity import _native

Contacts = npt.NDArray[np.void]
"""A structured array with the fields of `dtype()`, or some of them."""

_NAMES = ("surface", "probe", "holder", "body", "other", "striker")
_NUMBERS = (
    "normal_force_n", "closing_m_s", "depth_m", "slip_m_s", "roll_radius_m", "gain", "importance", "speed_m_s", "mass_kg", "radius_m",
    "restitution",
)  # fmt: skip
_VECTORS = {"uv": 2, "velocity_m_s": 2, "at_m": 3, "direction": 3}
_COUNTS = ("actuator", "position")
_EVENTS = ("begin", "move", "end", "impact")


def dtype(name_length: int = 16) -> np.dtype[np.void]:
    """The fields of a contact: time `t` in seconds, `event`, `contact` (uint64), and every key of the log by its name.

    name_length: longest name of a surface, body or probe that fits.
    """
    text = f"U{max(name_length, 1)}"
    fields: list[Any] = [("t", "f8"), ("event", "U6"), ("contact", "u8")]
    fields += [(name, "f8", (size,)) for name, size in _VECTORS.items()]
    fields += [(name, "f8") for name in _NUMBERS]
    fields += [(name, "i4") for name in _COUNTS]
    fields += [(name, text) for name in _NAMES]
    return np.dtype(fields)


def empty(count: int, name_length: int = 16) -> Contacts:
    """`count` rows in which everything is missing and t is 0."""
    rows = np.zeros(count, dtype(name_length))
    for name in (*_VECTORS, *_NUMBERS):
        rows[name] = np.nan
    for name in _COUNTS:
        rows[name] = -1
    return rows


def stroke(
    *,
    speed: float = 0.1,
    force: float = 0.6,
    duration: float = 1.0,
    extent: tuple[float, float],
    surface: str = "surface",
    start: tuple[float, float] = (0.1, 0.5),
    direction_deg: float = 0.0,
    rate: float = 60.0,
    actuator: int | None = 0,
    probe: str | None = None,
    contact: int = 1,
) -> Contacts:
    """A straight stroke: a begin, moves at `rate` Hz, an end.

    speed: m/s along the surface. force: N. duration: s. extent: width and height that uv 1 spans, m. start: uv. direction_deg: 0 along
    u, 90 along v (down). It may run beyond uv 0 to 1, where the surface goes on as its `wrap` says.

    Raises ValueError where a number is not finite, or duration or rate is not above 0.
    """
    given = {"speed": speed, "force": force, "duration": duration, "direction_deg": direction_deg, "rate": rate}
    for name, value in given.items():
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value} is refused; must be finite")
        if name in ("duration", "rate") and value <= 0:
            raise ValueError(f"{name}: {value} is refused; must be above 0")
    moves = max(math.ceil(duration * rate - 1e-9), 1)
    rows = empty(moves + 1, max(len(surface), len(probe or "")))
    t = np.append(np.arange(moves) / rate, duration)
    angle = math.radians(direction_deg)
    velocity = speed * np.array([math.cos(angle), math.sin(angle)])
    rows["t"], rows["contact"] = t, contact
    rows["event"] = ["begin"] + ["move"] * (moves - 1) + ["end"]
    rows["uv"] = np.asarray(start) + t[:, None] * velocity / np.asarray(extent)
    rows["velocity_m_s"] = velocity
    rows["normal_force_n"] = force
    rows["surface"] = surface
    rows["actuator"] = -1 if actuator is None else actuator
    rows["probe"] = probe or ""
    return rows


def _event(row: Mapping[str, Any]) -> dict[str, Any]:
    kind = str(row["event"])
    event: dict[str, Any] = {"t": float(row["t"]), "event": kind}
    if kind != "impact":
        event["contact"] = int(row["contact"])
    if kind == "end":
        return event
    # A move goes on with what its begin has told.
    told_once = ("surface", "actuator", "probe", "holder", "closing_m_s") if kind == "move" else ()
    for name, value in row.items():
        if name in told_once or name in ("t", "event", "contact"):
            continue
        if name in _VECTORS:
            if not all(map(math.isnan, value)):
                event[name] = [float(x) for x in value]
        elif name in _NUMBERS:
            if not math.isnan(value):
                event[name] = float(value)
        elif name in _COUNTS:
            if value >= 0:
                event[name] = int(value)
        elif name in _NAMES and value != "":
            # A striker may be a table of constants.
            event[name] = json.loads(value) if value.startswith("{") else value
    return event


def to_events(contacts: Contacts) -> list[dict[str, Any]]:
    """The rows as dictionaries, without what is missing."""
    fields = contacts.dtype.names
    if fields is None or "t" not in fields or "event" not in fields:
        raise ValueError("contacts: is no structured array with t and event; make one with asperity.contacts.empty")
    unknown = set(fields) - set(dtype().names or ())
    if unknown:
        raise ValueError(f"contacts: unknown fields {', '.join(sorted(unknown))}; must be of asperity.contacts.dtype()")
    # By columns: numpy loses an interrupt that arrives while it reads a field of a row.
    flat = contacts.ravel()
    columns = [flat[name].tolist() for name in fields]
    return [_event(dict(zip(fields, row, strict=True))) for row in zip(*columns, strict=True)]


def lines(events: Iterable[Mapping[str, Any]]) -> str:
    """Dictionaries as JSON Lines. Raises ValueError where a number is not finite."""
    text = []
    for index, event in enumerate(events):
        try:
            text.append(json.dumps(event, allow_nan=False, default=_plain))
        except ValueError as error:
            bad = [key for key, value in event.items() if not np.all(np.isfinite(_numbers(value)))]
            raise ValueError(f"event {index + 1}: {', '.join(bad)}: is not finite; must be a number") from error
    return "".join(line + "\n" for line in text)


def _numbers(value: Any) -> npt.NDArray[np.float64]:
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return np.zeros(0)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no number, text or list")


def to_jsonl(contacts: Contacts) -> str:
    """The rows as a contact log, one event a line. Raises ValueError where a field is unknown or a number infinite."""
    return lines(to_events(contacts))


def from_jsonl(text: str, name: str = "contacts") -> Contacts:
    """The rows of a contact log, read as strictly as the engine does.

    Raises ValueError with file and line where it is none, and where it edits its scene: such a log is rendered from its file.
    """
    _native.parse_log(text, name)
    events = [json.loads(line) for line in text.splitlines() if line.strip()]
    longest = 16
    for number, event in enumerate(events, 1):
        if event["event"] not in _EVENTS:
            raise ValueError(f"{name}:{number}: {event['event']} edits the scene; give the file itself to render")
        longest = max(longest, *(len(_named(event.get(key, ""))) for key in _NAMES))
    rows = empty(len(events), longest)
    columns = {name: rows[name] for name in rows.dtype.names or ()}
    for place, event in enumerate(events):
        for key in columns.keys() & event.keys():
            columns[key][place] = _named(event[key]) if key in _NAMES else event[key]
    return rows


def _named(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def load(path: str | os.PathLike[str]) -> Contacts:
    """The rows of a `.jsonl` file. Raises FileNotFoundError, and ValueError as `from_jsonl`."""
    return from_jsonl(read(path), os.fspath(path))


def read(path: str | os.PathLike[str]) -> str:
    """The text of a log."""
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except FileNotFoundError:
        raise FileNotFoundError(f"{os.fspath(path)}: no such file; name a file that exists") from None


def save(path: str | os.PathLike[str], contacts: Contacts) -> None:
    """Writes the rows as a `.jsonl` file, in place of the one there only when all is written."""
    part = f"{os.fspath(path)}.part"
    with open(part, "w", encoding="utf-8") as file:
        file.write(to_jsonl(contacts))
    os.replace(part, path)
