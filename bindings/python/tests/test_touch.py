"""Surfaces, contacts, and what is refused."""

import json
import warnings

import numpy as np
import pytest

import asperity as asp


def rms(x):
    return float(np.sqrt(np.mean(np.square(x, dtype=np.float64))))


def test_rougher_ground_is_felt_stronger_with_levels_that_are_written(heights_m):
    actuators = [{"full_scale": 1e-4}]
    felt = [
        rms(asp.stroke(asp.Surface(k * heights_m, 0.14, micro_relief_m=0.0), duration=0.4, actuators=actuators).haptic)
        for k in (0.1, 0.2)
    ]
    assert 1.8 < felt[1] / felt[0] < 2.2


def test_a_grating_is_felt_at_speed_over_wavelength():
    # 2 mm at 0.1 m/s: 50 Hz.
    columns = np.arange(1024) * (0.128 / 1024)
    heights_m = np.tile(2e-5 * np.sin(2 * np.pi * columns / 0.002), (8, 1))
    surface = asp.Surface(heights_m, (0.128, 0.02), micro_relief_m=0.0)
    take = asp.stroke(surface, speed=0.1, force=0.5, duration=1.0, tail_s=0.0, sr=8000)
    spectrum = np.abs(np.fft.rfft(take.haptic[0, 2000:8000] * np.hanning(6000)))
    assert abs(np.argmax(spectrum) * 8000 / 6000 - 50.0) < 1.5


def test_every_source_sounds_and_is_felt(heights_m):
    body = asp.Body.stock("plate", 0.14, "steel")
    y, x = np.mgrid[:32, :32]
    cell = 1e-4 * np.exp(-((x - 16) ** 2 + (y - 16) ** 2) / 20)
    for surface in (
        asp.Surface(heights_m, 0.14),
        asp.Solid("granite"),
        asp.Brownian(0.5, 1e-4),
        asp.Lattice(cell, (0.004, 0.0), (0.0, 0.004)),
    ):
        take = asp.stroke(surface.on(body), duration=0.5)
        assert rms(take.audio) > 1e-4 and rms(take.haptic) > 1e-4, surface
        assert take.audio.dtype == take.haptic.dtype == np.float32
    sand = asp.Sand(parameters={"cells": 128, "depth_m": 0.02})
    take = asp.stroke(sand, duration=0.5, force=1.0)
    assert rms(take.haptic) > 1e-5
    bed = take.sand["surface"]
    assert bed.shape == (128, 128) and 1e-4 < np.ptp(bed) < 0.05 and abs(bed.mean() - 0.02) < 2e-3


def test_rows_of_an_array_run_from_top_to_bottom():
    # Flat above, rough below: v = 0.25 is felt less than v = 0.75.
    heights_m = np.zeros((128, 128))
    heights_m[64:] = 1e-4 * np.random.default_rng(3).random((64, 128))
    surface = asp.Surface(heights_m, 0.14, micro_relief_m=0.0)
    high, low = (rms(asp.stroke(surface, start=(0.1, v), duration=0.4, actuators=[{"full_scale": 1e-4}]).haptic) for v in (0.25, 0.75))
    assert low > 20 * high


def test_one_number_is_a_width_and_texels_stay_square():
    assert asp.Surface(np.zeros((50, 100)), 0.2).extent == (0.2, 0.1)


def test_several_buses_and_actuators_have_an_axis(heights_m):
    bodies = [asp.Body.stock("plate", 0.1, "steel", name=name) for name in ("left", "right")]
    bodies = [asp.Body(None, b.material, b.name, {**b.keys, "bus": b.name}) for b in bodies]
    scene = asp.SceneFile(
        [asp.Surface(heights_m, 0.1, name="a").on(bodies[0]), asp.Surface(heights_m, 0.1, name="b").on(bodies[1])],
        actuators=[{"output": "displacement"}, {"output": "acceleration"}],
        audio=[{"name": "left"}, {"name": "right"}],
        probe="stylus",
    )
    rows = asp.contacts.stroke(duration=0.3, extent=(0.1, 0.075), surface="a", actuator=1)
    take = asp.render(scene, rows)
    assert take.audio.shape[0] == 2 and take.haptic.shape[0] == 2
    assert rms(take.audio[0]) > 1e-4 and rms(take.audio[1]) == 0.0
    assert rms(take.haptic[1]) > 1e-4 and rms(take.haptic[0]) == 0.0
    assert take.frames("both").shape == (take.haptic.shape[1], 4)
    assert take.frames().flags.c_contiguous


