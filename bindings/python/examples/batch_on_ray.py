"""A data set on a local Ray, beside the same in one process: python batch_on_ray.py SPEC.toml [WORKERS]

Every byte must be the same. Ray's own processes want some seconds of a machine that is not busy before they answer.
"""

import pathlib
import sys
import tempfile
import time

import ray

from asperity import batch


def files_of(folder: pathlib.Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file() and not path.name.startswith(".")}


spec, workers = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 2
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    began = time.perf_counter()
    ray.init(num_cpus=workers, include_dashboard=False, log_to_driver=False)
    print(f"ray {ray.__version__} answered after {time.perf_counter() - began:.1f} s")
    began = time.perf_counter()
    told = batch.ray(spec, folder / "ray")
    print(f"{workers} workers: {told.made} shards in {time.perf_counter() - began:.1f} s")
    # Two shards are lost; the next run makes these alone.
    for shard in sorted((folder / "ray").glob("shard-*[0-9].*"))[:4:2]:
        shard.unlink()
    print(f"resumed: {batch.ray(spec, folder / 'ray')}")
    ray.shutdown()
    began = time.perf_counter()
    batch.make(spec, folder / "one", progress=False)
    print(f"one process: {time.perf_counter() - began:.1f} s")
    theirs, ours = files_of(folder / "ray"), files_of(folder / "one")
    if theirs != ours:
        sys.exit("the bytes differ")
    print(f"{len(ours)} files, {sum(map(len, ours.values())) / 1e6:.1f} MB, every byte equal")
