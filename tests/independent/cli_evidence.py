"""What `asperity render` writes, measured without any code of this project.

    pip install numpy scipy
    python cli_evidence.py PATH/TO/asperity FOLDER

numpy and scipy read the WAV files and traces of renders of scenes made here: gratings, straight
strokes, noise plates. The contact is integrated again from the trace's own height_m and
normal_force_n (cubic spline between samples, classical Runge-Kutta, 16 steps a sample).

What it printed when it was written (44.1 kHz unless said otherwise):

    grating         25 pairs of 0.5-10 mm and 20-300 mm/s: fundamental in its own bin of 0.5 Hz
    path            extrapolate: ripple 0.0000 %, lag 7.50 ms; with 20 % jitter, 50 um noise and velocities
                    within 2 %: 4.2 %; hermite 0.0000 %, 28.3 ms, 3.4 %; hold 35.8 %, 15.8 ms, 43.4 %
                    22.05-192 kHz, 50-144 events a second (which fall between samples): at most 0.0003 %
    out and back    22049 places met twice: the same height to the last bit
    trace           the modes' answer to impulse_n_s is the audio file to 0.01 % rms
    blocks          1-4096 and a second run: the same bytes of both WAVs and the trace, the same counts
    rates           22.05-192 kHz, R = 1: haptic rms 5.48-5.67 um, audio -46.3 to -45.1 dB
    noise           slope deviates by -0.088, -0.084, -0.081, -0.082 dB/oct at alpha 1, 1.5, 2, 2.5;
                    four times the speed: -0.09, 2.96, 5.98, 8.98 dB
    contact         12 profiles, geometric mean (worst): exact-event 2.2e-5 (2.4e-3), semi-implicit-euler
                    2.2e-4 (1.4e-2), energy-conserving 2.6e-4 (2.3e-2); the worst is noise pressed lightly
"""

import json
import math
import os
import subprocess
import sys

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.io import wavfile
from scipy.signal import welch

PROGRAM, FOLDER = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
os.makedirs(FOLDER, exist_ok=True)
MODES = {"format": "asperity.modes", "version": 1, "impulse_n_s": 0.01, "modes": [
    {"frequency_hz": f, "decay_per_s": d, "amplitude": a, "phase_rad": 0.0}
    for f, d, a in [(412, 9, .3), (1133, 14, .25), (2219, 22, .2), (3671, 31, .15), (5480, 45, .1)]]}


def write_pgm(name, rows):
    rows = np.round(np.clip(rows, 0, 1) * 65535).astype(">u2")
    with open(os.path.join(FOLDER, name), "wb") as f:
        f.write(b"P5\n%d %d\n65535\n" % (rows.shape[1], rows.shape[0]) + rows.tobytes())


