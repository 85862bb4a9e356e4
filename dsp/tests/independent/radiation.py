"""Power radiated by boxes and spheres by a boundary-element solution, in numpy.

Direct collocation with constant triangles, p/2 = int (p dG/dn - i w rho v G), overdetermined by interior points (CHIEF) against irregular
frequencies; near integrals by subdivision. Prints what is asserted in dsp/tests/radiation.rs: mean square pressure over all directions at 1 m for each pattern of
normal velocity. Shares nothing with the kernel but rho c.
"""

import sys
import numpy as np
from numpy.linalg import lstsq, norm

RHO, C = 1.2, 343.0


def box(size, cells):
    tris = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            nu, nv = cells[u], cells[v]
            for i in range(nu):
                for j in range(nv):
                    def corner(a, b):
                        p = np.zeros(3)
                        p[axis] = side * size[axis] / 2
                        p[u], p[v] = (a / nu - 0.5) * size[u], (b / nv - 0.5) * size[v]
                        return p
                    a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
                    quads = [(a, b, c), (a, c, d)] if side > 0 else [(a, c, b), (a, d, c)]
                    tris += quads
    return np.array(tris)


def sphere(radius, n):
    t = box((2, 2, 2), (n, n, n))
    t = np.tan(t * np.pi / 4)
    return radius * t / norm(t, axis=2, keepdims=True)


def geometry(tris):
    e = np.cross(tris[:, 1] - tris[:, 0], tris[:, 2] - tris[:, 0])
    area = norm(e, axis=1) / 2
    return tris.mean(1), e / norm(e, axis=1, keepdims=True), area


def subdivide(tris):
    a, b, c = tris[:, 0], tris[:, 1], tris[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    return np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])


def kernels(k, x, tris, levels):
    """Single and double layer of every triangle at the points x."""
    n0 = len(tris)
    own = np.arange(n0)
    for _ in range(levels):
        tris, own = subdivide(tris), np.tile(own, 4)
    y, n, area = geometry(tris)
    d = y[None] - x[:, None]
    r = norm(d, axis=2)
    g = np.exp(1j * k * r) / (4 * np.pi * r)
    dn = g * (1j * k - 1 / r) * (d * n[None]).sum(2) / r
    single, double = np.zeros((len(x), n0), complex), np.zeros((len(x), n0), complex)
    for j in range(4**levels):
        pick = slice(j * n0, (j + 1) * n0)
        single += g[:, pick] * area[pick]
        double += dn[:, pick] * area[pick]
    return single, double


def solve(tris, k, velocities):
    x, n, area = geometry(tris)
    single, double = kernels(k, x, tris, 1)
    # Own triangle: the flat double layer is zero; 1/r by the integral over the triangle, the rest by its middle.
    for i, t in enumerate(tris):
        total = 0.0
        for a, b in ((0, 1), (1, 2), (2, 0)):
            u, v, w = t[a] - x[i], t[b] - x[i], t[b] - t[a]
            h = norm(np.cross(u, v)) / norm(w)
            s0, s1 = np.dot(u, w) / norm(w), np.dot(v, w) / norm(w)
            total += h * (np.arcsinh(s1 / h) - np.arcsinh(s0 / h))
        single[i, i] = (total + 1j * k * area[i]) / (4 * np.pi)
        double[i, i] = 0
    rng = np.random.default_rng(1)
    inside = rng.uniform(-0.35, 0.35, (12, 3)) * np.ptp(x, axis=0)
    if norm(np.abs(norm(x, axis=1) - norm(x, axis=1).mean())) < 1e-2 * len(x):
        inside = inside * 0.7
    si, di = kernels(k, inside, tris, 0)
    # e^{-iwt}: p/2 = D p - i w rho S v on the surface, 0 = D p - i w rho S v inside.
    w = k * C
    a = np.concatenate([0.5 * np.eye(len(x)) - double, -di])
    b = -1j * w * RHO * np.concatenate([single, si]) @ np.array(velocities).T
    p = lstsq(a, b, rcond=None)[0]
    return p, area


def mean_squares(tris, k, velocities):
    p, area = solve(tris, k, velocities)
    watts = 0.5 * np.real(p * np.array(velocities).T * area[:, None]).sum(0)
    # |p| squared is the square of an amplitude: twice the mean over time.
    return 2 * RHO * C * watts / (4 * np.pi)


def patterns(tris):
    x, n, _ = geometry(tris)
    s = np.ptp(x, axis=0) / 2
    q = x / s
    top, bottom = n[:, 2] > 0.9, n[:, 2] < -0.9
    z = 1.0 * top - 1.0 * bottom
    return {
        "opposed pistons, out together": 1.0 * top + bottom,
        "opposed pistons, to and fro": z,
        "one piston": 1.0 * top,
        "bending": z * (q[:, 0] ** 2 - 1 / 3),
        "twisting": z * q[:, 0] * q[:, 1],
        "second bending": z * q[:, 0] * (q[:, 0] ** 2 - 0.6),
    }


if __name__ == "__main__":
    for name, size, cells in (("cube", (1, 1, 1), (7, 7, 7)), ("box", (1, 0.7, 0.45), (9, 7, 5)), ("slab", (1, 0.7, 0.15), (11, 8, 3))):
        tris = box(size, cells)
        area = geometry(tris)[2].sum()
        a = np.sqrt(area / 4 / np.pi)
        shapes = patterns(tris)
        for ka in (0.1, 0.25, 0.5, 1, 1.5, 2, 3, 4):
            for pattern, square in zip(shapes, mean_squares(tris, ka / a, list(shapes.values()))):
                print(f"{name},{pattern},{ka},{square:.6e}")
