"""Microphones on bodies of simulators: MuJoCo's wheel, and plain arrays."""

import copy
import pickle
import time

import numpy as np
import pytest

import asperity as asp

mujoco = pytest.importorskip("mujoco")
import asperity.mujoco  # noqa: E402
import simulated  # noqa: E402

STEP_S = 0.002


def microphones(worlds=1, **named):
    """Worlds of a table with a microphone on which two balls run round in circles."""
    table = asp.Body.stock("plate", 0.3, "wood", "table")
    top = asp.Surface(np.zeros((2, 2)), 0.2, name="top").on(table)
    scene = asp.SceneFile(top, [table], pickups=[{"name": "mic", "body": "table", "factor": 1.0}])
    ball = asp.Thing("steel", mass_kg=0.05, form="sphere", radius_m=0.008)
    return asp.Microphones(scene, [asp.Thing("wood", "table", "top"), ball, ball], worlds=worlds, step_s=STEP_S, **named)


def circles(step, worlds):
    """The arrays of a step of these worlds."""
    count, t = len(worlds), step * STEP_S
    place, velocity = np.zeros((count, 3, 3)), np.zeros((count, 3, 6))
    for ball, (turn, radius) in enumerate(((3.0, 0.05), (-2.0, 0.08)), 1):
        at = turn * t + np.asarray(worlds, float)
        place[:, ball] = np.c_[radius * np.cos(at), radius * np.sin(at), np.full(count, 0.008)]
        velocity[:, ball, 3:5] = radius * turn * np.c_[-np.sin(at), np.cos(at)]
    point = place[:, 1:].reshape(-1, 3) - [0.0, 0.0, 0.008]
    return {
        "t": t, "pairs": np.tile([[0, 1], [0, 2]], (count, 1)), "point": point, "normal": np.tile([0.0, 0.0, 1.0], (2 * count, 1)),
        "force": np.tile([0.6, 0.9], count), "place": place, "rotation": np.tile(np.eye(3), (count, 3, 1, 1)), "velocity": velocity,
        "world": np.repeat(np.arange(count), 2),
    }  # fmt: skip


def test_twelve_lines_give_a_robot_ears_that_pickle_and_begin_anew():
    model, drive, _ = simulated.dragged(np.random.default_rng(3))
    data = mujoco.MjData(model)
    mic = asperity.mujoco.ContactMic(model, data, geom="table", materials={"*": "wood", "tip": "steel"}, seed=5)

    def hears():
        mujoco.mj_resetData(model, data)
        for _ in range(300):
            drive(data)
            mujoco.mj_step(model, data)
            mic.step()
        return mic.read(0.5)

    first = hears()
    assert first.shape == (8000,) and first.dtype == np.float32 and np.abs(first).max() > 1.0
    mic.reset()
    assert not mic.read(0.5).any()
    assert np.array_equal(first, hears())
    for again in (pickle.loads(pickle.dumps(mic)), copy.copy(mic)):
        with pytest.raises(ValueError, match=r"attached to nothing; call attach\(model, data\)"):
            again.step()
        again.attach(model, data)
        mic = again
        assert np.array_equal(first, hears())


def test_a_body_at_rest_is_silent_and_an_accelerometer_on_it_reads_gravity():
    xml = simulated.HEAD.format(solref="0.02 1") + simulated.TABLE
    xml += '<body pos="0 0 .0199"><freejoint/><geom name="box" type="box" size=".03 .03 .02" mass=".1"/></body></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    named = {"geom": ["table", "box"], "materials": {"table": "wood", "box": "plastic"}}
    mics = [asperity.mujoco.ContactMic(model, data, gravity=gravity, **named) for gravity in (False, True)]
    for _ in range(500):
        mujoco.mj_step(model, data)
        for mic in mics:
            mic.step()
    assert mics[0].read(1.0).shape == (2, 16_000) and not mics[0].read(1.0).any()
    # A body without shapes reads along its own z.
    assert mics[1].read(0.1) == pytest.approx(np.full((2, 1600), 9.81), rel=1e-3)


