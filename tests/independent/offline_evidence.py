"""What `asperity fit` and `asperity texture from-normals` find, measured without any code of this project.

    pip install numpy scipy
    python offline_evidence.py PATH/TO/asperity FOLDER [impacts|noise|normals] [SEED]

impacts   damped sinusoids made here (10, 30, 100 modes; 50 Hz-16 kHz, T60 30 ms-4 s, 50 dB of levels, a pair 1 Hz
          apart for every ten modes), a lead-in, white noise at 60, 40 and 20 dB; found, missed, invented modes, errors over
          the joint Cramer-Rao bound of numpy
noise     files in which nothing rings: white, 1/f to 1/f³, a random walk, one-pole, band-passed, low- and high-passed noise
normals   8-bit normal maps of surfaces made here, their slopes taken exactly, by central differences and by Sobel

What it printed (impacts: seeds 61 and 71 to 76; noise: 71 and 74; normals: 1 to 8):

    impacts   3 of 2137 modes missed, 4 invented; median f/bound and d/bound 1.01 (seeds 61, 71, 72; single signals of ten modes
              up to 2.2); 96.4-100 % of each signal's modes within 4 bounds
    noise     seventeen colours, 24 draws each of 0.5, 1 and 2 s, float and 16 bits: no mode in any, but for six modes in one
              draw of 1/f^3 noise to 5 Hz
    normals   0.04-0.47 % however the slopes were taken, told nothing, but for waves of one length (11-25 pixels): 0.6-10 %,
              told 0.01-0.21 %: such a map does not tell which differences made it
"""

import json
import os
import struct
import subprocess
import sys
import zlib

import numpy as np
from scipy.io import wavfile
from scipy.signal import lfilter

PROGRAM, FOLDER = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
PARTS = sys.argv[3:4] or ["impacts", "noise", "normals"]
SEED = int(sys.argv[4]) if len(sys.argv) > 4 else 1
RATE = 44100
os.makedirs(FOLDER, exist_ok=True)


def run(*arguments):
    made = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, cwd=FOLDER)
    if made.returncode:
        raise SystemExit(f"{arguments}: {made.stderr}")
    return json.loads(made.stdout)


# ---------------------------------------------------------------------------------------------- impacts

def modes_of(count, rng):
    """Rows of frequency (Hz), decay (1/s), amplitude, phase."""
    pairs = count // 10
    singles = count - pairs
    f = np.exp(rng.uniform(np.log(50.0), np.log(16000.0), singles))
    f = np.concatenate([f, rng.choice(f, pairs, replace=False) + 1.0])
    decay = 6.908 / np.exp(rng.uniform(np.log(0.03), np.log(4.0), count))
    amplitude = 10.0 ** (-rng.uniform(0.0, 50.0, count) / 20.0)
    return np.stack([f, decay, amplitude, rng.uniform(-np.pi, np.pi, count)], axis=1)


def columns_of(modes, t):
    for f, d, a, p in modes:
        e, w = np.exp(-d * t), 2 * np.pi * f * t + p
        s, c = e * np.sin(w), e * np.cos(w)
        yield 2 * np.pi * t * a * c, -t * a * s, s, a * c


def bound_of(modes, t, noise):
    """Standard deviations of frequency, decay and amplitude."""
    jacobian = np.concatenate([np.stack(four, axis=1) for four in columns_of(modes, t)], axis=1)
    scale = 1 / np.linalg.norm(jacobian, axis=0)
    fisher = (jacobian * scale).T @ (jacobian * scale)
    variance = np.diag(np.linalg.pinv(fisher, rcond=1e-14, hermitian=True)) * scale**2
    std = noise * np.sqrt(np.abs(variance)).reshape(-1, 4)
    return std[:, 0], std[:, 1], std[:, 2]


def fitted(name, samples, rounded=False):
    samples = 0.9 * samples / np.max(np.abs(samples))
    samples = np.round(32767 * samples).astype(np.int16) if rounded else samples.astype(np.float32)
    wavfile.write(os.path.join(FOLDER, name + ".wav"), RATE, samples)
    report = run("fit", name + ".wav", "-o", name + ".modes.json", "--json")
    with open(os.path.join(FOLDER, name + ".modes.json")) as file:
        found = json.load(file)["modes"]
    return report, np.array([[m["frequency_hz"], m["decay_per_s"]] for m in found]).reshape(-1, 2)


