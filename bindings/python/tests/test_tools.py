"""Tools that make surfaces and bodies: the numbers of the program; and the sound card's half."""

import json
import subprocess
import sys
import types

import numpy as np
import pytest

import asperity as asp


def run(program, *words):
    return subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True).stdout


def write_pgm(path, greys):
    rows, columns = greys.shape
    path.write_bytes(b"P5\n%d %d\n255\n" % (columns, rows) + greys.astype(np.uint8).tobytes())


def tiles(rows=96, columns=112):
    y, x = np.mgrid[:rows, :columns]
    noise = np.random.default_rng(4).normal(0, 3, (rows, columns))
    return np.clip(np.where((x % 16 < 3) | (y % 16 < 3), 50, 180) + noise, 0, 255).astype(np.uint8)


def test_a_photographs_heights_are_those_that_the_program_finds(program, tmp_path):
    write_pgm(tmp_path / "photo.pgm", tiles())
    told_by_program = json.loads(
        run(program, "texture", "from-photo", tmp_path / "photo.pgm", "-o", tmp_path / "out", "--width-m", "0.05", "--json")
    )
    for photo in (tmp_path / "photo.pgm", tiles()):
        heights_m, told = asp.texture.from_photo(photo, width_m=0.05)
        for key in ("texel_m", "relief_m", "micro_relief_m", "method", "sign", "sign_confidence", "roughness", "wallpaper_group", "tileable"):
            assert told[key] == told_by_program[key], key
        assert told["lattice_px"] == [told_by_program["lattice"][key] for key in ("t1_px", "t2_px")]
        theirs = asp.texture.read(tmp_path / "out" / "displacement.png")
        # Their file has 16 bits.
        assert np.abs(heights_m - told["relief_m"] * theirs).max() <= told["relief_m"] / 65_535
        assert heights_m.shape == told["roughness_map"].shape == (96, 112)
    take = asp.stroke(asp.Surface(heights_m, 0.05, micro_relief_m=told["micro_relief_m"]), duration=0.2)
    assert np.abs(take.haptic).max() > 1e-3


def test_a_photograph_lies_as_its_options_say():
    photo = tiles()
    plain, _ = asp.texture.from_photo(photo, method="dark-is-deep", relief_m=1e-3)
    turned, told = asp.texture.from_photo(photo, method="dark-is-deep", relief_m=1e-3, bright_is_deep=True)
    assert told["method"] == "dark-is-deep" and abs(np.ptp(plain) - 1e-3) < 1e-9
    assert np.corrcoef(plain.ravel(), turned.ravel())[0, 1] < -0.9
    higher, _ = asp.texture.from_photo(photo, method="dark-is-deep", relief_m=1e-3, exaggerate=3.0)
    np.testing.assert_allclose(higher, 3.0 * plain, atol=1e-12)
    seen = []
    asp.texture.from_photo(np.tile(photo, (4, 4)), light=(-0.5, -0.5, 0.7), progress=seen.append)
    assert seen == sorted(seen) and seen[-1] <= 1


def vibration(seconds=4.0, rate=4000.0, line_hz=150.0):
    rng = np.random.default_rng(9)
    time_s = np.arange(int(seconds * rate)) / rate
    low = np.convolve(rng.normal(0, 0.3, time_s.size), 0.8 ** np.arange(40), "same")
    return 0.3 * low + 0.2 * np.sin(2 * np.pi * line_hz * time_s), rate


