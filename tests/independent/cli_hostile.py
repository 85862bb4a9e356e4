"""Hostile input to `asperity render`: every case ends with one `error:` line and exit status 1, or with
finite WAV files and counts in `--json`; never with a panic, a partial file or another exit status.

    pip install numpy scipy
    python cli_hostile.py PATH/TO/asperity FOLDER
"""

import json
import os
import struct
import subprocess
import sys
import time
import zlib

import numpy as np
from scipy.io import wavfile

PROGRAM, FOLDER = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
os.makedirs(FOLDER, exist_ok=True)
os.chdir(FOLDER)
MODES = {"format": "asperity.modes", "version": 1, "impulse_n_s": 0.01,
         "modes": [{"frequency_hz": 800.0, "decay_per_s": 14.0, "amplitude": 0.3, "phase_rad": 0.0}]}
SCENE = ('contacts = "log.jsonl"\ntail_s = 0.1\n[[body]]\nname = "b"\nmodes = "b.modes.json"\n'
         '[[surface]]\nname = "s"\nbody = "b"\nwidth_m = 0.14\nheight_m = 0.14\n')


def event(t, **fields):
    return json.dumps({"t": t, "event": "move", "contact": 1, "uv": [0.1 + t, 0.5],
                       "velocity_m_s": [0.1, 0.0], "normal_force_n": 0.6} | fields)


GOOD = ([event(0.0, event="begin", surface="s", actuator=0)] + [event(i / 60) for i in range(1, 30)]
        + ['{"t":0.5,"event":"end","contact":1}'])
failures, counts = [], [0, 0]


def case(name, scene=SCENE, log=GOOD, modes=None, files=None, limit_s=60.0):
    with open("case.toml", "w") as f:
        f.write(scene)
    with open("log.jsonl", "wb") as f:
        f.write(log if isinstance(log, bytes) else "\n".join(log).encode())
    with open("b.modes.json", "w") as f:
        f.write(json.dumps(modes or MODES) if not isinstance(modes, str) else modes)
    for path, content in (files or {}).items():
        with open(path, "wb") as f:
            f.write(content)
    for kind in ("audio.wav", "haptic.wav"):
        if os.path.exists("out." + kind):
            os.remove("out." + kind)
    began = time.time()
    try:
        done = subprocess.run([PROGRAM, "render", "case.toml", "-o", "out", "--json"], capture_output=True,
                              text=True, timeout=limit_s)
    except subprocess.TimeoutExpired:
        failures.append(f"{name}: still running after {limit_s} s")
        return
    took = time.time() - began
    lines = done.stderr.splitlines()
    if done.returncode == 1 and len(lines) == 1 and lines[0].startswith("error: ") and not done.stdout:
        if os.path.exists("out.audio.wav"):
            failures.append(f"{name}: refused, but wrote a file")
        counts[0] += 1
        print(f"{name:34} {took:5.1f} s  {lines[0][:150]}")
    elif done.returncode == 0 and not lines:
        report = json.loads(done.stdout)
        _, audio = wavfile.read("out.audio.wav")
        _, haptic = wavfile.read("out.haptic.wav")
        if not (np.isfinite(audio).all() and np.isfinite(haptic).all() and len(audio) == len(haptic)):
            failures.append(f"{name}: not finite")
        counts[1] += 1
        kept = ("events", "dropped", "quarantined", "stolen", "orphaned", "lapsed")
        print(f"{name:34} {took:5.1f} s  rendered,", {k: report[k] for k in kept if report[k]},
              "haptic peak %.3g" % max(report["haptic_peak"]))
    else:
        failures.append(f"{name}: exit {done.returncode}, stderr {done.stderr[:200]!r}")


def png(width, height, rows=b"", depth=8, colour=0):
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


