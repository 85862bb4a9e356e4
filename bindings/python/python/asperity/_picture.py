"""The picture and the player of a take: SVG of its waves, 16-bit WAV of its sound."""

from __future__ import annotations

import io
import wave
from typing import Any

import numpy as np
import numpy.typing as npt

_WIDTH, _ROW = 760, 90
_HEARD, _FELT = "#7b4fb5", "#2f8f5b"
_MOST_ROWS = 8


def wav16(samples: npt.NDArray[Any], sr: float) -> bytes:
    """One channel as a 16-bit WAV file; what lies beyond full scale is cut."""
    out = io.BytesIO()
    with wave.open(out, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(round(sr))
        file.writeframes((np.clip(samples, -1.0, 1.0) * 32_767.0).astype("<i2").tobytes())
    return out.getvalue()


def _outline(samples: npt.NDArray[Any], top: float) -> tuple[str, float]:
    """The band between smallest and largest sample of every column, and its peak."""
    columns = min(_WIDTH, max(len(samples), 1))
    edges = np.linspace(0, len(samples), columns + 1).astype(int)
    parts = [samples[a:b] for a, b in zip(edges[:-1], edges[1:], strict=True) if b > a]
    low, high = np.array([part.min() for part in parts]), np.array([part.max() for part in parts])
    peak = float(max(np.max(np.abs(low), initial=0.0), np.max(np.abs(high), initial=0.0)))
    scale = 0.4 * _ROW / max(peak, 1e-12)
    middle = top + 0.5 * _ROW
    x = np.linspace(0, _WIDTH, len(parts))
    there = [f"{a:.1f},{middle - scale * b:.1f}" for a, b in zip(x, high, strict=True)]
    back = [f"{a:.1f},{middle - scale * b:.1f}" for a, b in zip(x[::-1], low[::-1], strict=True)]
    return " ".join(there + back), peak


def svg(audio: npt.NDArray[Any], haptic: npt.NDArray[Any], duration_s: float) -> str:
    """Waves of every bus and channel over time, each to its own peak, which is written beside it."""
    buses = np.atleast_2d(audio)
    rows = [(f"heard {i}", _HEARD, bus) for i, bus in enumerate(buses)]
    rows += [(f"felt {i}", _FELT, channel) for i, channel in enumerate(haptic)]
    rows = rows[:_MOST_ROWS]
    height = _ROW * len(rows) + 20
    drawn = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" width="{_WIDTH}" font-size="11">']
    for row, (label, colour, samples) in enumerate(rows):
        top = row * _ROW
        if len(samples):
            points, peak = _outline(samples, top)
            drawn.append(f'<polygon points="{points}" fill="{colour}" stroke="{colour}" stroke-width="0.5"/>')
            label += f", peak {peak:.3g}"
        drawn.append(f'<text x="4" y="{top + 14}">{label}</text>')
    drawn.append(f'<text x="4" y="{height - 5}">0 s</text>')
    drawn.append(f'<text x="{_WIDTH - 4}" y="{height - 5}" text-anchor="end">{duration_s:.2f} s</text></svg>')
    return "".join(drawn)