def render(stem, surface, log, extra=(), trace=False, probe="", tail=0.1):
    with open(os.path.join(FOLDER, "body.modes.json"), "w") as f:
        json.dump(MODES, f)
    with open(os.path.join(FOLDER, stem + ".toml"), "w") as f:
        f.write(f'contacts = "{stem}.jsonl"\ntail_s = {tail}\n[[body]]\nname = "b"\nmodes = "body.modes.json"\n'
                f'material = "ceramic"\n[[surface]]\nname = "s"\nbody = "b"\n{surface}\n'
                f'[[actuator]]\nfull_scale = 1.0\n{probe}')
    with open(os.path.join(FOLDER, stem + ".jsonl"), "w") as f:
        f.writelines(json.dumps(line) + "\n" for line in log)
    out = os.path.join(FOLDER, stem)
    done = subprocess.run([PROGRAM, "render", out + ".toml", "-o", out, "--json", *extra,
                           *(["--trace"] if trace else [])], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rate, audio = wavfile.read(out + ".audio.wav")
    _, haptic = wavfile.read(out + ".haptic.wav")
    rows = None
    if trace:
        rows = np.loadtxt(out + ".trace.csv", delimiter=",", skiprows=1)
        os.remove(out + ".trace.csv")
    return rate, audio.astype(float), haptic.astype(float), rows, json.loads(done.stdout)


def stroke(width, v, seconds, force=0.6, hz=60.0, u0=0.1, jitter=0.0, noise=0.0, bias=0.0, seed=1):
    r = np.random.default_rng(seed)
    times = np.arange(int(seconds * hz)) / hz
    times[1:] += jitter / hz * r.uniform(-1, 1, len(times) - 1)
    lines = []
    for i, t in enumerate(times):
        u = u0 + (v * t + noise * r.normal()) / width
        speed = v * (1 + bias * r.uniform(-1, 1))
        lines.append({"t": float(t), "event": "move" if i else "begin", "contact": 1, "uv": [u, 0.525],
                      "velocity_m_s": [speed, 0.0], "normal_force_n": force})
    lines[0] |= {"surface": "s", "actuator": 0}
    return lines + [{"t": float(seconds), "event": "end", "contact": 1}]


def gratings():
    worst = 0.0
    for lam in (0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3):
        x = (np.arange(512) + 0.5) / 512
        write_pgm("grating.pgm", np.tile(0.5 + 0.5 * np.sin(2 * np.pi * 32 * x), (4, 1)))
        width = 32 * lam
        for v in (0.02, 0.05, 0.1, 0.2, 0.3):
            surface = (f'displacement = "grating.pgm"\nwidth_m = {width}\nheight_m = 0.14\n'
                       f'relief_m = {0.04 * lam}\nmicro_relief_m = 0.0')
            rate, _, haptic, _, _ = render("grating", surface, stroke(width, v, 2.6))
            x = haptic[int(0.4 * rate):int(2.4 * rate)]
            peak = np.argmax(np.abs(np.fft.rfft(x * np.hanning(len(x))))[1:]) + 1
            worst = max(worst, abs(0.5 * peak - v / lam))
    print(f"grating: 25 pairs, fundamental off by at most {worst:.3f} Hz (bin 0.5 Hz)")


def path():
    surface = "width_m = 0.14\nheight_m = 0.14\nmicro_relief_m = 0.0"

    def ripple_and_lag(lines, *extra):
        rate, _, _, rows, _ = render("path", surface, lines, extra, trace=True)
        t, x = rows[:, 0], (rows[:, 2] - 0.1) * 0.14
        keep = (t > 0.5) & (t < 2.9)
        v = np.gradient(x, t)[keep]
        return 100 * v.std() / 0.1, 1e3 * np.mean(0.1 * t[keep] - x[keep]) / 0.1

    worst = 0.0
    for rate in (22050, 44100, 48000, 96000, 192000):
        for hz in (50.0, 60.0, 72.0, 90.0, 144.0):
            ripple, lag = ripple_and_lag(stroke(0.14, 0.1, 3.0, hz=hz), "--rate", str(rate))
            worst = max(worst, ripple)
            assert abs(lag - 7.5) < 0.1, (rate, hz, lag)
    print(f"path extrapolate  22.05-192 kHz, 50-144 events a second: ripple at most {worst:.5f} %")
    for name, options in (("clean", {}), ("jitter 20 %, 50 um, velocity within 2 %",
                                          {"jitter": 0.2, "noise": 50e-6, "bias": 0.02})):
        for mode in ("extrapolate", "hermite", "hold"):
            ripple, lag = ripple_and_lag(stroke(0.14, 0.1, 3.0, **options), "--path", mode)
            print(f"path {mode:12} {name}: ripple {ripple:.4f} %, lag {lag:.2f} ms")


def flat(r, relief=2e-6):
    return f"width_m = 0.14\nheight_m = 0.14\nroughness = {r}\nmicro_relief_m = {relief}"


def noise():
    bands = 12.0 * 2.0 ** (np.arange(51) / 6)
    for alpha in (1.0, 1.5, 2.0, 2.5):
        r = (2.5 - alpha) / 1.5
        psd = {}
        for v, seconds in ((0.05, 16.0), (0.2, 16.0)):
            rate, _, _, rows, _ = render("noise", flat(r), stroke(0.14, v, seconds), trace=True)
            h = rows[int(0.2 * rate):, 4]
            f, p = welch(h, rate, "hann", 16384)
            psd[v] = np.array([[(f[m] ** 1).mean(), (p[m] * f[m] ** alpha).mean(), m.sum()]
                               for m in ((f >= a) & (f < b) for a, b in zip(bands[:-1], bands[1:]))
                               if m.sum() > 0])
        s = psd[0.2]
        slope, _ = np.polyfit(np.log2(s[:, 0]), 10 * np.log10(s[:, 1]), 1, w=np.sqrt(s[:, 2]))
        ratio = 10 * np.log10(psd[0.2][:, 1] / psd[0.05][:, 1])
        level = np.average(ratio, weights=s[:, 2])
        print(f"noise alpha {alpha}: slope {slope - 3.0103 * alpha:+.3f} dB/oct (deviation {slope:+.3f}), "
              f"x4 speed {level:+.3f} dB, law {6.0206 * (alpha - 1):+.3f}")


def out_and_back():
    """90 events a second fall on whole samples, so the path is even and a shift of the positions on the
    way back by a part of a sample makes both ways meet at the same places: nothing is interpolated."""
    def heights(r, shift_m):
        lines = []
        for i in range(181):
            t = i / 90
            x, v = (0.05 * t, 0.05) if t < 1 else (0.05 * (2 - t) + shift_m, -0.05)
            lines.append({"t": t, "event": "move" if i else "begin", "contact": 1,
                          "uv": [0.2 + x / 0.14, 0.5], "velocity_m_s": [v, 0.0], "normal_force_n": 0.6})
        lines[0] |= {"surface": "s", "actuator": 0}
        lines.append({"t": 2.0, "event": "end", "contact": 1})
        rate, _, _, rows, _ = render("back", flat(r), lines, trace=True)
        t, x, h = rows[:, 0], rows[:, 2] * 0.14, rows[:, 4]
        out, back = (t > 0.2) & (t < 0.98), (t > 1.3) & (t < 1.8)
        return rate, x[out], h[out], x[back], h[back]

    for r in (1.0, 0.0):
        rate, xo, _, xb, _ = heights(r, 0.0)
        step = 0.05 / rate
        rate, xo, ho, xb, hb = heights(r, -((xb[0] - xo[0]) % step))
        near = np.clip(np.round((xb - xo[0]) / step).astype(int), 0, len(xo) - 1)
        same = np.abs(xo[near] - xb) < 1e-10
        print(f"out and back, R = {r}: {same.sum()} of {len(xb)} places met twice to 1e-10 m; "
              f"heights differ by at most {np.abs(ho[near] - hb)[same].max(initial=0):.2e} m "
              f"(noise {hb.std():.1e} m rms)")


MS, KS, BS, MF, KM = 0.15e-3, 1000.0, 2.0, 20e-3, 5e4


def reintegrate(rows, rate, substeps=16):
    """pad_m again, from height_m and normal_force_n alone; starts from the first row's state."""
    h = CubicSpline(np.arange(len(rows)), rows[:, 4])(np.arange((len(rows) - 1) * 2 * substeps + 1)
                                                      / (2 * substeps)).tolist()
    fn = np.interp(np.arange((len(rows) - 1) * 2 * substeps + 1) / (2 * substeps),
                   np.arange(len(rows)), rows[:, 5]).tolist()
    dt = 1.0 / rate / substeps
    xs, vs, xf = rows[0, 6], rows[0, 7], rows[0, 8]
    vf = (rows[1, 8] - rows[0, 8]) * rate
    pad = [xs]

    def acc(xs, vs, xf, vf, h, f):
        strut = KS * (xs - xf) + BS * (vs - vf)
        push = KM * (h - xs) if h > xs else 0.0
        return (push - strut) / MS, (strut - f) / MF

    k = 0
    for _ in range(len(rows) - 1):
        for _ in range(substeps):
            a1, b1 = acc(xs, vs, xf, vf, h[k], fn[k])
            v2, w2 = vs + dt / 2 * a1, vf + dt / 2 * b1
            a2, b2 = acc(xs + dt / 2 * vs, v2, xf + dt / 2 * vf, w2, h[k + 1], fn[k + 1])
            v3, w3 = vs + dt / 2 * a2, vf + dt / 2 * b2
            a3, b3 = acc(xs + dt / 2 * v2, v3, xf + dt / 2 * w2, w3, h[k + 1], fn[k + 1])
            v4, w4 = vs + dt * a3, vf + dt * b3
            a4, b4 = acc(xs + dt * v3, v4, xf + dt * w3, w4, h[k + 2], fn[k + 2])
            xs += dt / 6 * (vs + 2 * v2 + 2 * v3 + v4)
            xf += dt / 6 * (vf + 2 * w2 + 2 * w3 + w4)
            vs += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
            vf += dt / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
            k += 2
        pad.append(xs)
    return np.array(pad)


def contact():
    x = (np.arange(512) + 0.5) / 512
    saw = x * 16 % 1.0
    maps = {"sine": 0.5 + 0.5 * np.sin(2 * np.pi * 32 * x), "saw": saw,
            "cusps": np.abs(np.sin(np.pi * 24 * x)), "ridge": np.exp(-(((x * 8 % 1) - 0.5) / 0.08) ** 2)}
    for name, heights in maps.items():
        write_pgm(name + ".pgm", np.tile(heights, (4, 1)))
    image = lambda name, relief: (f'displacement = "{name}.pgm"\nwidth_m = 0.064\nheight_m = 0.14\n'
                                  f'relief_m = {relief}\nmicro_relief_m = 0.0')
    cases = [("sine 0.1", image("sine", 1e-4), 0.1, 0.5), ("sine 0.5", image("sine", 1e-4), 0.5, 0.5),
             ("sine light", image("sine", 4e-5), 0.3, 0.2), ("sawtooth", image("saw", 2e-4), 0.2, 0.5),
             ("cusps", image("cusps", 1e-4), 0.2, 0.8), ("ridge", image("ridge", 3e-4), 0.2, 0.5),
             ("noise 1", flat(1.0), 0.2, 0.5), ("noise 1.5", flat(2 / 3), 0.2, 0.5),
             ("noise 2", flat(1 / 3), 0.2, 0.5), ("noise 2.5", flat(0.0), 0.2, 0.5),
             ("noise 1 light", flat(1.0), 0.2, 0.1), ("noise heavy", flat(0.8, 8e-6), 0.1, 2.0)]
    width = {True: 0.14, False: 0.064}
    for integrator in ("exact-event", "semi-implicit-euler", "energy-conserving"):
        errors = []
        for name, surface, v, force in cases:
            rate, _, _, rows, _ = render("contact", surface,
                                         stroke(width["roughness" in surface], v, 0.35, force),
                                         ("--integrator", integrator), trace=True)
            pad = reintegrate(rows[:int(0.33 * rate)], rate)
            true = rows[:len(pad), 6]
            errors.append(np.sqrt(np.mean((pad - true)[2000:] ** 2)) / true[2000:].std())
        print(f"contact {integrator}: pad against Runge-Kutta, geometric mean "
              f"{np.exp(np.mean(np.log(errors))):.2e}, worst {max(errors):.2e} ({cases[int(np.argmax(errors))][0]})")


def trace_columns():
    """The body is linear: its answer to impulse_n_s, row by row, has to be the audio file."""
    rate, audio, haptic, rows, report = render("columns", flat(1.0), stroke(0.14, 0.15, 0.4), trace=True)
    n = len(audio)
    bus = np.zeros(n)
    first = int(round(rows[0, 0] * rate))
    bus[first:first + len(rows)] = rows[:, 10]
    y = np.zeros(n)
    t2 = (np.arange(n) + 2) / rate
    for m in MODES["modes"]:
        answer = m["amplitude"] / 0.01 / np.sinc(m["frequency_hz"] / rate) ** 4 * np.exp(-m["decay_per_s"] * t2) * np.sin(2 * np.pi * m["frequency_hz"] * t2)
        size = 2 * n
        y += np.fft.irfft(np.fft.rfft(bus, size) * np.fft.rfft(answer, size), size)[:n]
    # An impulse is spread over four samples and reaches the bus two late; the bank undoes both at each
    # mode's own frequency: gain 1 / sinc^4, phase two samples ahead.
    best = max(range(-4, 5), key=lambda s: np.dot(np.roll(y, s), audio))
    error = np.std(np.roll(y, best) - audio) / np.std(audio)
    print(f"trace: audio is the body's answer to impulse_n_s, shift {best} samples, "
          f"residual {100 * error:.2f} % rms; sum {bus.sum():.6e} N s")


def rates():
    for rate in (22050, 44100, 48000, 96000, 192000):
        _, audio, haptic, rows, _ = render("rates", flat(1.0), stroke(0.14, 0.1, 0.5), ("--rate", str(rate)), trace=True)
        print(f"rate {rate}: haptic rms {haptic.std():.4e} m, audio rms {20 * np.log10(audio.std()):.2f} dB, rows {len(rows)}")


def blocks():
    reference = None
    for block in (1, 2, 63, 64, 65, 256, 1000, 4096, 256):
        stem = os.path.join(FOLDER, "blocks")
        _, _, _, _, report = render("blocks", flat(1.0), stroke(0.14, 0.15, 0.5), ("--block", str(block), "--trace"))
        counts = [report[k] for k in ("events", "micro_collisions", "quarantined")]
        files = [open(f"{stem}.{kind}", "rb").read() for kind in ("audio.wav", "haptic.wav", "trace.csv")] + counts
        reference = reference or files
        assert files == reference, f"blocks of {block} differ"
    print("blocks: 1, 2, 63, 64, 65, 256, 1000, 4096 and a second run: identical bytes of WAVs and trace")


for measure in (gratings, path, out_and_back, trace_columns, blocks, rates, noise, contact):
    if len(sys.argv) < 4 or measure.__name__ in sys.argv[3:]:
        measure()
        sys.stdout.flush()
