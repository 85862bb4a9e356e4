"""The same bits as the program's files."""

import csv
import json
import subprocess

import numpy as np
import pytest
import wav

import asperity as asp

# The program warns of the same.
pytestmark = pytest.mark.filterwarnings("ignore::asperity.TouchWarning")


def run(program, *words):
    return subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True).stdout


def test_every_scene_of_the_demo_has_the_bits_of_the_program(program, demo, tmp_path):
    scenes = sorted(demo.rglob("*.toml"))
    scenes = [scene for scene in scenes if "contacts" in scene.read_text()]
    assert len(scenes) >= 3
    for scene in scenes:
        run(program, "render", scene, "-o", tmp_path / "theirs")
        take = asp.render(scene)
        audio, rate = wav.read(tmp_path / "theirs.audio.wav")
        haptic, _ = wav.read(tmp_path / "theirs.haptic.wav")
        assert take.sr == rate and np.abs(audio).max() > 1e-3, scene
        assert np.atleast_2d(take.audio).tobytes() == audio.tobytes(), scene
        assert take.haptic.tobytes() == haptic.tobytes(), scene


@pytest.mark.parametrize("options", [{"sr": 22_050}, {"seed": 9}, {"kernel": "portable"}, {"block": 17}])
def test_every_option_means_what_the_program_means(program, demo, tmp_path, options):
    scene = next(scene for scene in sorted(demo.rglob("*.toml")) if "contacts" in scene.read_text())
    flag = {"sr": "--rate", "seed": "--seed", "kernel": "--kernel", "block": "--block"}
    words = [word for key, value in options.items() for word in (flag[key], value)]
    run(program, "render", scene, "-o", tmp_path / "theirs", *words)
    take = asp.render(scene, **options)
    assert np.atleast_2d(take.audio).tobytes() == wav.read(tmp_path / "theirs.audio.wav")[0].tobytes()
    assert take.haptic.tobytes() == wav.read(tmp_path / "theirs.haptic.wav")[0].tobytes()


def test_saved_files_are_byte_for_byte_the_programs(program, demo, tmp_path):
    scene = next(scene for scene in sorted(demo.rglob("*.toml")) if "contacts" in scene.read_text())
    run(program, "render", scene, "-o", tmp_path / "theirs")
    assert asp.render(scene).save(tmp_path / "ours") == [str(tmp_path / f"ours.{part}.wav") for part in ("audio", "haptic")]
    for part in ("audio", "haptic"):
        assert (tmp_path / f"ours.{part}.wav").read_bytes() == (tmp_path / f"theirs.{part}.wav").read_bytes()
    assert not list(tmp_path.glob("*.part"))


def test_trace_and_force_are_the_tables_of_the_program(program, demo, tmp_path):
    scene = next(scene for scene in sorted(demo.rglob("*.toml")) if "begin" in _log(scene))
    run(program, "render", scene, "-o", tmp_path / "theirs", "--trace", "--force")
    take = asp.render(scene, trace=True, force=True)
    for name, rows in (("trace", take.trace), ("force", take.force)):
        with open(tmp_path / f"theirs.{name}.csv", newline="") as file:
            header, *theirs = csv.reader(file)
        assert tuple(header) == rows.dtype.names and len(theirs) == len(rows) > 100
        for row, their in zip(rows[::97], theirs[::97], strict=True):
            assert [float(x) for x in row] == [float(x) for x in their]


def _log(scene):
    line = next((line for line in scene.read_text().splitlines() if line.startswith("contacts")), None)
    return (scene.parent / line.split('"')[1]).read_text() if line else ""


