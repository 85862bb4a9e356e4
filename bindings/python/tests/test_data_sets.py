"""Data sets: the program's bytes, on Dask, after a kill, on a full disk; opened by strangers."""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from machine import busy

import asperity as asp
from asperity import batch

SPEC = """
name = "little"
seed = 11
strokes = {strokes}
per_shard = {per_shard}
[surface]
choice = [{{ solid = "granite" }}, {{ solid = "wood" }}, {{ name = "plate", roughness = {{ uniform = [0, 1] }} }}]
[body]
stock = "plate"
size_m = {{ uniform = [0.1, 0.3] }}
material = {{ choice = ["ceramic", "wood"] }}
[finger]
speed_m_s = {{ log_uniform = [0.02, 0.3] }}
force_n = {{ normal = [0.6, 0.2], within = [0.1, 2] }}
path = {{ choice = ["line", "arc", "back-and-forth"] }}
duration_s = {duration_s}
[output]
format = "{format}"
tail_s = 0.01
audio = {{ rate_hz = 22050, codec = "{codec}" }}
"""
# The heavy runs: ten thousand strokes three times over.
CLUSTER = pytest.mark.skipif(os.environ.get("ASPERITY_CLUSTER") == "no", reason="ASPERITY_CLUSTER=no: without the clusters")


def spec_in(folder, strokes=12, per_shard=4, duration_s=0.05, format="parquet", codec="f32", name="spec.toml"):
    path = folder / name
    text = SPEC.format(strokes=strokes, per_shard=per_shard, duration_s=duration_s, format=format, codec=codec)
    path.write_text(text)
    return path