def test_contacts_come_back_from_a_log_as_they_were(tmp_path):
    rows = asp.contacts.empty(4)
    rows["t"] = [0.0, 1 / 3, 0.5, 0.7]
    rows["event"] = ["begin", "move", "impact", "end"]
    rows["contact"] = 2**63
    rows["uv"][:2], rows["normal_force_n"][:2] = [[0.1, 0.2], [0.3, 0.1 + 0.2]], [0.5, 1 / 7]
    rows["surface"][0], rows["actuator"][0], rows["body"][2] = "plate", 0, "tile"
    rows["slip_m_s"][:2], rows["roll_radius_m"][:2] = [0.0, 0.05], [np.nan, 0.008]
    for key, value in {"speed_m_s": 0.5, "mass_kg": 0.01, "radius_m": 0.005, "restitution": 0.7}.items():
        rows[key][2] = value
    rows["striker"][2] = "steel"
    rows["contact"][2] = 0
    asp.contacts.save(tmp_path / "log.jsonl", rows)
    back = asp.contacts.load(tmp_path / "log.jsonl")
    assert back.dtype == rows.dtype
    for name in rows.dtype.names:
        np.testing.assert_array_equal(back[name], rows[name], err_msg=name)


def test_what_rolls_is_softer_than_what_slides_and_strikes_have_a_level_of_their_own(heights_m):
    surface = asp.Surface(heights_m, 0.14, name="top").on(asp.Body.stock("plate", 0.14, "glass"))
    rows = asp.contacts.stroke(speed=0.2, duration=0.5, extent=surface.extent, surface="top")
    scene = asp.SceneFile(surface, actuators=[{"full_scale": 1e-3}])
    slides = asp.render(scene, rows)
    rows["slip_m_s"], rows["roll_radius_m"] = 0.0, 0.008
    rolls = asp.render(scene, rows)
    assert 1e-6 < rms(rolls.audio) < 0.7 * rms(slides.audio)
    # The level policy turns strikes down beside strokes, and the result says by how much.
    (strike_gain,) = slides.stats["strike_gain"]
    assert 0.0 < strike_gain < 1.0
    loud = asp.Body(None, "glass", keys={"stock": "plate", "size_m": 0.14, "strike_gain": 1.0})
    assert asp.stroke(surface.on(loud), duration=0.1).stats["strike_gain"] == [1.0]
    assert asp.Scene(scene).strike_gain == [strike_gain]


def test_dictionaries_and_arrays_and_files_render_alike(heights_m, tmp_path):
    surface = asp.Surface(heights_m, 0.14)
    rows = asp.contacts.stroke(duration=0.2, extent=surface.extent)
    asp.contacts.save(tmp_path / "log.jsonl", rows)
    takes = [asp.render(surface, contacts) for contacts in (rows, asp.contacts.to_events(rows), tmp_path / "log.jsonl")]
    assert len({take.haptic.tobytes() for take in takes}) == 1


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_greys_are_never_taken_for_metres(dtype):
    greys = np.arange(64, dtype=dtype).reshape(8, 8)
    with pytest.raises(ValueError, match="relief_m: is missing"):
        asp.Surface(greys, 0.1)
    with pytest.raises(ValueError, match="relief_m: stands beside heights in metres"):
        asp.Surface(greys.astype(float), 0.1, relief_m=1e-3)
    with pytest.raises(ValueError, match="must be float"):
        asp.Surface(greys.astype(np.int64), 0.1, relief_m=1e-3)


