#!/usr/bin/env python3
"""Archives of a release, the same bytes on every system.

    pack.py FOLDER ARCHIVE.tar.gz    FOLDER with everything in it
    pack.py --sums DIST              DIST/SHA256SUMS, and each file's size
"""
import gzip
import hashlib
import sys
import tarfile
from pathlib import Path


def plain(entry):
    """Without the time and the people of this build."""
    entry.mtime = entry.uid = entry.gid = 0
    entry.uname = entry.gname = ""
    return entry


def pack(folder, archive):
    with open(archive, "wb") as raw, gzip.GzipFile(fileobj=raw, mode="wb", filename="", mtime=0) as zipped:
        with tarfile.open(fileobj=zipped, mode="w", format=tarfile.PAX_FORMAT) as out:
            for path in [folder, *sorted(folder.rglob("*"))]:
                out.add(path, path.relative_to(folder.parent).as_posix(), recursive=False, filter=plain)


def sums(dist):
    files = sorted(path for path in dist.glob("*/*") if path.is_file())
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(dist).as_posix()}" for path in files]
    (dist / "SHA256SUMS").write_text("\n".join(lines) + "\n")
    for path in files:
        print(f"{path.stat().st_size / 1e6:8.2f} MB  {path.relative_to(dist).as_posix()}")


if sys.argv[1] == "--sums":
    sums(Path(sys.argv[2]))
else:
    pack(Path(sys.argv[1]), Path(sys.argv[2]))