def test_a_strokes_surface_is_the_one_that_the_program_finds(program, tmp_path):
    samples, rate = vibration()
    np.savetxt(tmp_path / "stroke.csv", samples, header="a", comments="")
    words = ("--rate", rate, "--probe", "stylus", "--speed", 0.12, "--force", 1.5, "-o", tmp_path / "out", "--json")
    theirs = json.loads(run(program, "texture", "from-stroke", tmp_path / "stroke.csv", *words))
    surface, told = asp.texture.from_stroke(samples, rate, speed=0.12, force=1.5)
    del theirs["files"]
    assert told == theirs and len(told["lines"]) == 1
    take = asp.stroke(surface, speed=0.2, force=1.0, duration=0.3, probe="stylus")
    assert np.abs(take.haptic).max() > 1e-3
    # Two strokes of two axes, speeds as numbers and as an array.
    two = [np.stack([samples, 0.3 * samples]), np.stack([samples[::-1], samples])]
    _, told = asp.texture.from_stroke(two, rate, speed=[0.06, np.full(samples.size, 0.12)], force=1.5)
    assert [round(group["speed_m_s"], 3) for group in told["recorded"]] == [0.06, 0.12]


def test_surfaces_are_told_apart_as_the_program_tells_them_apart(program, tmp_path):
    x = np.arange(64)
    maps = [np.round(127 + 60 * np.sin(2 * np.pi * x / period)[None, :] * np.ones((64, 1))).astype(np.uint8) for period in (16, 8)]
    paths = [tmp_path / f"map{place}.pgm" for place in range(2)]
    for path, greys in zip(paths, maps, strict=True):
        write_pgm(path, greys)
    theirs = json.loads(run(program, "texture", "compare", *paths, "--strokes", "40", "--metamers", "--json"))
    seen = []
    ours = asp.texture.compare(maps, strokes=40, metamers=True, progress=seen.append)
    for name in ("originals", "metamers"):
        np.testing.assert_array_equal(ours[name]["rows"], theirs[name]["rows"], err_msg=name)
        assert ours[name]["mean"] == theirs[name]["mean"] and ours[name]["reference"] == theirs[name]["reference"]
    assert ours["originals"]["mean"] > 0.7 and seen == sorted(seen)
    assert asp.texture.compare(paths, strokes=40)["metamers"] is None


CUBE = (
    [[x, y, z] for x in (0.0, 0.08) for y in (0.0, 0.05) for z in (0.0, 0.02)],
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ],
)  # fmt: skip


def test_a_mesh_rings_with_the_modes_that_the_program_solves_for(program, tmp_path):
    points, triangles = CUBE
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    (tmp_path / "block.obj").write_text("\n".join(lines) + "\n")
    run(program, "modes", tmp_path / "block.obj", "-o", tmp_path / "theirs.modes.json", "--material", "steel", "--max-modes", "6")
    theirs = json.loads((tmp_path / "theirs.modes.json").read_text())
    from_file = asp.modes(tmp_path / "block.obj", "steel", max_modes=6)
    assert json.loads(from_file.json()) == theirs
    from_arrays = asp.modes((np.array(points), np.array(triangles)), "steel", max_modes=6)
    np.testing.assert_array_equal(from_arrays.modes, from_file.modes)
    # 80 × 50 × 20 mm of steel.
    assert 0.5 < from_arrays.mass_kg < 0.7 and abs(from_arrays.volume_m3 - 8e-5) < 1e-7
    event = {"t": 0.0, "event": "impact", "body": "block", "speed_m_s": 0.5, "mass_kg": 0.01, "radius_m": 0.005, "striker": "steel"}
    scene = asp.SceneFile(asp.Solid("granite"), bodies=[from_arrays.body("block")])
    audio = asp.render(scene, [{**event, "at_m": [0.08, 0.025, 0.02]}]).audio
    strongest = np.argmax(np.abs(np.fft.rfft(audio[:8192]))) * 44_100 / 8192
    assert np.abs(from_arrays.modes["frequency_hz"] - strongest).min() < 20
    from_arrays.save(tmp_path / "ours.modes.json")
    assert (tmp_path / "ours.modes.json").read_text() == from_arrays.json()