MAP = SCENE + 'displacement = "map.png"\nrelief_m = 0.001\n'
case("good")
for bad in ("NaN", "Infinity", "-Infinity", "1e300", "-1e300", "1e400", '"x"', "null"):
    for field in ("normal_force_n", "t", "closing_m_s"):
        line = event(0.25)
        line = line[:-1] + f', "{field}": {bad}}}' if field == "closing_m_s" else \
            json.dumps({k: v for k, v in json.loads(line).items() if k != field})[:-1] + f', "{field}": {bad}}}'
        case(f"log {field} {bad}", log=GOOD[:15] + [line] + GOOD[15:])
    case(f"log uv {bad}", log=GOOD[:15] + [event(0.25).replace("[0.35,", f"[{bad},")] + GOOD[15:])
    case(f"scene width_m {bad}", scene=SCENE.replace("width_m = 0.14", f"width_m = {bad.replace('NaN', 'nan').replace('Infinity', 'inf')}"))
    case(f"modes frequency {bad}", modes=json.dumps(MODES).replace("800.0", bad))
case("time backwards", log=GOOD[:10] + [event(0.01)] + GOOD[10:])
case("time far ahead", log=GOOD + [event(1e9)])
case("unknown surface", log=[GOOD[0].replace('"s"', '"nowhere"')] + GOOD[1:])
case("unknown body", log=GOOD + ['{"t":0.6,"event":"impact","body":"x","speed_m_s":1,"mass_kg":0.01,"radius_m":0.01,"striker":"steel"}'])
case("unknown striker", log=GOOD + ['{"t":0.6,"event":"impact","body":"b","speed_m_s":1,"mass_kg":0.01,"radius_m":0.01,"striker":"jelly"}'])
case("unknown event", log=GOOD + ['{"t":0.6,"event":"dance","contact":1}'])
case("unknown actuator", log=[GOOD[0].replace('"actuator": 0', '"actuator": 9')] + GOOD[1:])
case("unknown scene key", scene=SCENE + "colour = 3\n")
case("unknown material", scene=SCENE.replace('name = "b"', 'name = "b"\nmaterial = "jelly"'))
case("not json", log=GOOD + ["not json"])
case("not utf-8", log=b"\xff\xfe\x00garbage")
case("empty log", log=b"")
case("empty scene", scene="")
case("scene not toml", scene="[[[")
case("growing modes", modes=json.dumps(MODES).replace("14.0", "-14.0"))
case("modes not json", modes="{")
case("moves nobody began", log=GOOD[1:])
case("end twice", log=GOOD + ['{"t":0.6,"event":"end","contact":1}'] * 3)
case("begin twice", log=[GOOD[0]] + GOOD)
case("missing image", scene=MAP.replace("map.png", "none.png"))
case("truncated image", scene=MAP, files={"map.png": png(64, 64, b"\0" + b"\x80" * 300)[:60]})
case("short image data", scene=MAP, files={"map.png": png(64, 64, b"\0" + b"\x80" * 300)})
case("enormous image", scene=MAP, files={"map.png": png(100000, 100000)})
case("decompression bomb", scene=MAP, files={"map.png": png(30000, 30000, b"\0" * 30001 * 3000)})
case("zero image", scene=MAP, files={"map.png": png(0, 0)})
case("text as image", scene=MAP, files={"map.png": b"hello"})
case("one texel", scene=MAP, files={"map.png": png(1, 1, b"\0\x80")})
case("relief 1e300", scene=MAP.replace("0.001", "1e300"), files={"map.png": png(1, 1, b"\0\x80")})
flood = [GOOD[0]] + [event(round(i * 1e-6, 9), uv=[0.1 + i * 1e-6, 0.5]) for i in range(1, 1000000)]
case("a million events in a second", log=flood, limit_s=120)
many = [event(0.0, event="begin", surface="s", actuator=0, contact=c, uv=[c / 1000, 0.5]) for c in range(1000)]
many += [event(i / 60, contact=c, uv=[c / 1000 + 0.7 * i / 60, 0.5]) for i in range(1, 20) for c in range(1000)]
case("a thousand contacts", log=many, limit_s=120)
wild = np.random.default_rng(7)
case("teleports at 1 kHz", log=[GOOD[0]] + [event(i / 1000, uv=list(wild.uniform(-1e6, 1e6, 2)), normal_force_n=float(wild.uniform(0, 1e4)),
     velocity_m_s=list(wild.uniform(-100, 100, 2)), closing_m_s=float(wild.uniform(0, 100))) for i in range(1, 500)])
print(f"{counts[0]} refused, {counts[1]} rendered, {len(failures)} failures")
for failure in failures:
    print("FAILURE", failure)
sys.exit(bool(failures))
