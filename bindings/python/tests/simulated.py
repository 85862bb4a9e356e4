"""MuJoCo scenes that a microphone listens to, what truly happened in them, and twenty lines that hear it."""

import mujoco
import numpy as np

import asperity.mujoco

SR, STEP_S = 16_000, 0.002
# Onsets that follow closer than this are one.
APART_S = 0.06
TABLE = '<geom name="table" type="box" size=".25 .25 .02" pos="0 0 -.02"/>'
HEAD = '<mujoco><option timestep="0.002" integrator="implicitfast" cone="elliptic"/><default><geom solref="{solref}" friction=".2 .005 .0001"/></default><worldbody>'
MATERIALS = {"table": "wood", "ball": "steel", "box": "plastic", "peg": "plastic", "tip": "steel"} | {f"wall{i}": "plastic" for i in range(4)}


def dragged(rng):
    """A ball of 8 mm pressed on a table and dragged at speeds that change."""
    body = '<body pos="0 0 .0079"><joint name="x" type="slide" axis="1 0 0" damping="2"/><joint type="slide" axis="0 0 1" damping="5"/>'
    body += '<geom name="tip" type="sphere" size=".008" mass=".05"/></body>'
    xml = HEAD.format(solref="0.02 1") + TABLE + body + '</worldbody><actuator>'
    model = mujoco.MjModel.from_xml_string(xml + '<velocity joint="x" kv="40"/></actuator></mujoco>')
    force = rng.uniform(0.4, 1.2)
    # Three strokes of speeds that change, one of them backwards.
    knots = np.concatenate([[0.0], rng.uniform(0.03, 0.3, 12)]) * np.repeat(rng.permutation([1, 1, -1]), [5, 4, 4])
    knots[[4, 8]] = 0.0

    def drive(data):
        data.ctrl[0] = knots[min(int(data.time / 0.2), 12)]
        data.qfrc_applied[1] = -force

    return model, drive, 2.4


def dropped(rng):
    """A steel ball that falls and bounces."""
    body = f'<body pos="0 0 {rng.uniform(0.03, 0.12)}"><freejoint/><geom name="ball" type="sphere" size=".01" density="7800"/></body>'
    solref = f"-40000 -{rng.uniform(2, 20)}"
    model = mujoco.MjModel.from_xml_string(HEAD.format(solref=solref) + TABLE + body + "</worldbody></mujoco>")
    return model, lambda data: None, 1.0


def sliding_off(rng):
    """A box that slides off when the table is tilted."""
    body = '<body pos=".12 0 .0199"><freejoint/><geom name="box" type="box" size=".03 .03 .02" mass=".1"/></body>'
    model = mujoco.MjModel.from_xml_string(HEAD.format(solref="0.02 1") + TABLE + body + "</worldbody></mujoco>")
    from_s, slope = rng.uniform(0.2, 0.3), np.radians(rng.uniform(16, 25))

    def drive(data):
        angle = slope if data.time > from_s else 0.0
        model.opt.gravity[:] = 9.81 * np.array([np.sin(angle), 0.0, -np.cos(angle)])

    return model, drive, 1.2


def peg_in_hole(rng):
    """A peg that is let down into a hole of four walls, off its middle, and knocked against one of them."""
    walls = "".join(
        f'<geom name="wall{i}" type="box" size="{a} {b} .03" pos="{x} {y} .03"/>'
        for i, (x, y, a, b) in enumerate([(0.0325, 0, 0.02, 0.06), (-0.0325, 0, 0.02, 0.06), (0, 0.0325, 0.02, 0.02), (0, -0.0325, 0.02, 0.02)])
    )
    offset = rng.uniform(-0.004, 0.004, 2)
    body = f'<body pos="{offset[0]} {offset[1]} .11" gravcomp="1"><joint name="z" type="slide" axis="0 0 1"/>'
    body += '<joint type="slide" axis="1 0 0" stiffness="50" damping="1"/><joint type="slide" axis="0 1 0" stiffness="50" damping="1"/>'
    body += '<geom name="peg" type="capsule" size=".01 .03" mass=".1"/></body></worldbody><actuator>'
    xml = HEAD.format(solref="0.02 1") + TABLE + walls + body + '<velocity joint="z" kv="20"/></actuator></mujoco>'
    model = mujoco.MjModel.from_xml_string(xml)
    speed, at_s = rng.uniform(0.15, 0.25), rng.uniform(0.15, 0.2)
    push, way = rng.uniform(0.5, 1.5), rng.integers(0, 4) * np.pi / 2

    def drive(data):
        data.ctrl[0] = -speed
        pushed = push * (at_s < data.time < at_s + 0.06)
        data.qfrc_applied[1:3] = pushed * np.cos(way), pushed * np.sin(way)

    return model, drive, 0.8


