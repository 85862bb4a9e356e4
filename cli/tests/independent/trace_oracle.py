"""The heights of a trace, computed again without any code of this project and without any package.

    python3 trace_oracle.py TRACE.csv WIDTH_M HEIGHT_M solid MATERIAL SEED
    python3 trace_oracle.py TRACE.csv WIDTH_M HEIGHT_M lattice CELL.pgm RELIEF_M T1U T1V T2U T2V

Prints a JSON object: rows compared, largest difference and rms of the heights, metres.

solid: the solid-noise paper's sum of octaves in double precision, on the hash and the gradients that
the noise documents (12 edges of a cube, quintic blend), cut at a slant. lattice: the interpolating
periodic cubic spline of the cell, its coefficients from the cyclic tridiagonal system.
"""

import csv
import json
import math
import sys

M32 = 0xFFFFFFFF
# name: ((M, N, f, per), ...), A in metres; unit of length 10 mm, lacunarity 2.
MATERIALS = {
    "sandpaper": (((3, 1, 50, 1),), 1e-5),
    "granite": (((6, 2, 1, 0.5),), 1e-5),
    "rough_glass": (((3, 1, 4, 1),), 1e-5),
    "wood": (((1, 1, 40, 1), (2, 1, 1, 1)), 1e-5),
    "sand": (((2, 2, 10, 0.5),), 5e-5),
    "gravel": (((6, 2, 5, 0.5),), 5e-5),
    "pebbles": (((8, 2, 1, 0.5),), 1e-4),
}
TEXTURE_FACTOR_PER_M = 100.0


def pcg(x):
    state = (x * 747796405 + 2891336453) & M32
    word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) & M32
    return (word >> 22) ^ word


def gradient(lattice):
    edges = [(1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1)]
    index = ((((lattice * 0x27D4EB2F) & M32) >> 16) * 12) >> 16
    sign = 1 - 2 * (index & 1)
    return [sign * e for e in edges[index >> 1]]


def noise(seed, p):
    cell = [math.floor(x) for x in p]
    frac = [x - c for x, c in zip(p, cell)]
    blend = [t * t * t * (t * (6 * t - 15) + 10) for t in frac]
    total = 0.0
    for corner in range(8):
        far = [corner & 1, corner >> 1 & 1, corner >> 2]
        hashed = [((c + f) * k) & M32 for c, f, k in zip(cell, far, (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D))]
        g = gradient(hashed[0] ^ hashed[1] ^ hashed[2] ^ seed)
        weight = math.prod(b if f else 1 - b for b, f in zip(blend, far))
        total += weight * sum(gi * (t - f) for gi, t, f in zip(g, frac, far))
    return total


def solid(material, seed):
    modules, amplitude = MATERIALS[material]
    octaves = []
    for m, (magnitude, count, frequency, persistence) in enumerate(modules):
        for i in range(count):
            whole = seed + (m << 32) + i
            high = pcg(whole >> 32 & M32)
            octave_seed = pcg(whole & M32) ^ ((high << 16 | high >> 16) & M32)
            octaves.append((octave_seed, TEXTURE_FACTOR_PER_M * frequency * 2**i, magnitude * persistence**i))
    # The cut: turned by 0.62 about z, -0.49 about y and 0.37 about x.
    (sz, cz), (sy, cy), (sx, cx) = [(math.sin(a), math.cos(a)) for a in (0.62, -0.49, 0.37)]
    u_axis = (cz * cy, sz * cy, -sy)
    v_axis = (cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx)

    def height(x, y):
        point = [x * u + y * v for u, v in zip(u_axis, v_axis)]
        return amplitude * sum(a * noise(s, [f * p for p in point]) for s, f, a in octaves)

    return height


def read_pgm(path):
    """A binary 16-bit PGM as rows of numbers from 0 to 1."""
    data = open(path, "rb").read()
    magic, width, height, top, body = data.split(maxsplit=4) if data[:2] == b"P5" else sys.exit("not P5")
    width, height, top = int(width), int(height), int(top)
    # The body may begin with bytes that split() takes for white space: count from the end.
    body = data[len(data) - 2 * width * height:]
    values = [int.from_bytes(body[2 * i:2 * i + 2], "big") / top for i in range(width * height)]
    return [values[r * width:(r + 1) * width] for r in range(height)]


def coefficients(line):
    """c with (c[i-1] + 4 c[i] + c[i+1]) / 6 = line[i], cyclic, by iteration (it contracts by 1/2)."""
    c = list(line)
    n = len(c)
    for _ in range(200):
        c = [(6 * line[i] - c[i - 1] - c[(i + 1) % n]) / 4 for i in range(n)]
    return c


def lattice(cell, relief, t1, t2):
    rows = [coefficients(row) for row in read_pgm(cell)]
    columns = [coefficients(column) for column in zip(*rows)]
    width, height = len(columns), len(rows)
    area = t1[0] * t2[1] - t1[1] * t2[0]

    def weights(t, n):
        t = t * n - 0.5
        first = math.floor(t)
        f = t - first
        w = ((1 - f) ** 3, 4 - 6 * f * f + 3 * f**3, 4 - 6 * (1 - f) ** 2 + 3 * (1 - f) ** 3, f**3)
        return [((first - 1 + k) % n, w[k] / 6) for k in range(4)]

    def at(x, y):
        a, b = (t2[1] * x - t2[0] * y) / area, (t1[0] * y - t1[1] * x) / area
        across, down = weights(a, width), weights(b, height)
        return relief * sum(wx * wy * columns[i][j] for i, wx in across for j, wy in down)

    return at


def main():
    trace, width, height, kind, *rest = sys.argv[1:]
    width, height = float(width), float(height)
    if kind == "solid":
        oracle = solid(rest[0], int(rest[1]))
    else:
        t = [float(x) for x in rest[2:]]
        oracle = lattice(rest[0], float(rest[1]), t[:2], t[2:])
    worst, square, count = 0.0, 0.0, 0
    with open(trace) as file:
        for n, row in enumerate(csv.DictReader(file)):
            if n % 11 == 0:
                known = float(row["height_m"])
                worst = max(worst, abs(known - oracle(float(row["u"]) * width, float(row["v"]) * height)))
                square, count = square + known * known, count + 1
    print(json.dumps({"rows": count, "worst_m": worst, "rms_m": math.sqrt(square / max(count, 1))}))


main()
