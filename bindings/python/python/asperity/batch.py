"""Data sets of rendered touch: shards as pure functions of a specification and an index.

The specification and what is made of it are those of `asperity batch` (docs/formats/data-sets.md); so are the bytes. Shards are made by this
package in whatever process calls it; Dask and Ray only say which process that is:

>>> from asperity import batch                                             # doctest: +SKIP
>>> batch.make("strokes.toml", "strokes", shard="3/16")                    # one machine of 16; a Slurm array needs no shard
>>> batch.dask("strokes.toml", "/shared/strokes", client)                  # the workers of a dask.distributed.Client
>>> batch.ray("strokes.toml", "/shared/strokes")                           # the nodes of ray.init(...)
>>> batch.verify("strokes", sample=0.01)

A shard that is there, whole and of this build is kept; one that was cut off is made again; one of another build is refused. So a run that
was killed is gone on with by calling it again, with whichever engine.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from asperity import _native
from asperity._progress import Progress, shown

Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Shard:
    """What became of a shard. made: False where it was there. clipped: samples of the sound that 16 bits have cut off."""

    index: int
    file: str
    made: bool
    strokes: int
    clipped: int


@dataclass(frozen=True)
class Report:
    """What a run did. shards: of the whole data set; manifest: what `manifest.json` says now."""

    made: int
    kept: int
    shards: int
    clipped: int
    manifest: dict[str, Any] = field(repr=False)

    @property
    def there(self) -> int:
        """Shards that are there."""
        return len(self.manifest["shards"])


def shard(spec: Path, folder: Path, index: int, *, progress: Progress = None) -> Shard:
    """Makes shard `index`, from 0, unless it is there.

    The bytes are a function of the specification and the index alone: any process of any machine may make any shard, more than once.
    Runs without the GIL; Ctrl-C stops it and leaves nothing half-written under its name.

    Raises ValueError in the engine's words where the specification is refused, the folder cannot be written, the disk is full, or holds
    shards of another build; FileNotFoundError where there is no specification.
    """
    with shown(progress, "strokes") as tell:
        return _made(_text(spec), os.path.abspath(spec), os.path.abspath(folder), index, tell)


def make(spec: Path, folder: Path, *, shard: str | None = None, progress: Progress = None) -> Report:
    """Makes the shards of a data set one after the other, in this process, and writes the manifest.

    spec: a specification's path. folder: where the shards go; it is made. shard: "I/N", only those whose number mod N is I, from 0;
    without it what Slurm's array task says (SLURM_ARRAY_TASK_ID, _COUNT, _MIN), or all. Raises as the function `shard`.
    """
    text, path, folder = _text(spec), os.path.abspath(spec), os.path.abspath(folder)
    data = _native.NativeDataSet(text, path, folder)
    mine = _mine(data.shards, shard)
    made: list[Shard] = []
    with shown(progress, "strokes") as tell:
        for place, index in enumerate(mine):
            made.append(_one(data, index, _part(tell, place, len(mine))))
        if tell is not None:
            tell(1.0)
    return _report(data, made)


def dask(spec: Path, folder: Path, client: Any = None, *, shard: str | None = None, retries: int = 3, progress: Progress = None) -> Report:
    """Makes the shards on the workers of a Dask cluster, and writes the manifest from here.

    spec, folder, shard: as in `make`; the workers must see `folder` under the same path, and what the specification names.
    client: a `distributed.Client`; the current one unless told otherwise. retries: how often a shard that failed is tried again; a
    worker that dies is Dask's to make up for. Give workers one thread each: a stroke is one thread's work.

    Raises as `make`, with the first error of a worker; what is whole by then stays, and the next call goes on.
    """
    import distributed

    engine: Any = distributed
    client = client if client is not None else engine.Client.current()
    data, mine, work = _prepared(spec, folder, shard)
    futures = client.map(_made, *_columns(work, mine), pure=False, retries=retries)
    try:
        with shown(progress, "shards") as tell:
            return _report(data, _told((future.result() for future in engine.as_completed(futures)), len(mine), tell))
    finally:
        # What was not waited for is not wanted either.
        client.cancel(futures)


def ray(
    spec: Path, folder: Path, *, shard: str | None = None, retries: int = 3, progress: Progress = None, **options: Any
) -> Report:
    """Makes the shards as tasks of Ray, which must be initialised, and writes the manifest from here.

    options: what `ray.remote` takes, such as num_cpus=1. Else as `dask`.
    """
    import ray as engine

    if not engine.is_initialized():
        raise ValueError("ray: is not initialised; call ray.init() first, with the address of a cluster or without")
    data, mine, work = _prepared(spec, folder, shard)
    task = engine.remote(**{"num_cpus": 1, "max_retries": retries, **options})(_made)
    waiting = [task.remote(*words) for words in zip(*_columns(work, mine), strict=True)]

    def finished() -> Iterator[Shard]:
        left = list(waiting)
        while left:
            ready, left = engine.wait(left)
            yield from engine.get(ready)

    try:
        with shown(progress, "shards") as tell:
            return _report(data, _told(finished(), len(mine), tell))
    except BaseException:
        for reference in waiting:
            engine.cancel(reference)
        raise


def verify(folder: Path, sample: float = 0.0, *, progress: Progress = None) -> dict[str, int]:
    """Compares every shard with the manifest, and renders a share of the strokes again, to the bit.

    sample: 0 to 1. Returns `shards` that hold what the manifest says, `missing` ones, and strokes `rendered` again. Raises ValueError
    that names the first bad shard, FileNotFoundError where there is no manifest.
    """
    with shown(progress, "shards") as tell:
        shards, rendered, missing = _native.verify(os.path.abspath(folder), sample, progress=tell)
    return {"shards": shards, "missing": missing, "rendered": rendered}


def build(spec: Path) -> dict[str, str]:
    """What the bytes of a shard depend on: `spec_sha256`, `version`, `kernel`, `target`. Shards of another build are refused."""
    return _native.build(_text(spec), os.path.abspath(spec))


def _text(spec: Path) -> str:
    try:
        with open(spec, encoding="utf-8", newline="") as file:
            return file.read()
    except FileNotFoundError:
        raise FileNotFoundError(f"{os.fspath(spec)}: no such file; name a specification, such as examples/batch/strokes.toml") from None


def _made(text: str, path: str, folder: str, index: int, tell: Callable[[float], object] | None = None) -> Shard:
    """What a worker does. It opens the data set anew: that takes as long as a stroke, and leaves nothing behind in the worker."""
    return _one(_native.NativeDataSet(text, path, folder), index, tell)


def _one(data: _native.NativeDataSet, index: int, tell: Callable[[float], object] | None) -> Shard:
    file, made, strokes, clipped = data.shard(index, progress=tell)
    return Shard(index, file, made, strokes, clipped)


def _prepared(spec: Path, folder: Path, shard: str | None) -> tuple[_native.NativeDataSet, list[int], tuple[str, str, str]]:
    """A wrong specification or folder is told here, once, before any worker sees it."""
    work = _text(spec), os.path.abspath(spec), os.path.abspath(folder)
    data = _native.NativeDataSet(*work)
    return data, _mine(data.shards, shard), work


def _columns(work: tuple[str, str, str], mine: list[int]) -> list[list[Any]]:
    return [*([word] * len(mine) for word in work), list(mine)]


def _told(made: Iterable[Shard], count: int, tell: Callable[[float], object] | None) -> list[Shard]:
    shards = []
    for one in made:
        shards.append(one)
        if tell is not None:
            tell(len(shards) / count)
    return shards


def _report(data: _native.NativeDataSet, made: list[Shard]) -> Report:
    manifest: dict[str, Any] = json.loads(data.write_manifest())
    count = sum(one.made for one in made)
    return Report(count, len(made) - count, data.shards, sum(one.clipped for one in made), manifest)


def _part(tell: Callable[[float], object] | None, place: int, of: int) -> Callable[[float], object] | None:
    return None if tell is None else lambda done: tell((place + done) / of)


def _mine(shards: int, share: str | None) -> list[int]:
    index, of = _share(share) if share is not None else _share_of_slurm()
    return list(range(index, shards, of))


def _share(text: str) -> tuple[int, int]:
    index, _, of = text.partition("/")
    if index.isdecimal() and of.isdecimal() and int(index) < int(of):
        return int(index), int(of)
    raise ValueError(f'shard: "{text}" is refused; must be I/N, I from 0 to N - 1')


def _share_of_slurm() -> tuple[int, int]:
    """What Slurm says of an array's task; everything where this is none."""
    words = [os.environ.get(f"SLURM_ARRAY_TASK_{name}", "") for name in ("ID", "COUNT", "MIN")]
    if not (words[0].isdecimal() and words[1].isdecimal()):
        return 0, 1
    index, of = int(words[0]) - (int(words[2]) if words[2].isdecimal() else 0), int(words[1])
    return (index, of) if 0 <= index < of else (0, 1)
