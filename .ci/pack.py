#!/usr/bin/env python3
"""Archives of a release, the same bytes on every system.

    pack.py FOLDER ARCHIVE.tar.gz    FOLDER with everything in it
    pack.py --metas PACKAGE          Unity's notes beside each file of a package: it ignores what has none in an archive
    pack.py --sums DIST              DIST/SHA256SUMS, and each file's size, which a kind of archive may not exceed
"""
import gzip
import hashlib
import sys
import tarfile
from pathlib import Path

MOST_MB = {"program": 20.0, "python": 8.0, "web": 1.5, "c": 12.0}

# Systems on which Unity loads a library, by its ending.
SYSTEMS = {".so": ("Linux", "Linux64", "x86_64"), ".dylib": ("OSX", "OSXUniversal", "AnyCPU"), ".dll": ("Windows", "Win64", "x86_64")}
LIBRARY = """PluginImporter:
  serializedVersion: 2
  platformData:
  - first:
      Any:
    second:
      enabled: 0
      settings: {{}}
  - first:
      Editor: Editor
    second:
      enabled: 1
      settings:
        CPU: {2}
        OS: {0}
  - first:
      Standalone: {1}
    second:
      enabled: 1
      settings:
        CPU: {2}
"""


def plain(entry):
    """Without the time, the people and the rights of this build."""
    entry.mtime = entry.uid = entry.gid = 0
    entry.uname = entry.gname = ""
    entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
    return entry


def pack(folder, archive):
    with open(archive, "wb") as raw, gzip.GzipFile(fileobj=raw, mode="wb", filename="", mtime=0) as zipped:
        with tarfile.open(fileobj=zipped, mode="w", format=tarfile.PAX_FORMAT) as out:
            for path in [folder, *sorted(folder.rglob("*"))]:
                out.add(path, path.relative_to(folder.parent).as_posix(), recursive=False, filter=plain)


def metas(package):
    """Each file's name for Unity follows from its path, so that a newer package keeps what scenes refer to."""
    for path in sorted(package.rglob("*")):
        inside = path.relative_to(package)
        if any(part.endswith("~") for part in inside.parts):
            continue
        name = hashlib.md5(f"org.asperity.touch/{inside.as_posix()}".encode()).hexdigest()
        folder = "folderAsset: yes\n" if path.is_dir() else ""
        library = LIBRARY.format(*SYSTEMS[path.suffix]) if path.suffix in SYSTEMS else ""
        Path(f"{path}.meta").write_text(f"fileFormatVersion: 2\nguid: {name}\n{folder}{library}")


def sums(dist):
    files = sorted(path for path in dist.glob("*/*") if path.is_file())
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(dist).as_posix()}" for path in files]
    (dist / "SHA256SUMS").write_text("\n".join(lines) + "\n")
    for path in files:
        size, most = path.stat().st_size / 1e6, MOST_MB.get(path.parent.name)
        print(f"{size:8.2f} MB  {path.relative_to(dist).as_posix()}")
        if most and size > most:
            sys.exit(f"error: {path.name}: {size:.2f} MB; must be at most {most} MB")


if sys.argv[1] == "--sums":
    sums(Path(sys.argv[2]))
elif sys.argv[1] == "--metas":
    metas(Path(sys.argv[2]))
else:
    pack(Path(sys.argv[1]), Path(sys.argv[2]))
