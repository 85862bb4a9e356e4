#!/usr/bin/env python3
"""First modes of can, bottle, pan and barrel in src/model/stock/solved.rs against solid elements.

Needs numpy and scipy. The tables are thin shells (stock_shells.py); here the wall is a solid of revolution in three-dimensional elasticity,
harmonic by harmonic around, eight-node quadrilaterals in the section, nine Gauss points, mitred where walls meet. Prints the five lowest modes
of each table, the nearest of the solid with its number of nodal diameters, and how far they lie apart; before it Leissa's free disc.
"""
import pathlib
import re

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import eigsh

NU = 0.3
ARC = [(0.28 + 0.05 * (1 - (2 * q) ** 2), q) for q in np.linspace(-0.5, 0.5, 17)]
# Middle of the wall from the axis on, and its thickness.
SHAPES = {
    "can": ([(0, -0.5), (1 / 3, -0.5), (1 / 3, 0.5)], 1 / 60),
    "bottle": ([(0, -0.5), (0.14, -0.5), (0.14, 0.1), (0.05, 0.25), (0.045, 0.5)], 1 / 80),
    "pan": ([(0, -0.08), (0.4, -0.08), (0.5, 0.08)], 1 / 80),
    "barrel": ([(0, -0.5), *ARC, (0, 0.5)], 1 / 45),
}


def section(profile, wall, step):
    """Nodes, two stations an element along the profile and three across."""
    points = []
    for a, b in zip(profile, profile[1:]):
        a, b = np.array(a, float), np.array(b, float)
        halves = 2 * max(2, int(np.ceil(np.hypot(*(b - a)) / step)))
        points += [a + (b - a) * i / halves for i in range(halves)]
    points = np.array([*points, profile[-1]])
    along = np.diff(points, axis=0)
    along /= np.hypot(*along.T)[:, None]
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    before, after = np.vstack([normal[:1], normal]), np.vstack([normal, normal[-1:]])
    mitre = (before + after) / (1 + np.sum(before * after, axis=1))[:, None]
    nodes = points[:, None] + wall * np.array([-0.5, 0.0, 0.5])[None, :, None] * mitre[:, None]
    nodes[1::2] = (nodes[0:-1:2] + nodes[2::2]) / 2
    return nodes


def shape_functions(x, y):
    """The eight functions and their derivatives along x and y."""
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    value = [(1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4 for a, b in corners]
    value += [(1 - x * x) * (1 - y) / 2, (1 - y * y) * (1 + x) / 2, (1 - x * x) * (1 + y) / 2, (1 - y * y) * (1 - x) / 2]
    by_x = [a * (1 + b * y) * (2 * a * x + b * y) / 4 for a, b in corners]
    by_x += [-x * (1 - y), (1 - y * y) / 2, -x * (1 + y), -(1 - y * y) / 2]
    by_y = [b * (1 + a * x) * (2 * b * y + a * x) / 4 for a, b in corners]
    by_y += [-(1 - x * x) / 2, -y * (1 + x), (1 - x * x) / 2, -y * (1 - x)]
    return map(np.array, (value, by_x, by_y))


def element(nodes, n):
    """Stiffness and mass of one element, E = rho = 1."""
    lame, shear = NU / (1 + NU) / (1 - 2 * NU), 1 / 2 / (1 + NU)
    elastic = np.diag([2 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    stiffness, mass = np.zeros((24, 24)), np.zeros((24, 24))
    gauss = list(zip((-np.sqrt(0.6), 0, np.sqrt(0.6)), (5 / 9, 8 / 9, 5 / 9)))
    radial, around, axial = (slice(k, 24, 3) for k in range(3))
    for x, at_x in gauss:
        for y, at_y in gauss:
            value, by_x, by_y = shape_functions(x, y)
            jacobian = np.array([by_x @ nodes, by_y @ nodes])
            by_r, by_z = np.linalg.solve(jacobian, np.array([by_x, by_y]))
            r = value @ nodes[:, 0]
            strain = np.zeros((6, 24))
            strain[0, radial], strain[1, axial] = by_r, by_z
            strain[2, radial], strain[2, around] = value / r, n * value / r
            strain[3, radial], strain[3, axial] = by_z, by_r
            strain[4, radial], strain[4, around] = -n * value / r, by_r - value / r
            strain[5, around], strain[5, axial] = by_z, -n * value / r
            weight = abs(np.linalg.det(jacobian)) * at_x * at_y * r
            stiffness += weight * strain.T @ elastic @ strain
            for part in (radial, around, axial):
                mass[part, part] += weight * np.outer(value, value)
    return stiffness, mass


def solve(profile, wall, n, step, count=6):
    """The lowest omega sqrt(rho / E) of n nodal diameters."""
    nodes = section(profile, wall, step)
    rows, columns, stiffness, mass = [], [], [], []
    for e in range(0, len(nodes) - 1, 2):
        of = [(e, 0), (e + 2, 0), (e + 2, 2), (e, 2), (e + 1, 0), (e + 2, 1), (e + 1, 2), (e, 1)]
        places = np.array([3 * (3 * i + j) + k for i, j in of for k in range(3)])
        parts = element(np.array([nodes[i, j] for i, j in of]), n)
        rows.append(np.repeat(places, 24))
        columns.append(np.tile(places, 24))
        stiffness.append(parts[0].ravel())
        mass.append(parts[1].ravel())
    used, rows = np.unique(np.concatenate(rows), return_inverse=True)
    columns = np.unique(np.concatenate(columns), return_inverse=True)[1]
    both = [coo_matrix((np.concatenate(part), (rows, columns)), (len(used),) * 2).tocsc() for part in (stiffness, mass)]
    squares = eigsh(both[0], count + 3, both[1], sigma=-1e-3, which="LM", return_eigenvectors=False)
    return [omega for omega in np.sqrt(np.maximum(np.sort(squares), 0)) if omega > 2e-3][:count]


def table(name):
    """Frequencies of a table of the engine."""
    source = pathlib.Path(__file__).parents[2] / "src/model/stock/solved.rs"
    rows = source.read_text().split(f"const {name.upper()}:")[1].split("};")[0]
    return [float(number) for number in re.findall(r"\(([\d.]+), \[", rows)]


if __name__ == "__main__":
    wall, radius = 0.01, 1.0
    bending = wall**3 / 12 / (1 - NU**2)
    for n, leissa in ((2, 5.358), (0, 9.003), (3, 12.439)):
        omega = solve([(0, 0), (radius, 0)], wall, n, 0.01)[0]
        print(f"free disc, {n} diameters: {omega * np.sqrt(wall / bending) * radius**2:.3f} beside {leissa}")
    for name, (profile, wall) in SHAPES.items():
        solid = sorted((omega, n) for n in range(9) for omega in solve(profile, wall, n, 0.7 * wall))
        for shell, (omega, n) in zip(table(name)[:5], solid):
            print(f"{name:7} {shell:.5f}, solid {omega:.5f} ({n} diameters): {100 * (shell / omega - 1):+.1f} %")