def impacts():
    rng = np.random.default_rng(SEED)
    print("modes  snr   told  missed  invented   f/bound  d/bound  within 4   seconds")
    for count in (10, 30, 100):
        for snr in (60, 40, 20):
            modes = modes_of(count, rng)
            t = np.arange(2 * RATE) / RATE
            clean = np.zeros_like(t)
            for (f, d, a, p), four in zip(modes, columns_of(modes, t)):
                clean += a * four[2]
            noise = np.sqrt(np.mean(clean**2)) * 10 ** (-snr / 20)
            lead = int(0.2 * RATE)
            samples = noise * rng.standard_normal(lead + len(clean))
            samples[lead:] += clean
            report, found = fitted(f"impact{count}_{snr}", samples)
            df, dd, da = bound_of(modes, t, noise)
            told = (da < 0.15 * modes[:, 2]) & (dd < 0.3 * modes[:, 1])
            told &= df < 0.15 * modes[:, 1] / (2 * np.pi) + 0.05
            pairs = []
            for i, mode in enumerate(modes):
                width = mode[1] / (2 * np.pi)
                near = min(max(8 * df[i], 0.05), 0.5 * width + 8 * df[i], 2 * width + 0.5)
                for j, other in enumerate(found):
                    gap = abs(other[0] - mode[0])
                    if gap < near:
                        pairs.append((not told[i], gap / df[i] + min(abs(other[1] - mode[1]) / dd[i], 20), i, j))
            of, taken = {}, set()
            for _, _, i, j in sorted(pairs):
                if i not in of and j not in taken:
                    of[i] = j
                    taken.add(j)
            met = [i for i in range(count) if told[i] and i in of]
            rf = np.array([(found[of[i]][0] - modes[i, 0]) / df[i] for i in met])
            rd = np.array([(found[of[i]][1] - modes[i, 1]) / dd[i] for i in met])
            robust = lambda x: np.median(np.abs(x)) / 0.6745
            within = np.mean((np.abs(rf) < 4) & (np.abs(rd) < 4))
            print(f"{count:5} {snr:4} {told.sum():6} {told.sum() - len(met):7} {len(found) - len(taken):9}"
                  f" {robust(rf):9.2f} {robust(rd):8.2f} {100 * within:8.1f} % {report['seconds']:8.2f}", flush=True)


# ------------------------------------------------------------------------------------------------ noise

COLOURS = ("white", "pink", "pole0.25", "pole0.1", "pole0.02", "pole0.005", "pole0.002", "power2to20", "power2to5",
           "power3to20", "power3to5", "walk", "hump1", "hump3", "low2", "low4", "high4")