def files_of(folder):
    """Every file that a data set consists of, and its bytes."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file() and not path.name.startswith(".")}


def halves_in(folder):
    return [path.name for path in folder.iterdir() if path.name.endswith(".part")]


@pytest.mark.parametrize("format, codec", [("parquet", "f32"), ("webdataset", "flac16")])
def test_shards_have_the_bytes_of_the_programs(program, tmp_path, format, codec):
    spec = spec_in(tmp_path, format=format, codec=codec)
    subprocess.run([program, "batch", spec, "-o", tmp_path / "theirs"], check=True, capture_output=True)
    told = batch.make(spec, tmp_path / "ours")
    assert (told.made, told.kept, told.shards, told.there) == (3, 0, 3, 3)
    assert files_of(tmp_path / "ours") == files_of(tmp_path / "theirs")
    assert batch.verify(tmp_path / "ours", sample=1.0) == {"shards": 3, "missing": 0, "rendered": 12}


def test_the_manifest_names_build_levels_and_units(tmp_path):
    spec = spec_in(tmp_path)
    manifest = batch.make(spec, tmp_path / "set").manifest
    assert manifest == json.loads((tmp_path / "set" / "manifest.json").read_text())
    assert {key: manifest[key] for key in ("spec_sha256", "version", "kernel", "target")} == batch.build(spec)
    assert manifest["levels"]["haptic_full_scale"] > 0 and manifest["levels"]["audio_gain"] > 0
    assert manifest["units"]["haptic"] == "m" and manifest["units"]["haptic_rate_hz"] == 8000
    assert sum(shard["strokes"] for shard in manifest["shards"]) == 12 and len(manifest["splits"]) == 3


def test_a_shard_is_a_function_of_specification_and_index(tmp_path):
    spec = spec_in(tmp_path)
    batch.make(spec, tmp_path / "all")
    for index in (2, 0, 1):
        assert batch.shard(spec, tmp_path / "one", index).made
    assert not batch.shard(spec, tmp_path / "one", 1).made
    all_of_it, ones = files_of(tmp_path / "all"), files_of(tmp_path / "one")
    del all_of_it["manifest.json"]
    assert ones == all_of_it
    with pytest.raises(ValueError, match="index: 3 is refused; must be 0 to 2"):
        batch.shard(spec, tmp_path / "one", 3)


def test_shares_of_machines_are_the_whole_and_slurm_says_its_own(tmp_path, monkeypatch):
    spec = spec_in(tmp_path)
    assert batch.make(spec, tmp_path / "set", shard="1/2").made == 1
    assert [path.name for path in (tmp_path / "set").glob("shard-*.parquet")] == ["shard-000001.parquet"]
    for key, value in {"ID": "5", "COUNT": "2", "MIN": "5"}.items():
        monkeypatch.setenv(f"SLURM_ARRAY_TASK_{key}", value)
    told = batch.make(spec, tmp_path / "set")
    assert (told.made, told.kept, told.there) == (2, 0, 3)
    for wrong in ("2/2", "1", "-1/2", "a/b", "1/0"):
        with pytest.raises(ValueError, match="must be I/N"):
            batch.make(spec, tmp_path / "set", shard=wrong)


def test_every_record_is_rendered_again_by_its_own_scene_and_contacts(tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    batch.make(spec_in(tmp_path, strokes=3), tmp_path / "set")
    for row in pq.read_table(tmp_path / "set" / "shard-000000.parquet").to_pylist():
        scene = tmp_path / "set" / f"{row['id']}.toml"
        scene.write_text(row["scene"])
        scene.with_suffix(".jsonl").write_text(row["contacts"])
        assert asp.render(scene, kernel="portable").audio.tobytes() == np.float32(row["audio"]).tobytes()


def test_work_that_is_stopped_leaves_nothing_half_written_and_is_gone_on_with(tmp_path):
    spec = spec_in(tmp_path, strokes=3000, per_shard=1000)
    seen = []

    def stop(done):
        seen.append(done)
        if done > 0.5:
            raise InterruptedError("enough")

    with pytest.raises(InterruptedError, match="enough"):
        batch.make(spec, tmp_path / "set", progress=stop)
    assert 0.5 < seen[-1] < 0.99 and seen == sorted(seen)
    assert not halves_in(tmp_path / "set") and (tmp_path / "set" / "shard-000000.parquet").exists()
    told = batch.make(spec, tmp_path / "set")
    assert told.kept >= 1 and told.made >= 1 and told.there == 3


def test_a_killed_process_is_gone_on_with_to_the_same_bytes(tmp_path):
    spec = spec_in(tmp_path, strokes=1200, per_shard=300)
    whole = batch.make(spec, tmp_path / "whole")
    code = "import sys; from asperity import batch; batch.make(sys.argv[1], sys.argv[2])"
    child = subprocess.Popen([sys.executable, "-c", code, spec, tmp_path / "cut"])
    while not (tmp_path / "cut" / "shard-000001.parquet.sha256").exists():
        assert child.poll() is None
        time.sleep(0.005)
    child.kill()
    child.wait()
    assert not (tmp_path / "cut" / "shard-000003.parquet").exists()
    # And one shard is cut off, another lost its hash, as a machine that went down leaves them.
    first = tmp_path / "cut" / "shard-000000.parquet"
    first.write_bytes(first.read_bytes()[:1000])
    (tmp_path / "cut" / "shard-000001.parquet.sha256").unlink()
    told = batch.make(spec, tmp_path / "cut")
    assert told.made >= 3 and told.there == whole.shards == 4
    assert files_of(tmp_path / "cut") == files_of(tmp_path / "whole")


def test_shards_of_another_build_are_refused(tmp_path):
    spec = spec_in(tmp_path)
    batch.make(spec, tmp_path / "set")
    before = files_of(tmp_path / "set")
    other = tmp_path / "other.toml"
    other.write_text(spec.read_text().replace("seed = 11", "seed = 12"))
    with pytest.raises(ValueError, match="is of another specification"):
        batch.make(other, tmp_path / "set")
    manifest = tmp_path / "set" / "manifest.json"
    told = json.loads(manifest.read_text())
    manifest.write_text(json.dumps({**told, "version": "0.0.1"}))
    with pytest.raises(ValueError, match=r"is of another build: version 0\.0\.1 instead of"):
        batch.shard(spec, tmp_path / "set", 0)
    manifest.write_bytes(before["manifest.json"])
    assert files_of(tmp_path / "set") == before and batch.make(spec, tmp_path / "set").kept == 3


WRONG = [
    ("strokes = 12", "strokes = 0", "strokes: 0 is refused"),
    ("per_shard = 4", "per_shards = 4", "per_shards"),
    ('solid = "granite"', 'solid = "cheese"', "cheese"),
    ('"arc"', '"zigzag"', "zigzag"),
    ("[0.02, 0.3]", "[0, 0.3]", "log_uniform: 0 is refused"),
    ("choice = [{ solid", 'choice = ["no-such.toml", { solid', "no-such.toml: no such file"),
]


@pytest.mark.parametrize("right, wrong, piece", WRONG)
def test_a_wrong_specification_is_one_sentence_and_leaves_no_shard(tmp_path, right, wrong, piece):
    spec = spec_in(tmp_path)
    assert right in spec.read_text()
    spec.write_text(spec.read_text().replace(right, wrong))
    with pytest.raises(ValueError) as refused:
        batch.make(spec, tmp_path / "set")
    assert piece in str(refused.value) and "\n" not in str(refused.value)
    if (tmp_path / "set").exists():
        assert not halves_in(tmp_path / "set")


def test_missing_files_are_file_not_found_errors(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"gone\.toml: no such file"):
        batch.make(tmp_path / "gone.toml", tmp_path / "set")
    with pytest.raises(FileNotFoundError, match=r"manifest\.json: no such file"):
        batch.verify(tmp_path / "gone")


def test_a_folder_that_cannot_be_written_is_one_sentence(tmp_path):
    spec = spec_in(tmp_path)
    (tmp_path / "file").write_text("")
    folders = [tmp_path / "file", pathlib.Path("/proc/asperity")]
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o555)
    if os.access(locked, os.W_OK):
        print("the system's administrator may write everywhere: a folder without the right to write is left out")
    else:
        folders.append(locked)
    for folder in folders:
        with pytest.raises(ValueError, match="cannot be written") as refused:
            batch.make(spec, folder)
        assert str(folder) in str(refused.value) and "\n" not in str(refused.value)


# A process that may write files of so many bytes only: what a full disk is, without one.
SMALL_FILES = """
import resource, sys
from asperity import batch
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[3]), resource.RLIM_INFINITY))
try:
    batch.make(sys.argv[1], sys.argv[2])
