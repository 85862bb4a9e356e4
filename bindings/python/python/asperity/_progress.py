"""Progress of long work: a bar where somebody looks on, a callable where somebody listens."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = bool | Callable[[float], object] | None
"""None: a bar where stderr is a terminal or a notebook looks on, and tqdm is installed. True, False: with, without. A callable is told
the part done, 0 to 1, twenty times a second; what it raises stops the work."""


@contextmanager
def shown(progress: Progress, what: str) -> Iterator[Callable[[float], object] | None]:
    """What the native half calls with the part done, or None."""
    if callable(progress):
        yield progress
        return
    somebody_looks = sys.stderr.isatty() or "ipykernel" in sys.modules
    if progress is False or (progress is None and not somebody_looks):
        yield None
        return
    try:
        from tqdm import tqdm
    except ImportError:
        if progress:
            raise
        yield None
        return
    # Work of less than a second shows nothing.
    with tqdm(total=1.0, desc=what, delay=1.0, leave=False, bar_format="{desc} {percentage:3.0f}% |{bar}| {elapsed}") as bar:

        def tell(done: float) -> None:
            # Not `refresh`, which shows the bar before its delay is over.
            bar.update(done - bar.n)

        yield tell
