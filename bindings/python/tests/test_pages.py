"""What the pages and the README say is run: their blocks of Python, with cards and windows of cardboard in the place of devices."""

import os
import pathlib
import re
import sys
import types

import numpy as np
import pytest

import asperity as asp

SOURCE = pathlib.Path(os.environ.get("ASPERITY_PYTHON_SOURCE", pathlib.Path(__file__).resolve().parents[1]))


def blocks(page, language="python"):
    found = re.findall(rf"```{language}\n(.*?)```", (SOURCE / page).read_text(), re.DOTALL)
    assert found, f"{page} has no block of {language}"
    return found


def test_the_first_program_of_the_readme_writes_two_files(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    program = blocks("README.md")[0]
    # Five lines make touch from an array.
    assert len([line for line in program.splitlines() if line.strip()]) <= 6
    exec(program, {})
    assert sorted(path.name for path in tmp_path.iterdir()) == ["stroke.audio.wav", "stroke.haptic.wav"]
    assert "Take(audio=" in capsys.readouterr().out


def test_twelve_lines_of_the_readme_give_a_robot_ears(capsys):
    pytest.importorskip("mujoco")
    (program,) = [block for block in blocks("README.md") if "mujoco" in block]
    assert len([line for line in program.splitlines() if line.strip()]) <= 12
    exec(program, {})
    assert 1.0 < float(capsys.readouterr().out.split()[0]) < 1e5


def test_the_page_for_psychopy_plays_a_stereo_array_a_condition(monkeypatch):
    played = []

    class Sound:
        def __init__(self, value, sampleRate):
            assert value.ndim == 2 and value.shape[1] == 2 and value.dtype == np.float32 and isinstance(sampleRate, int)
            self.value = value

        def play(self, when):
            played.append(self.value)

    class Window:
        def getFutureFlipTime(self, clock):
            return 0.0

        def flip(self):
            pass

    parts = {"core": {"wait": lambda seconds: None}, "sound": {"Sound": Sound}, "visual": {"Window": Window}}
    psychopy = types.ModuleType("psychopy")
    for name, content in parts.items():
        setattr(psychopy, name, types.SimpleNamespace(**content))
    monkeypatch.setitem(sys.modules, "psychopy", psychopy)
    exec(blocks("pages/psychopy.md")[0], {})
    strength = [float(np.sqrt(np.mean(value.astype(float) ** 2))) for value in played]
    print(strength)
    assert len(played) == 4 and strength[0] > 1e-4 and strength[3] > 1.5 * strength[0], strength


@pytest.mark.filterwarnings("ignore::asperity.TouchWarning")
def test_the_calls_of_the_page_for_matlab_take_what_matlab_sends():
    text = blocks("pages/matlab.md", "matlab")[0]
    for call in ("py.asperity.Surface", "py.asperity.Body.stock", "py.asperity.stroke", "take.audio", "take.haptic", "take.sr"):
        assert call in text
    # MATLAB's doubles: matrices in columns, numbers as float.
    heights_m = np.asfortranarray(1e-4 * np.random.default_rng(1).random((256, 256)))
    plate = asp.Surface(np.array(heights_m), extent=0.14).on(asp.Body.stock("plate", 0.14, "ceramic"))
    take = asp.stroke(plate, speed=0.08, force=0.6, duration=1.0, sr=48000.0)
    assert np.asarray(take.audio, dtype=float).ndim == 1 and np.asarray(take.haptic, dtype=float).shape[0] == 1
    assert take.sr == 48000
    event = {"t": 0.0, "event": "impact", "body": "body", "speed_m_s": 0.5, "mass_kg": 0.01, "radius_m": 0.005, "striker": "steel"}
    assert np.abs(asp.render(plate, [event]).audio).max() > 1e-6