def refusals(heights_m, tmp_path):
    """What is wrong, and a piece of the sentence that says so."""
    surface = asp.Surface(heights_m, 0.14)
    nan = heights_m.copy()
    nan[3, 5] = np.nan
    (tmp_path / "bad.toml").write_text("[[surface]]\nname = 3\n")
    (tmp_path / "log.jsonl").write_text('{"t":0,"event":"begin","contakt":1}\n')
    rows = asp.contacts.stroke(duration=0.1, extent=(0.1, 0.1))
    return [
        (lambda: asp.Surface(nan, 0.14), "heights: row 3, column 5 is nan"),
        (lambda: asp.Surface(heights_m[0], 0.14), "must be (rows, columns)"),
        (lambda: asp.stroke(asp.Surface(heights_m, 0.14, gloss=3)), "gloss"),
        (lambda: asp.stroke(asp.Surface(heights_m, -0.14)), "width_m"),
        (lambda: asp.stroke(asp.Surface(1e3 + 1e3 * heights_m, 0.14)), "scene.toml"),
        (lambda: asp.stroke(asp.Surface(heights_m, float("nan"))), "surface.width_m: is not finite"),
        (lambda: asp.stroke(asp.Solid("cheese")), '"cheese" is unknown; must be one of'),
        (lambda: asp.stroke(surface, kernel="abacus"), "must be one of: portable"),
        (lambda: asp.stroke(surface, sr=10), "sample_rate_hz"),
        (lambda: asp.stroke(surface, duration=-1), "duration: -1 is refused"),
        (lambda: asp.stroke(surface, probe="nose"), '"nose" is unknown'),
        (lambda: asp.render(surface), "contacts: is missing"),
        (lambda: asp.render(tmp_path / "bad.toml"), "name"),
        (lambda: asp.render(surface, tmp_path / "log.jsonl"), "log.jsonl:1: contakt: unknown key"),
        (lambda: asp.render(surface, [{"t": 0.0, "event": "move", "contact": 1, "uv": [np.inf, 0]}]), "event 1: uv: is not finite"),
        (lambda: asp.render(surface, asp.contacts.stroke(extent=(1, 1), actuator=4)), "contacts:1: actuator: 4 is not in the scene"),
        (lambda: asp.render(surface, asp.contacts.stroke(extent=(1, 1), surface="floor")), '"floor" is unknown; must be one of: surface'),
        (lambda: asp.render(surface, rows, block=0), "block: 0 is refused"),
        (lambda: asp.render(surface, rows, force=1e9), "force_rate"),
        (lambda: asp.fit([0.0] * 1000, 44_100), "array"),
        (lambda: asp.fit(np.ones(3), 44_100), "array"),
        (lambda: asp.fit(np.ones(1000)), "sr: is missing"),
        (lambda: asp.haptics.reduce([np.nan] * 100, 8000), "finite"),
        (lambda: asp.texture.analyze(np.zeros((8, 8))), "64"),
    ]


def test_what_is_refused_is_told_in_one_sentence_with_what_would_be_right(heights_m, tmp_path):
    for act, piece in refusals(heights_m, tmp_path):
        with pytest.raises(ValueError) as refused:
            act()
        text = str(refused.value)
        assert piece in text and "\n" not in text and len(text) > 20, text


def test_a_missing_file_is_a_file_not_found_error(heights_m, tmp_path):
    (tmp_path / "scene.toml").write_text('contacts = "gone.jsonl"\n[[body]]\nname = "b"\nmodes = "gone.modes.json"\n')
    for act in (
        lambda: asp.render(tmp_path / "nothing.toml"),
        lambda: asp.render(tmp_path / "scene.toml"),
        lambda: asp.stroke(asp.Surface(tmp_path / "gone.png", 0.1, relief_m=1e-3)),
        lambda: asp.stroke(asp.Solid("granite").on(asp.Body(tmp_path / "gone.modes.json"))),
        lambda: asp.render(asp.Solid("granite"), tmp_path / "gone.jsonl"),
        lambda: asp.fit(tmp_path / "gone.wav"),
        lambda: asp.texture.analyze(tmp_path / "gone.png"),
        lambda: asp.haptics.reduce(np.zeros(100), 8000, device="gone.toml"),
    ):
        with pytest.raises(FileNotFoundError, match="gone|nothing"):
            act()


def test_refused_events_and_silence_are_warned_of(heights_m):
    surface = asp.Surface(heights_m, 0.14)
    rows = asp.contacts.stroke(duration=0.2, extent=surface.extent)
    rows["gain"][3] = -1.0
    with pytest.warns(asp.TouchWarning, match="1 of 13 events was refused, the first at t = 0.05 s: gain"):
        asp.render(surface, rows)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        asp.render(surface, [{"t": 0.1, "event": "end", "contact": 1}])
    said = [str(w.message) for w in told]
    assert any(w.startswith("the audio is silence") for w in said)
    assert any(w.startswith("every haptic channel is silence") for w in said)