def test_worlds_at_once_have_the_bits_of_one_at_a_time_and_a_mask_begins_some_anew():
    worlds = range(5)
    together = microphones(5, seed=7, threads=2)
    for step in range(200):
        together.step(**circles(step, worlds))
    read = together.read(0.35)
    assert read.shape == (5, 1, 5600) and len({one.tobytes() for one in read}) == 5
    for world in worlds:
        alone = microphones(seed=7 + world)
        for step in range(200):
            arrays = circles(step, [world])
            del arrays["world"]
            alone.step(**arrays)
        assert np.array_equal(alone.read(0.35)[0], read[world])
    together.reset([False, True, False, False, True])
    after = together.read(0.35)
    assert not after[[1, 4]].any() and np.array_equal(after[[0, 2, 3]], read[[0, 2, 3]])
    again = pickle.loads(pickle.dumps(together))
    for step in range(200):
        again.step(**circles(step, worlds))
    assert np.array_equal(again.read(0.35), read)


def test_two_worlds_of_mujoco_have_the_bits_of_one():
    model, drive, _ = simulated.dragged(np.random.default_rng(1))
    several = [mujoco.MjData(model) for _ in range(2)]
    named = {"geom": "table", "materials": {"table": "wood", "tip": "steel"}}
    both = asperity.mujoco.ContactMic(model, several, seed=1, **named)
    alone = asperity.mujoco.ContactMic(model, several[1], seed=2, **named)
    for _ in range(200):
        for data in several:
            drive(data)
            mujoco.mj_step(model, data)
        both.step()
        alone.step()
    assert np.array_equal(both.read(0.3)[1], alone.read(0.3)) and both.read(0.3).shape == (2, 4800)


def test_events_come_out_as_a_contact_log_that_renders():
    mics = microphones(log=True)
    for step in range(100):
        arrays = circles(step, [0])
        del arrays["world"]
        mics.step(**arrays)
    nothing = {"pairs": np.zeros((0, 2), int), "point": np.zeros((0, 3)), "normal": np.zeros((0, 3)), "force": []}
    mics.step(**(arrays | {"t": 100 * STEP_S} | nothing))
    rows = mics.events()
    assert list(rows["event"][:2]) == ["begin", "begin"] and set(rows["event"]) == {"begin", "move", "end"}
    assert np.nanmax(rows["normal_force_n"]) == pytest.approx(0.9) and rows["t"][-1] == pytest.approx(100 * STEP_S)
    speed = np.linalg.norm(rows["velocity_m_s"][:-2], axis=1)
    assert np.allclose(np.sort(np.unique(np.round(speed, 3))), [0.15, 0.16])
    take = asp.render(mics.scene, rows, seed=1, sr=16_000)
    read = mics.read(0.1)[0, 0]
    assert np.array_equal(take.pickup[0, 3200 - len(read) : 3200], read) and np.ptp(read) > 1.0


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"point": np.full((4, 3), np.nan)}, "point: number 0 is not finite; must be a number"),
        ({"point": np.zeros((3, 3))}, "point: has the shape [3, 3]; must be [4, 3]"),
        ({"force": ["a"] * 4}, "force: is <U1 with 1 axes; must be float64 with 1"),
        ({"pairs": np.full((4, 2), 3)}, "pairs: row 0 is [3, 3]; must be 0 to 2"),
        ({"pairs": np.zeros((4, 2))}, "pairs: is float64 with 2 axes; must be int32 with 2"),
        ({"world": np.array([0, 1, 2, 0])}, "world: row 2 is 2; must be 0 to 1"),
        ({"world": None}, "world: is missing; must name the world of each row"),
        ({"velocity": np.zeros((2, 2, 6))}, "velocity: has the shape [2, 2, 6]; must be [2, 3, 6]"),
        ({"rotation": np.zeros((2, 3, 4))}, "rotation: has the shape (2, 3, 4); must be (2, 3, 3, 3)"),
        ({"t": 0.0}, "t: world 0 is at 0 s after 0.098 s; must grow, or be reset"),
        ({"t": [0.1, np.inf]}, "t: number 1 is not finite; must be a number"),
    ],
)
def test_a_wrong_step_is_refused_in_a_sentence_and_nothing_is_lost(change, sentence):
    mics, other = microphones(2), microphones(2)
    for step in range(50):
        mics.step(**circles(step, range(2)))
        other.step(**circles(step, range(2)))
    with pytest.raises(ValueError) as refused:
        mics.step(**(circles(50, range(2)) | change))
    assert str(refused.value) == sentence
    for heard in (mics, other):
        heard.step(**circles(50, range(2)))
    assert np.array_equal(mics.read(0.1), other.read(0.1)) and mics.read(0.1).any()