except ValueError as error:
    sys.exit(str(error))
"""


def test_a_disk_that_holds_no_more_is_one_sentence_and_the_run_is_gone_on_with(tmp_path):
    # The last shard is the small one: what is whole before stays.
    spec = spec_in(tmp_path, strokes=150, per_shard=100)
    whole = batch.make(spec, tmp_path / "whole")
    larger = (tmp_path / "whole" / "shard-000000.parquet").stat().st_size
    assert batch.make(spec, tmp_path / "set", shard="1/2").made == 1
    before = files_of(tmp_path / "set")
    child = subprocess.run(
        [sys.executable, "-c", SMALL_FILES, spec, tmp_path / "set", str(larger // 2)], capture_output=True, text=True, check=False
    )
    assert child.returncode == 1 and "shard-000000.parquet: cannot be written" in child.stderr
    assert child.stderr.count("\n") == 1, child.stderr
    assert files_of(tmp_path / "set") == before and not halves_in(tmp_path / "set")
    told = batch.make(spec, tmp_path / "set")
    assert (told.made, told.kept) == (1, 1) and whole.there == 2
    assert files_of(tmp_path / "set") == files_of(tmp_path / "whole")


def test_a_full_disk_is_one_sentence_and_the_run_is_gone_on_with_where_there_is_room(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", disk], capture_output=True, text=True, check=False)
    if mount.returncode != 0:
        pytest.skip(f"no small disk can be mounted here: {mount.stderr.strip()}")
    try:
        spec = spec_in(tmp_path, strokes=400, per_shard=50)
        with pytest.raises(ValueError, match=r"shard-00000\d\.parquet: cannot be written") as refused:
            batch.make(spec, disk / "set")
        assert "\n" not in str(refused.value) and not halves_in(disk / "set")
        kept = [path.name for path in (disk / "set").glob("shard-*.parquet")]
        assert 1 <= len(kept) < 8
        subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
        told = batch.make(spec, disk / "set")
        assert (told.kept, told.there) == (len(kept), 8)
        assert batch.verify(disk / "set") == {"shards": 8, "missing": 0, "rendered": 0}
    finally:
        subprocess.run(["umount", disk], check=True)


def peak_mib():
    """Most memory that this process has held. Not getrusage's: that begins with what its parent held."""
    status = pathlib.Path("/proc/self/status").read_text()
    return int(re.search(r"VmHWM:\s*(\d+) kB", status)[1]) / 1024


PEAK = """
import sys
from asperity import batch
from test_data_sets import peak_mib
batch.make(sys.argv[1], sys.argv[2])
print(peak_mib())
"""
ON_LINUX = pytest.mark.skipif(not pathlib.Path("/proc/self/status").exists(), reason="most memory held is read from /proc")


@ON_LINUX
def test_a_worker_holds_less_than_500_mebibytes(tmp_path):
    # Strokes of two seconds, uncompressed, a whole row group of them.
    spec = spec_in(tmp_path, strokes=80, per_shard=80, duration_s=2.0)
    run = subprocess.run([sys.executable, "-c", PEAK, spec, tmp_path / "set"], check=True, capture_output=True, text=True)
    held_mib = float(run.stdout)
    print(f"one process held {held_mib:.0f} MiB at most")
    assert 20 < held_mib < 500


def cluster(workers):
    from distributed import Client, LocalCluster

    made = LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50)
    client = Client(made)
    client.wait_for_workers(workers)
    return made, client


def pids(client):
    return sorted(client.run(os.getpid).values())