def test_each_output_that_is_silent_is_warned_of_with_its_own_reason(heights_m):
    surface = asp.Surface(heights_m, 0.14)
    with pytest.warns(asp.TouchWarning, match=r"the audio is silence .*: nothing touched has modes") as told:
        asp.stroke(surface, duration=0.2)
    assert not any("haptic" in str(w.message) for w in told)
    rows = asp.contacts.stroke(duration=0.2, extent=surface.extent)
    rows["actuator"] = -1
    with pytest.warns(asp.TouchWarning, match='every haptic channel is silence: nothing in the log names it; write "actuator":0'):
        asp.render(surface.on(asp.Body.stock("bar", 0.2, "steel")), rows)


def test_a_solid_is_known_with_a_hyphen_too():
    one, other = (asp.stroke(asp.Solid(name).on(asp.Body.stock("bar", 0.2, "steel")), duration=0.1) for name in ("rough-glass", "rough_glass"))
    np.testing.assert_array_equal(one.haptic, other.haptic)


def test_outputs_beyond_full_scale_are_warned_of(heights_m):
    surface = asp.Surface(heights_m, 0.14).on(asp.Body.stock("bar", 0.2, "steel"))
    for options, words in [
        ({"actuators": [{"full_scale": 1e-9}]}, "haptic channel 0 peaks at .* of full scale: raise full_scale"),
        ({"audio": {"gain": 1e6}}, "the audio exceeds full scale"),
        ({"audio": {"gain": 1e6, "limit": True}}, "a limiter turned down by up to"),
    ]:
        with pytest.warns(asp.TouchWarning, match=words):
            asp.stroke(surface, duration=0.2, **options)


def test_contacts_that_contradict_themselves_are_warned_of(heights_m):
    surface = asp.Surface(heights_m, 0.14).on(asp.Body.stock("bar", 0.2, "steel"))
    for extent, speed, unit in [(0.14, 80.0, "is velocity_m_s in mm/s"), (140.0, 0.1, "is velocity_m_s in mm/s")]:
        rows = asp.contacts.stroke(speed=speed, duration=0.4, extent=(extent, extent))
        if speed == 80.0:
            # As somebody does who counts in millimetres a second, beside places that are right.
            rows["uv"] = asp.contacts.stroke(speed=0.08, duration=0.4, extent=(extent, extent))["uv"]
        with pytest.warns(asp.TouchWarning, match=unit):
            asp.render(surface, rows)


def test_a_missing_file_and_an_unknown_name_are_refused_where_they_stand(tmp_path):
    for act, piece in [
        (lambda: asp.Body.stock("plaet", 0.2, "steel"), 'stock: "plaet" is unknown; write "plate"; must be one of: '),
        (lambda: asp.Body.stock("plate", 0.2, "porcelain"), 'material: "porcelain" is unknown; '),
        (lambda: asp.stroke("granite"), "surface: 'granite' is refused; must be asp.Surface, Solid"),
        (lambda: asp.Solid("granit"), 'solid: "granit" is unknown; write "granite"'),
        (lambda: asp.SceneFile(asp.Solid("granite"), probe="fingerpit"), 'probe: "fingerpit" is unknown; write "fingertip"'),
    ]:
        with pytest.raises(ValueError, match=piece):
            act()
    for act in (
        lambda: asp.Surface(tmp_path / "gone.png", 0.1, relief_m=1e-3),
        lambda: asp.Body(tmp_path / "gone.modes.json"),
        lambda: asp.Solid("granite", roughness=tmp_path / "gone.png"),
    ):
        with pytest.raises(FileNotFoundError, match="gone.*no such file"):
            act()


def test_a_take_shows_itself_with_a_player_and_its_waves(heights_m):
    take = asp.stroke(asp.Surface(heights_m, 0.14).on(asp.Body.stock("bar", 0.2, "steel")), duration=0.2)
    html = take._repr_html_()
    assert html.count("<polygon") == 2 and "data:audio/wav;base64,UklGR" in html
    frequency, time, level = take.spectrogram("haptic", n_fft=512)
    assert level.shape == (len(frequency), len(time)) and frequency[-1] == take.sr / 2
    assert json.loads(json.dumps(take.stats))["refused"] == 0