def test_an_array_renders_as_its_picture_does(program, heights_m, tmp_path):
    greys = np.round(65_535 * (heights_m - heights_m.min()) / np.ptp(heights_m)).astype(np.uint16)
    _write_pgm(tmp_path / "plate.pgm", greys)
    rows = asp.contacts.stroke(speed=0.1, force=0.5, duration=0.4, extent=(0.08, 0.06))
    asp.contacts.save(tmp_path / "log.jsonl", rows)
    text = (
        'contacts = "log.jsonl"\n[[body]]\nname = "body"\nstock = "plate"\nsize_m = 0.1\nmaterial = "steel"\n'
        '[[surface]]\nname = "surface"\nbody = "body"\ndisplacement = "plate.pgm"\nrelief_m = 0.0005\n'
        "width_m = 0.08\nheight_m = 0.06\nroughness = 0.3\n"
    )
    (tmp_path / "scene.toml").write_text(text)
    run(program, "render", tmp_path / "scene.toml", "-o", tmp_path / "theirs")
    surface = asp.Surface(greys, (0.08, 0.06), relief_m=5e-4, roughness=0.3)
    take = asp.render(surface.on(asp.Body.stock("plate", 0.1, "steel")), rows)
    assert take.audio.tobytes() == wav.read(tmp_path / "theirs.audio.wav")[0].tobytes()
    assert take.haptic.tobytes() == wav.read(tmp_path / "theirs.haptic.wav")[0].tobytes()


def _write_pgm(path, greys):
    rows, columns = greys.shape
    path.write_bytes(b"P5\n%d %d\n65535\n" % (columns, rows) + greys.astype(">u2").tobytes())


def test_a_fit_finds_the_modes_that_the_program_finds(program, demo, tmp_path):
    recording = next(iter(sorted(demo.rglob("*.wav"), key=lambda path: ("hit" not in path.name and "strike" not in path.name, path.name))))
    run(program, "fit", recording, "-o", tmp_path / "theirs.modes.json")
    theirs = json.loads((tmp_path / "theirs.modes.json").read_text())
    ours = asp.fit(recording)
    assert len(ours.modes) == len(theirs["modes"]) > 0
    for mode, their in zip(ours.modes, theirs["modes"], strict=True):
        assert [mode[key] for key in ("frequency_hz", "decay_per_s", "amplitude", "phase_rad")] == [
            their[key] for key in ("frequency_hz", "decay_per_s", "amplitude", "phase_rad")
        ]
    assert json.loads(ours.json())["modes"] == theirs["modes"]


def test_an_analysis_has_the_numbers_of_the_program(program, tmp_path):
    y, x = np.mgrid[:160, :160]
    tiles = np.round(200 * np.exp(-(((x % 16) - 5.0) ** 2 + ((y % 20) - 8.0) ** 2) / 14)).astype(np.uint8)
    (tmp_path / "tiles.pgm").write_bytes(b"P5\n160 160\n255\n" + tiles.tobytes())
    theirs = json.loads(run(program, "texture", "analyze", tmp_path / "tiles.pgm", "--json"))
    for ours in (asp.texture.analyze(tmp_path / "tiles.pgm"), asp.texture.analyze(tiles)):
        for key in ("fractal_dimension", "hurst", "roughness", "lattice", "wallpaper_group", "warnings"):
            assert ours[key] == theirs[key], key
    assert ours["wallpaper_group"] is not None


def test_a_clip_is_the_one_that_the_program_writes(program, demo, tmp_path):
    # A stroke that is felt.
    scene = next(scene for scene in sorted(demo.rglob("*.toml")) if scene.stem == "sawtooth")
    paths = asp.render(scene).save(tmp_path / "take")
    run(program, "haptic", paths[1], "-o", tmp_path / "theirs.haptic")
    samples, rate = wav.read(tmp_path / "take.haptic.wav")
    clip = asp.haptics.reduce(samples[0], rate, source="take.haptic.wav")
    assert clip.save(tmp_path / "ours.haptic") == [str(tmp_path / "ours.haptic")]
    ours, theirs = (json.loads((tmp_path / f"{name}.haptic").read_text()) for name in ("ours", "theirs"))
    assert ours["signals"] == theirs["signals"]
    assert np.sqrt(np.mean(clip.left**2)) > 1e-3