SCENES = {"dragged": dragged, "dropped": dropped, "sliding off": sliding_off, "peg in hole": peg_in_hole}
# The geom that the microphone is on.
MIC_ON = {"peg in hole": "peg"}


def run(scene, seed, **named):
    """What the microphone hears, its rate, the times of true onsets, and the speed of slip at each step."""
    model, drive, duration_s = SCENES[scene](np.random.default_rng(seed))
    geom = MIC_ON.get(scene, "table")
    data = mujoco.MjData(model)
    materials = {name: material for name, material in MATERIALS.items() if name in [model.geom(i).name for i in range(model.ngeom)]}
    mic = asperity.mujoco.ContactMic(model, data, geom=geom, materials=materials, seed=seed, sr=SR, **named)
    mine = model.geom(geom).id
    onsets, slips, since_s = [], [], {}
    for _ in range(round(duration_s / STEP_S)):
        drive(data)
        mujoco.mj_step(model, data)
        mic.step()
        at = data.time - STEP_S
        touches = truth(model, data, mine)
        for other, (closing, slip) in touches.items():
            touched_s, slid_s = since_s.get(other, (-1.0, -1.0))
            begins = (at - touched_s > 0.03 and closing > 0.03) or (at - slid_s > 0.05 and slip > 0.02)
            if begins and (not onsets or at - onsets[-1] > APART_S):
                onsets.append(at)
            since_s[other] = at, at if slip > 0.02 else slid_s
        slips.append(max((slip for _, slip in touches.values()), default=0.0))
    return mic.read(round(duration_s / STEP_S - 1) * STEP_S), np.array(onsets), np.array(slips)


def truth(model, data, mine):
    """How fast each thing that touches the geom comes and slides: by MuJoCo's own words alone."""
    touches, velocity = {}, np.zeros(6)
    for index in range(data.ncon):
        contact = data.contact[index]
        if mine not in contact.geom or contact.efc_address < 0 or data.efc_force[contact.efc_address] <= 0:
            continue
        other = int(contact.geom[0] if contact.geom[1] == mine else contact.geom[1])
        if model.geom(other).name not in MATERIALS:
            continue
        at = 0.0
        for sign, geom in ((1, other), (-1, mine)):
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_GEOM, geom, velocity, 0)
            at = at + sign * (velocity[3:] + np.cross(velocity[:3], contact.pos - data.geom_xpos[geom]))
        normal = contact.frame[:3]
        closing, slip = touches.get(other, (0.0, 0.0))
        touches[other] = max(closing, abs(at @ normal)), max(slip, float(np.linalg.norm(at - normal * (at @ normal))))
    return touches


def heard_onsets(signal):
    """Times at which the level above some kHz, where bodies ring off soon, leaves silence or rises over that of 30 ms before by a factor
    (found on other seeds), none within `APART_S` of another."""
    frame, found = SR // 500, []
    high = np.diff(signal, 2)
    energy = (high[: len(high) // frame * frame].reshape(-1, frame) ** 2).mean(1) ** 0.5
    floor = 2e-4 * energy.max()
    for at in np.flatnonzero(energy > floor):
        before = energy[max(at - 16, 0) : max(at - 1, 0)].max(initial=0.0)
        if (before < floor or energy[at] > 3.2 * before) and (not found or at - found[-1] > APART_S * 500):
            found.append(at)
    return np.array(found) * frame / SR


def f1(pairs, within_s=0.02):
    """F1 over pairs of true and heard onsets, each of which counts once."""
    hits = said = true = 0
    for truth, heard in pairs:
        left = list(heard)
        for onset in truth:
            near = [x for x in left if abs(x - onset) <= within_s]
            if near:
                left.remove(min(near, key=lambda x: abs(x - onset)))
                hits += 1
        said, true = said + len(heard), true + len(truth)
    return 2.0 * hits / max(said + true, 1)


def features(signal, slips):
    """Levels of bands in frames of 40 ms, each with its neighbours, and the mean slip in each frame."""
    frame, steps = SR // 25, round(0.04 / STEP_S)
    count = min(len(signal) // frame, len(slips) // steps)
    power = np.abs(np.fft.rfft(signal[: count * frame].reshape(count, frame) * np.hanning(frame), axis=1)) ** 2
    edges = np.unique(np.geomspace(1, power.shape[1], 25).astype(int))
    levels = np.log10(np.add.reduceat(power, edges[:-1], axis=1) + 1e-9)
    levels = np.hstack([levels, levels[[0, *range(count - 1)]], levels[[*range(1, count), -1]]])
    return levels, slips[: count * steps].reshape(count, steps).mean(1)


def fitted(levels, slips, ridge=1.0):
    """Ridge regression of the root of slip on levels and their squares."""
    x = design(levels)
    return np.linalg.solve(x.T @ x + ridge * np.eye(x.shape[1]), x.T @ np.sqrt(slips))


def design(levels):
    return np.hstack([np.ones((len(levels), 1)), levels, levels**2 / 10.0])