def test_a_full_scale_sine_has_0_db_in_the_spectrogram():
    sine = np.sin(2 * np.pi * 1000 * np.arange(16_000) / 16_000).astype(np.float32)
    take = asp.Take(sine, sine[None], 16_000.0, {})
    frequency, _, level = take.spectrogram(n_fft=1600)
    assert abs(level[:, 3].max()) < 0.05 and frequency[np.argmax(level[:, 3])] == 1000


def test_a_fit_of_two_known_modes_finds_them_and_rings_as_a_body():
    rate = 44_100
    t = np.arange(rate) / rate
    known = [(440.0, 6.0, 0.4), (1234.5, 12.0, 0.3)]
    y = sum(a * np.exp(-d * t) * np.sin(2 * np.pi * f * t) for f, d, a in known)
    y = np.concatenate([np.zeros(2000), y]) + 1e-5 * np.random.default_rng(1).standard_normal(rate + 2000)
    fit = asp.fit(y, rate, impulse=0.02)
    for f, d, a in known:
        mode = fit.modes[np.argmin(np.abs(fit.modes["frequency_hz"] - f))]
        assert abs(mode["frequency_hz"] - f) < 0.01 and abs(mode["decay_per_s"] - d) < 0.05 and abs(mode["amplitude"] - a) < 0.01
    both = asp.fit(np.stack([0.1 * y, y]), rate, impulse=0.02)
    assert np.array_equal(both.modes, fit.modes)
    event = {"t": 0.0, "event": "impact", "body": "body", "speed_m_s": 0.5, "mass_kg": 0.01, "radius_m": 0.005, "striker": "steel"}
    scene = asp.SceneFile(asp.Solid("granite"), bodies=[fit.body()])
    take = asp.render(scene, [event])
    spectrum = np.abs(np.fft.rfft(take.audio))
    assert abs(np.argmax(spectrum) * take.sr / len(take.audio) - 440.0) < 2.0