def test_wrong_names_are_refused_where_they_stand():
    model, _, _ = simulated.dragged(np.random.default_rng(0))

    def refused(**named):
        with pytest.raises(ValueError) as error:
            asperity.mujoco.ContactMic(model, mujoco.MjData(model), **({"geom": "table", "materials": {"*": "wood"}} | named))
        return str(error.value)

    assert refused(geom="tabel") == 'geom: "tabel" is unknown; write "table"'
    assert refused(materials={"tpi": "wood"}) == 'materials: "tpi" is unknown; write "tip"'
    assert refused(materials={"tip": "wood"}) == 'materials: "table" has none, and the microphone is on it; name its material'
    assert refused(materials={"table": "wod"}).startswith('material: "wod" is unknown; write "wood"')
    assert refused(materials={"table": {"surfaces": 1}}).startswith('materials: "table" is [')
    assert refused(sensor="adxl").startswith("scene.toml")
    with pytest.raises(ValueError, match="seconds: 11 is refused; must be 0 to keep, 10.0"):
        microphones().read(11)
    with pytest.raises(ValueError, match="mask: is int64 of the shape"):
        microphones().reset([1])
    with pytest.raises(ValueError, match="scene: has no pickups"):
        asp.Microphones(asp.SceneFile(asp.Solid("granite")), [])
    with pytest.raises(ValueError, match='surface "top" is unknown|surface: "tap" is unknown'):
        asp.Microphones(microphones()._made_of[0][0], [asp.Thing("wood", "table", "tap")])


@pytest.fixture(scope="module")
def heard():
    """Fifty seeds of each scene, and of strokes a hundred."""
    return {scene: [simulated.run(scene, seed) for seed in range(100 if scene == "dragged" else 50)] for scene in simulated.SCENES}


@pytest.mark.slow
def test_onsets_of_four_scenes_are_heard_within_20_ms(heard):
    pairs = {scene: [(onsets, simulated.heard_onsets(signal)) for signal, onsets, _ in runs[:50]] for scene, runs in heard.items()}
    scores = {scene: simulated.f1(some) for scene, some in pairs.items()}
    together = simulated.f1([pair for some in pairs.values() for pair in some])
    print(f"F1 {together:.3f};", ", ".join(f"{scene} {score:.3f}" for scene, score in scores.items()))
    assert together >= 0.95 and min(scores.values()) >= 0.9


@pytest.mark.slow
def test_slip_speed_is_heard_by_an_estimator_of_other_seeds(heard):
    frames = [simulated.features(signal, slips) for signal, _, slips in heard["dragged"]]
    train, test = ([np.concatenate(all) for all in zip(*part, strict=True)] for part in (frames[:50], frames[50:]))
    estimate = np.maximum(simulated.design(test[0]) @ simulated.fitted(*train), 0.0) ** 2
    r2 = 1.0 - np.mean((estimate - test[1]) ** 2) / np.var(test[1])
    print(f"R\u00b2 {r2:.3f}")
    assert r2 >= 0.9


@pytest.mark.slow
def test_sixty_four_worlds_run_and_a_thousand_resets_keep_their_memory():
    mics = microphones(64)
    arrays = [circles(step, range(64)) for step in range(250)]
    started, worked = time.perf_counter(), time.process_time()
    for one in arrays:
        mics.step(**one)
    mics.read(0.1)
    wall, work = time.perf_counter() - started, time.process_time() - worked
    print(f"64 worlds for 0.5 s: {wall:.2f} s, {work:.2f} s of processors")
    # 16 worlds a processor, on one that others use as well.
    assert work < 64 * 0.5 / 16
    mics, resident = microphones(2), []
    for _ in range(1000):
        mics.reset()
        for one in arrays[:4]:
            mics.step(**(one | {k: v[:2] for k, v in one.items() if k in ("place", "rotation", "velocity")} | {
                k: v[:4] for k, v in one.items() if k in ("pairs", "point", "normal", "force", "world")}))  # fmt: skip
        with open("/proc/self/statm") as statm:
            resident.append(int(statm.read().split()[1]) * 4)
    print(f"resident after 100 resets {resident[100]} kB, after 1000 {resident[-1]} kB")
    assert resident[-1] < 1.03 * resident[100]