@CLUSTER
@ON_LINUX
def test_ten_thousand_strokes_on_dask_are_one_processes_bytes_though_a_worker_is_killed_and_the_run_is_cut(tmp_path):
    pytest.importorskip("distributed")
    spec = spec_in(tmp_path, strokes=10_000, per_shard=250, duration_s=0.02)
    whole = batch.make(spec, tmp_path / "whole")
    killed = []

    def watch(done):
        if done > 0.2 and not killed:
            killed.append(pids(client)[0])
            os.kill(killed[0], signal.SIGKILL)
        if done > 0.6:
            raise InterruptedError("cut")

    made, client = cluster(2)
    with made, client:
        with pytest.raises(InterruptedError, match="cut"):
            batch.dask(spec, tmp_path / "cut", client, progress=watch)
    assert killed
    made, client = cluster(2)
    with made, client:
        told = batch.dask(spec, tmp_path / "cut", client)
        # Of another specification, told before a worker hears of it.
        other = tmp_path / "other.toml"
        other.write_text(spec.read_text().replace("seed = 11", "seed = 12"))
        with pytest.raises(ValueError, match="is of another specification"):
            batch.dask(other, tmp_path / "cut", client)
        # And by a worker, where there is no manifest to tell from.
        (tmp_path / "late").mkdir()
        (tmp_path / "late" / "shard-000007.parquet").write_bytes((tmp_path / "cut" / "shard-000007.parquet").read_bytes())
        with pytest.raises(ValueError, match=r"shard-000007\.parquet: is of another specification"):
            batch.dask(other, tmp_path / "late", client, shard="7/40", retries=0)
        peaks_mib = list(client.run(peak_mib).values())
    print(f"{told.kept} shards were there, {told.made} were made; workers held {max(peaks_mib):.0f} MiB at most")
    assert told.kept >= 24 and told.made >= 1 and told.there == whole.there == 40
    assert files_of(tmp_path / "cut") == files_of(tmp_path / "whole")
    assert max(peaks_mib) < 500


@CLUSTER
def test_two_dask_workers_make_strokes_in_much_less_time_than_one(tmp_path):
    pytest.importorskip("distributed")
    scaling = busy(6_000_000)
    if scaling < 1.8:
        pytest.skip(f"two busy processes alone get {scaling:.2f} times as much done here; 1.8 are needed to tell")
    spec = spec_in(tmp_path, strokes=4000, per_shard=100, duration_s=0.1, codec="flac16")
    seconds = {1: [], 2: []}
    clusters = {count: cluster(count) for count in seconds}
    try:
        for turn in range(3):
            for count, (_, client) in clusters.items():
                began = time.perf_counter()
                batch.dask(spec, tmp_path / f"{count}-{turn}", client)
                seconds[count].append(time.perf_counter() - began)
    finally:
        for made, client in clusters.values():
            client.close()
            made.close()
    ratio = max(one / two for one, two in zip(seconds[1], seconds[2], strict=True))
    print(f"two workers get {ratio:.2f} times as much done as one; two processes {scaling:.2f} times")
    if ratio < 1.7 and (scaling := busy(6_000_000)) < 1.8:
        pytest.skip(f"somebody has come: two busy processes get {scaling:.2f} times as much done by now; 1.8 are needed to tell")
    assert ratio >= 1.7


def snippets():
    """The blocks of Python in the data sets' page."""
    source = os.environ.get("ASPERITY_PYTHON_SOURCE")
    root = pathlib.Path(source) if source else pathlib.Path(__file__).resolve().parents[1]
    page = (root.parents[1] / "docs" / "formats" / "data-sets.md").read_text()
    block = re.search(r"```python\n(import pyarrow.*?)```", page, re.DOTALL)
    assert block, "docs/formats/data-sets.md has no block that begins with pyarrow"
    return re.split(r"\n\n(?=import )", block[1])


def test_strangers_open_a_data_set_with_the_snippets_of_its_page(tmp_path, monkeypatch, capsys):
    pytest.importorskip("pyarrow")
    pytest.importorskip("webdataset")
    for format in ("parquet", "webdataset"):
        batch.make(spec_in(tmp_path, strokes=12, per_shard=3, format=format), tmp_path / format)
    strokes = tmp_path / "strokes"
    strokes.mkdir()
    for path in [*(tmp_path / "parquet").glob("*.parquet"), *(tmp_path / "webdataset").glob("*.tar")]:
        path.rename(strokes / path.name)
    monkeypatch.chdir(tmp_path)
    table, stream, batches = snippets()
    known = {}
    exec(table, known)
    assert len(known["row"]["haptic"]) == 480 and known["row"]["surface"] in ("granite", "wood", "plate")
    exec(stream, known)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 12 and lines[0].endswith("(480,)")
    try:
        import torch
    except ImportError:
        print("torch is not installed here: its snippet was not run")
        return
    exec(batches, known)
    haptics, surfaces = next(iter(known["loader"]))
    assert haptics[0].shape == (480,) and haptics[0].dtype == torch.float32 and surfaces[0] in ("granite", "wood", "plate")