def test_a_normal_map_of_a_known_relief_gives_its_heights():
    y, x = np.mgrid[:128, :128]
    heights = 2.0 * np.sin(2 * np.pi * x / 32) * np.cos(2 * np.pi * y / 64)
    dx, dy = np.gradient(heights, axis=1), np.gradient(heights, axis=0)
    normal = np.stack([-dx, dy, np.ones_like(dx)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    found, told = asp.texture.from_normals(np.round(65_535 * (0.5 + 0.5 * normal)).astype(np.uint16), 1e-3, green="opengl")
    error = found - found.mean() - 1e-3 * (heights - heights.mean())
    assert rms(error) < 0.05 * rms(1e-3 * heights) and told["green"] == "opengl"


def test_a_metamer_comes_nearer_to_the_feel_than_it_was():
    rng = np.random.default_rng(5)
    look, feel = rng.random((128, 128)), np.cumsum(rng.standard_normal((128, 128)), axis=0)
    image, told = asp.texture.metamer(look, feel, iterations=10)
    assert image.shape == look.shape and told["mean_after"] < 0.3 * told["mean_before"]
    assert feel.min() - 1e-9 <= image.min() and image.max() <= feel.max() + 1e-9


def test_a_stroke_keeps_its_force_where_that_is_asked_for_by_its_own_word():
    surface = asp.Surface(1e-4 * np.random.default_rng(0).random((16, 16)), 0.14)
    take = asp.stroke(surface, force=0.6, duration=0.3, force_output=500.0)
    assert take.force is not None and take.force.dtype.names[:2] == ("time_s", "contact")
    assert abs(np.diff(take.force["time_s"]).mean() - 1 / 500) < 1e-9
    assert asp.stroke(surface, duration=0.1).force is None
    with pytest.raises(ValueError, match="force: True is refused.*force_output"):
        asp.stroke(surface, force=True)


FRAME = {"origin_m": [0, 0, 0], "u_axis": [1, 0, 0], "v_axis": [0, 1, 0]}


def test_a_tracked_hand_presses_and_strokes_what_it_touches():
    surface = asp.Solid("granite", 0.2, frame=FRAME, name="table").on(asp.Body.stock("plate", 0.2, "steel"))
    scene = asp.Scene(asp.SceneFile(surface, actuators=[{"full_scale": 1e-4}]), sr=48_000, clock="exact")
    tip = asp.Tip(surface)
    events = []
    for n in range(120):
        t = n / 90
        step = tip.step(1 / 90, (0.05 + 0.08 * t, 0.1, max(0.01 - 0.05 * t, -0.004)))
        events.append(step.event)
        if (keys := step.keys(contact=3)) is not None:
            scene.report(t, keys)
    assert events.count("begin") == 1 and events[-1] == "move"
    assert step.surface == "table" and step.normal_force_n == pytest.approx(0.8)
    assert step.velocity_m_s == pytest.approx((0.08, 0.0), abs=1e-3)
    audio, haptic = scene.renderer.render(64_000)
    assert rms(audio) > 1e-4 and rms(haptic) > 1e-4
    assert tip.lift().event == "end" and tip.step(0.01, (0.1, 0.1, 0.1)).event is None


def test_a_tip_says_what_it_needs():
    with pytest.raises(ValueError, match="surface.*frame: is missing"):
        asp.Tip(asp.Solid("granite"))
    with pytest.raises(ValueError, match="stiffness_n_m: 0 is refused; must be 1 to 1e5 N/m"):
        asp.Tip(asp.Solid("granite", frame=FRAME), stiffness_n_m=0)
    tip = asp.Tip(asp.Solid("granite", frame=FRAME))
    with pytest.raises(ValueError, match="dt: 0 is refused"):
        tip.step(0, (0, 0, 0))
    with pytest.raises(ValueError, match="position_m"):
        tip.step(0.01, (0, float("nan"), 0))


def stroked_live():
    surface = asp.Solid("granite", 0.2, name="table").on(asp.Body.stock("plate", 0.2, "steel"))
    return asp.Scene(asp.SceneFile(surface, actuators=[{"full_scale": 1e-4}]), sr=48_000, clock="exact")


def play_a_stroke(scene, frames, each):
    """A second of a stroke, then one of nothing, in 60 frames a second."""
    for n in range(frames):
        if n <= 60:
            at = dict(contact=1, uv=[0.1 + 0.01 * n, 0.5], normal_force_n=1.0)
            scene.begin(n / 60, surface="table", **at) if n == 0 else scene.move(n / 60, **at) if n < 60 else scene.end(1.0, 1)
        scene.renderer.render(800)
        each((n + 1) / 60)


def test_a_headset_gets_a_stroke_as_one_stream_of_frames():
    scene = stroked_live()
    port = asp.HeadsetFrames(scene, rate_hz=200.0)
    frames = []
    play_a_stroke(scene, 120, lambda now_s: frames.extend(port.read(now_s)))
    assert [frame.stage for frame in (frames[0], frames[-1])] == ["first", "last"]
    assert {frame.stage for frame in frames[1:-1]} == {"intermediate"} and len(frames) > 50
    assert frames[0].band_hz == (55.0, 200.0) and all(frame.band_hz is None for frame in frames[1:])
    times = np.concatenate([frame.time_ns for frame in frames])
    assert times[0] == 0 and frames[0].time_ns[-1] >= 50_000_000 and np.all(np.diff(times) >= 0)
    for values in (np.concatenate([frame.amplitude for frame in frames]), np.concatenate([frame.frequency for frame in frames])):
        assert values.dtype == np.float32 and 0 <= values.min() and 0.01 < values.max() <= 1
    assert sum(port.counts.values()) == 400 and port.counts["dropped"] == 0
    port.restart()
    for wrong, field in ((dict(channel=5), "actuator"), (dict(full_scale=0.0), "full_scale"), (dict(rate_hz=0.0), "rate_hz")):
        with pytest.raises(ValueError, match=field):
            asp.HeadsetFrames(scene, **wrong)


def test_a_pads_motors_turn_with_a_stroke_and_stop():
    scene = stroked_live()
    pad, late = asp.PadLevels(scene, full_scale=0.5), asp.PadLevels(scene, holds_s=0.1)
    levels = []
    play_a_stroke(scene, 120, lambda _: levels.extend(pad))
    levels = np.array(levels)
    assert levels.shape == (120, 2) and pad.lost == 0 and 0 <= levels.min() and levels.max() <= 1
    assert levels[10:60].max() > 0.02 and pad.newest() == tuple(levels[-1]) and levels[-1].max() < 1e-3
    late.newest()
    assert late.lost > 90
    with pytest.raises(ValueError, match="full_scale: 0 is refused"):
        asp.PadLevels(scene, full_scale=0)


def test_a_bell_in_slow_motion_rings_lower_and_a_strike_with_a_name_once(tmp_path):
    mode = {"frequency_hz": 800.0, "decay_per_s": 3.0, "amplitude": 0.3, "phase_rad": 0.0}
    modes = {"format": "asperity.modes", "version": 1, "source": "test", "impulse_n_s": 0.01, "modes": [mode]}
    (tmp_path / "bell.modes.json").write_text(json.dumps(modes))
    (tmp_path / "scene.toml").write_text('[[body]]\nname = "bell"\nmodes = "bell.modes.json"\n')

    def rings(scale: float) -> tuple[float, dict]:
        scene = asp.Scene(tmp_path / "scene.toml", sr=48_000, clock="exact")
        # Before what is reported for later: a scale holds from the last report on.
        scene.set_time_scale(scale, bend_pitch=True)
        strike = dict(body="bell", speed_m_s=1.0, mass_kg=0.004, radius_m=0.005)
        for _ in range(3):
            scene.impact_named(0.0, 7, **strike)
        # It counts from the last report on.
        scene.set_time_scale(scale, bend_pitch=True)
        scene.impact_named(5.0, 8, **strike)
        assert scene.withdraw(8) and not scene.withdraw(8)
        audio, _ = scene.renderer.render(48_000)
        tail = audio[8_000:]
        rises = np.flatnonzero((tail[:-1] < 0) & (tail[1:] >= 0))
        return (len(rises) - 1) / (rises[-1] - rises[0]) * 48_000, scene.stats

    for scale in (0.5, 1.0, 1.5):
        hz, stats = rings(scale)
        assert hz == pytest.approx(800 * scale, rel=1e-3) and stats["impacts"] == 1


def test_a_clip_plays_on_its_channel_beside_nothing(tmp_path):
    (tmp_path / "scene.toml").write_text("[[actuator]]\nfull_scale = 1e-4\n[[actuator]]\nfull_scale = 1e-4\n")
    scene = asp.Scene(tmp_path / "scene.toml", sr=48_000, clock="exact")
    wave = 0.5 * np.sin(2 * np.pi * 170 * np.arange(1600) / 8000)
    scene.play_clip(1, wave, gain=0.5, t=0.1, sr=8000)
    _, haptic = scene.renderer.render(24_000)
    assert np.abs(haptic[0]).max() == 0
    assert np.abs(haptic[1][4_900:14_000]).max() == pytest.approx(0.25, rel=1e-3)
    assert np.abs(haptic[1][:4_790]).max() == 0
    with pytest.raises(ValueError, match="ducking"):
        scene.play_clip(0, wave, t=0.2, sr=8000, ducking=2)


def test_a_pickup_reads_a_body_in_its_unit(tmp_path):
    body = asp.Body.stock("plate", 0.14, "steel")
    pickup = {"name": "mic", "body": body.name, "factor": 1.0}
    scene = asp.SceneFile(asp.Solid("granite").on(body), pickups=[pickup], audio={"gain": 0.1}, actuators=[{"full_scale": 1e-4}])
    blow = {"t": 0.0, "event": "impact", "body": body.name, "speed_m_s": 0.5, "mass_kg": 0.01, "radius_m": 0.005, "striker": "steel"}
    take = asp.render(scene, [blow])
    assert take.pickup.shape == (1, take.audio.shape[-1]) and take.pickup.dtype == np.float32
    assert rms(take.pickup) > 0.1
    assert [path.rsplit(".", 2)[1] for path in take.save(tmp_path / "take")] == ["audio", "haptic", "pickup"]
    softer = asp.render(scene, [blow | {"speed_m_s": 0.25}])
    assert 1.5 < rms(take.pickup) / rms(softer.pickup) < 3.0
    assert asp.render(asp.SceneFile(asp.Solid("granite")), []).pickup.shape == (0, 0)
