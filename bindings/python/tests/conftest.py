"""What the tests share: the program, to compare with, and scenes."""

import os
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

# The tests may have been copied out of the tree, so that they see the installed package only.
SOURCE = os.environ.get("ASPERITY_PYTHON_SOURCE")
ROOT = pathlib.Path(SOURCE).parents[1] if SOURCE else pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def program() -> str:
    """The program: ASPERITY_PROGRAM, or built from the workspace."""
    named = os.environ.get("ASPERITY_PROGRAM")
    if named:
        return named
    if shutil.which("cargo") is None:
        pytest.fail("name the program in ASPERITY_PROGRAM, or install cargo")
    subprocess.run(["cargo", "build", "--release", "-p", "asperity-cli"], cwd=ROOT, check=True)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return str(target / "release" / "asperity")


@pytest.fixture(scope="session")
def demo(program, tmp_path_factory) -> pathlib.Path:
    """The folder of the program's demo: scenes, logs, maps, a modes file and the WAVs it rendered."""
    folder = tmp_path_factory.mktemp("demo")
    subprocess.run([program, "demo", "-o", str(folder)], check=True, capture_output=True)
    return folder


@pytest.fixture
def heights_m():
    """Random ground of 0.1 mm, smooth over three texels."""
    white = np.random.default_rng(7).standard_normal((96, 128))
    smooth = sum(np.roll(white, (i, j), (0, 1)) for i in range(-1, 2) for j in range(-1, 2)) / 9
    return 1e-4 * smooth