def test_what_is_refused_of_photographs_maps_and_meshes_is_one_sentence(tmp_path):
    points, triangles = CUBE
    for act, piece in [
        (lambda: asp.texture.from_photo(np.zeros((8, 8))), "at least 16 texels"),
        (lambda: asp.texture.from_photo(tiles(), method="guess"), "must be one of integrable, tsai-shah"),
        (lambda: asp.texture.from_photo(tiles(), relief_m=-1.0), "relief_m"),
        (lambda: asp.texture.from_stroke(np.zeros(4000), 1000, speed=0.1, force=1.0), "every sample is the same"),
        (lambda: asp.texture.from_stroke(np.zeros(4000), 1000, speed=0.1, force=1.0, probe="broom"), "broom"),
        (lambda: asp.texture.from_stroke(np.zeros(40), 1000, speed=[0.1, 0.2], force=1.0), "2 entries for 1 strokes"),
        (lambda: asp.texture.from_stroke(np.zeros(40), 1000, speed=np.ones(3), force=1.0), "one a sample"),
        (lambda: asp.texture.compare([tiles()]), "give 2 to 8"),
        (lambda: asp.texture.compare([tiles(), tiles()], strokes=3), "strokes: 3 is refused; must be 20 to 10000"),
        (lambda: asp.texture.compare([tiles(), tiles()], width_m=0.0), "width_m: 0 is refused"),
        (lambda: asp.modes(CUBE), "young_pa: is missing"),
        (lambda: asp.modes(CUBE, "cheese"), '"cheese" is unknown'),
        (lambda: asp.modes(CUBE, {"stiffness": 3}), "stiffness: unknown"),
        (lambda: asp.modes((points, [[0, 1, 9]]), "steel"), "triangles name points"),
        (lambda: asp.modes((points, [[0, 1]]), "steel"), "(n, 3)"),
        (lambda: asp.modes(CUBE, "steel", max_modes=0), "max_modes: 0 is refused"),
        (lambda: asp.modes(CUBE, "steel", thickness_m=1.0), "thickness_m"),
    ]:
        with pytest.raises(ValueError) as refused:
            act()
        text = str(refused.value)
        assert piece in text and "\n" not in text, text
    for act in (
        lambda: asp.texture.from_photo(tmp_path / "gone.png"),
        lambda: asp.modes(tmp_path / "gone.obj", "steel"),
        lambda: asp.modes(CUBE, "steel", damping_from=tmp_path / "gone.modes.json"),
    ):
        with pytest.raises(FileNotFoundError, match="gone"):
            act()


class Card:
    """What sounddevice does with a stream, without a device."""

    def __init__(self, sr, *, blocksize, device, channels, dtype, callback):
        self.told = (sr, blocksize, device, channels, dtype)
        self.callback, self.width, self.blocksize, self.started = callback, channels, blocksize, False

    def start(self):
        self.started = True

    def next_block(self):
        out = np.full((self.blocksize, self.width), 9.0, np.float32)
        self.callback(out, self.blocksize, None, None)
        return out


def test_a_renderer_plays_on_as_many_channels_as_the_device_has(monkeypatch):
    card = types.ModuleType("sounddevice")
    card.OutputStream = Card
    monkeypatch.setitem(sys.modules, "sounddevice", card)
    plate = asp.Solid("granite").on(asp.Body.stock("plate", 0.14, "steel"))
    for most, expected in ((1, 1), (2, 2), (8, 3)):
        card.query_devices = lambda device, kind, most=most: {"max_output_channels": most}
        scene = asp.Scene(plate, sr=48_000, clock="exact")
        scene.report_all(asp.contacts.stroke(duration=0.5, extent=(0.1, 0.1)))
        stream = asp.play(scene.renderer, device=4)
        assert stream.started and stream.told == (48_000, 64, 4, expected, "float32")
        blocks = np.concatenate([stream.next_block() for _ in range(100)])
        assert np.abs(blocks).max(axis=0).min() > 1e-6 and np.abs(blocks).max() < 2
    with pytest.raises(ValueError, match="needs 10 channels; the device has 8"):
        asp.play(scene.renderer, channels="audio=0 haptic=9")
    with pytest.raises(ValueError, match="blocksize: 0 is refused"):
        asp.play(scene.renderer, blocksize=0)
