"""The force law of solid noise in plain Python: seven materials along one stroke, at 5 kHz.

    python3 tests/independent/solid_force.py > tests/independent/solid_force.csv

Written from the equations (gradient noise of 2002 with the twelve edges of a cube, quintic blend; a lattice point is hashed by three
odd multipliers and one mixing multiplication), in double precision, without the crate. Columns: material, tick, position along the
stroke in m, force along u and v in N, for a tool that presses.
"""

import math

MASK = 0xFFFFFFFF
PRIME = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
EDGES = [e for pair in (
    ((1, 1, 0), (-1, -1, 0)), ((1, -1, 0), (-1, 1, 0)), ((1, 0, 1), (-1, 0, -1)),
    ((1, 0, -1), (-1, 0, 1)), ((0, 1, 1), (0, -1, -1)), ((0, 1, -1), (0, -1, 1))) for e in pair]


def pcg_hash(x):
    state = (x * 747796405 + 2891336453) & MASK
    word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) & MASK
    return (word >> 22) ^ word


def lattice_seed(seed):
    high = pcg_hash(seed >> 32)
    return pcg_hash(seed & MASK) ^ (((high << 16) | (high >> 16)) & MASK)


def edge(cell, seed):
    mixed = seed
    for index, prime in zip(cell, PRIME):
        mixed ^= (index * prime) & MASK
    return EDGES[((((mixed * 0x27D4EB2F) & MASK) >> 16) * 12) >> 16]


def noise(point, seed):
    base = [math.floor(p) for p in point]
    rest = [p - b for p, b in zip(point, base)]
    blend = [t * t * t * (t * (6 * t - 15) + 10) for t in rest]
    total = 0.0
    for corner in range(8):
        bits = [(corner >> axis) & 1 for axis in range(3)]
        weight = math.prod(s if bit else 1 - s for s, bit in zip(blend, bits))
        away = [r - bit for r, bit in zip(rest, bits)]
        total += weight * sum(g * d for g, d in zip(edge([b + bit for b, bit in zip(base, bits)], seed), away))
    return total


# Magnitude, octaves, frequency, persistence of each module; viscosity (N s/m).
MATERIALS = {
    "sandpaper": ([(3, 1, 50, 1)], 0),
    "granite": ([(6, 2, 1, 0.5)], 0),
    "rough_glass": ([(3, 1, 4, 1)], 0),
    "wood": ([(1, 1, 40, 1), (2, 1, 1, 1)], 0),
    "sand": ([(2, 2, 10, 0.5)], 0),
    "gravel": ([(6, 2, 5, 0.5)], 0),
    "pebbles": ([(8, 2, 1, 0.5)], 5),
}
TEXTURE_FACTOR, LIMIT_N, CAP_N, LACUNARITY, SEED = 100.0, 0.1, 1.0, 2.0, 7


def slanted(u, v):
    """The plane turned by 0.62, -0.49 and 0.37 rad about z, y and x."""
    point = (u, v, 0.0)
    def turn(p, angle, a, b):
        p = list(p)
        c, s = math.cos(angle), math.sin(angle)
        p[a], p[b] = c * p[a] - s * p[b], s * p[a] + c * p[b]
        return p
    for angle, a, b in ((0.37, 1, 2), (-0.49, 2, 0), (0.62, 0, 1)):
        point = turn(point, angle, a, b)
    return point


def force(material, u, v, velocity):
    modules, viscosity = MATERIALS[material]
    point = slanted(u, v)
    total = 0.0
    for module, (magnitude, octaves, frequency, persistence) in enumerate(modules):
        for octave in range(octaves):
            seed = lattice_seed((SEED + (module << 32) + octave) & (1 << 64) - 1)
            per_m = TEXTURE_FACTOR * frequency * LACUNARITY ** octave
            total += magnitude * persistence ** octave * noise([p * per_m for p in point], seed)
    texture = max(-CAP_N, min(CAP_N, LIMIT_N * total))
    return texture - viscosity * velocity[0], -viscosity * velocity[1]


def main():
    start, velocity, rate_hz = (0.0312, 0.0417), (0.12, -0.05), 5000
    print("material,tick,x_m,u_n,v_n")
    for material in MATERIALS:
        for tick in range(160):
            t = tick / rate_hz
            u, v = (s + w * t for s, w in zip(start, velocity))
            f = force(material, u, v, velocity)
            print(f"{material},{tick},{math.hypot(*velocity) * t!r},{f[0]!r},{f[1]!r}")


main()