def coloured(kind, count, rng):
    """One-pole low-passes run from rest; the others are shaped over twice the length, and their middle is cut out."""
    if kind.startswith("pole"):
        pole = float(kind[4:])
        return lfilter([pole], [1, pole - 1], rng.standard_normal(count))
    if kind == "walk":
        return np.cumsum(rng.standard_normal(count))
    f = np.maximum(np.fft.rfftfreq(2 * count, 1 / RATE), 1e-3)
    x = f / (60 * 100 ** rng.uniform())  # of a corner between 60 Hz and 6 kHz
    if kind.startswith("power"):
        power, corner = map(float, kind[5:].split("to"))
        gain = np.maximum(f, corner) ** (-power / 2)
    else:
        gain = {"white": lambda: np.ones_like(f), "pink": lambda: np.maximum(f, 20) ** -0.5,
                "hump1": lambda: x / np.hypot(1 - x**2, x), "hump3": lambda: x / np.hypot(1 - x**2, x / 3),
                "low2": lambda: (1 + x**4) ** -0.5, "low4": lambda: (1 + x**8) ** -0.5,
                "high4": lambda: x**4 * (1 + x**8) ** -0.5}[kind]()
    return np.fft.irfft(np.fft.rfft(rng.standard_normal(2 * count)) * gain, 2 * count)[count // 2 : count // 2 + count]


def noise():
    rng = np.random.default_rng(SEED)
    for kind in COLOURS:
        counts = []
        for seconds in (0.5, 1, 2):
            counts += [len(fitted("noise", coloured(kind, int(seconds * RATE), rng), draw % 2)[1]) for draw in range(8)]
        print(f"{kind:10} of {len(counts)} draws of 0.5, 1 and 2 s, float and 16 bits, {sum(n > 0 for n in counts)} have"
              f" modes: {[n for n in counts if n]}", flush=True)


# ---------------------------------------------------------------------------------------------- normals

def write_png(path, pixels):
    """An 8-bit RGB picture."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunk = lambda name, data: (struct.pack(">I", len(data)) + name + data
                                + struct.pack(">I", zlib.crc32(name + data)))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def read_png16(path):
    """A 16-bit grey picture."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed, size = 8, b"", None
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if name == b"IHDR":
            size = struct.unpack(">IIBB", body[:10])
        if name == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour = size
    assert (depth, colour) == (16, 0), size
    raw, stride = zlib.decompress(packed), 2 * width
    above, out = np.zeros(stride, np.uint8), []
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = np.frombuffer(raw, np.uint8, stride, y * (stride + 1) + 1).astype(int).copy()
        for x in range(stride):
            a = row[x - 2] if x >= 2 else 0
            b, c = int(above[x]), int(above[x - 2]) if x >= 2 else 0
            if kind == 1:
                row[x] += a
            elif kind == 2:
                row[x] += b
            elif kind == 3:
                row[x] += (a + b) // 2
            elif kind == 4:
                p = a + b - c
                row[x] += min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[x] &= 255
        above = row.astype(np.uint8)
        out.append(above.view(">u2").astype(float))
    return np.array(out)


def surface(kind, size, rng):
    """Heights in pixels, tiling, rms slope about 0.35."""
    fx, fy = np.meshgrid(np.fft.fftfreq(size), np.fft.fftfreq(size))
    k = np.hypot(fx, fy)
    y, x = np.mgrid[0:size, 0:size] / size * 2 * np.pi
    if kind.startswith("brownian"):
        k[0, 0] = 1
        h = np.fft.ifft2(np.fft.fft2(rng.standard_normal((size, size))) * k ** -(float(kind[8:]) + 1)
                         * (k < 0.3) * (k > 0.5 / size)).real
    elif kind == "hills":
        h = np.zeros((size, size))
        for _ in range(40):
            cx, cy, r = rng.uniform(0, 2 * np.pi, 2).tolist() + [rng.uniform(0.1, 0.4)]
            h += rng.uniform(-1, 1) * np.exp((np.cos(x - cx) + np.cos(y - cy) - 2) / r**2)
    elif kind == "bumps":
        n = int(rng.integers(10, 24))
        h = np.sin(n * x) * np.sin(n * y)
    elif kind == "ridges":
        n = int(rng.integers(8, 20))
        h = np.exp(np.cos(n * x + 3 * y) * 1.5) + 0.3 * np.cos(2 * y + x)
    else:
        h = sum(rng.uniform(0.3, 1) * np.cos(int(rng.integers(1, 30)) * x + int(rng.integers(-30, 30)) * y
                                             + rng.uniform(0, 6)) for _ in range(8))
    gx = np.fft.ifft2(2j * np.pi * fx * np.fft.fft2(h)).real
    gy = np.fft.ifft2(2j * np.pi * fy * np.fft.fft2(h)).real
    return h * (0.35 / np.sqrt(np.mean(gx**2 + gy**2)))


def slopes(h, how):
    if how == "exact":
        fx, fy = np.meshgrid(np.fft.fftfreq(h.shape[1]), np.fft.fftfreq(h.shape[0]))
        return [np.fft.ifft2(2j * np.pi * f * np.fft.fft2(h)).real for f in (fx, fy)]
    central = lambda a, axis: (np.roll(a, -1, axis) - np.roll(a, 1, axis)) / 2
    if how == "central":
        return central(h, 1), central(h, 0)
    smooth = lambda a, axis: (np.roll(a, -1, axis) + 2 * a + np.roll(a, 1, axis)) / 4
    return smooth(central(h, 1), 0), smooth(central(h, 0), 1)


def normals():
    rng = np.random.default_rng(SEED)
    print("relative rmse in %, told nothing (and told how the slopes were taken)")
    for kind in ("brownian0.3", "brownian0.7", "hills", "bumps", "ridges", "waves"):
        line = f"{kind:12}"
        for how in ("exact", "central", "sobel"):
            h = surface(kind, 256, rng)
            p, q = slopes(h, how)
            n = np.stack([-p, q, np.ones_like(p)], axis=2)  # green points up the image
            n /= np.linalg.norm(n, axis=2, keepdims=True)
            write_png(os.path.join(FOLDER, "normal.png"), np.round((n + 1) * 127.5).astype(np.uint8))
            errors = []
            for options in ([], ["--derivative", how]):
                report = run("texture", "from-normals", "normal.png", "-o", "height.png", "--json", *options)
                made = read_png16(os.path.join(FOLDER, "height.png")) / 65535 * report["relief_per_px"]
                made, h = made - made.mean(), h - h.mean()
                errors.append(100 * np.sqrt(np.mean((made - h) ** 2) / np.mean(h**2)))
            line += f"   {how} {errors[0]:.2f} ({errors[1]:.2f})"
        print(line, flush=True)


for part in PARTS:
    print(f"== {part}")
    {"impacts": impacts, "noise": noise, "normals": normals}[part]()
