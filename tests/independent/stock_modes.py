#!/usr/bin/env python3
"""Tables of src/model/stock/tables.rs, and the figures of its tests: modes of free bodies by the Rayleigh-Ritz method and by closed forms.

Needs numpy and scipy; prints Rust constants. Every mode shape is normalised to a mean square of 1 over the body, so that a unit impulse at
a place sets the mode going with the velocity phi(place) / mass.

plate  free square Kirchhoff plate, nu = 0.3: Ritz with Legendre products. Leissa, J. Sound Vib. 31 (1973) 257: 13.489, 19.789, 24.432, 35.024.
disc   free circular plate, nu = 0.3: roots of the Bessel determinant (Leissa, NASA SP-160, 1969, eq. 2.14).
block  free cuboid 4 : 2 : 1, nu = 0.3, 3-D elasticity: Ritz with Legendre products (Visscher, Migliori, Bell, Reinert, JASA 90, 1991, 2154).
bowl   hemispherical shell, bending without extension (Rayleigh, Theory of Sound, 2nd ed. vol. 1, section 235): 1 : 2.8102 : 5.4316.
bar    Timoshenko's free bar, thickness 1/30 of the length, by its frequency equation (Huang 1961), for the test of the closed form.
"""
import numpy as np
from numpy.polynomial import legendre as L
from scipy.integrate import quad
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import iv, ivp, jv, jvp


def gram(n, a, b):
    """Integrals over -1..1 of the a-th times the b-th derivative of the Legendre polynomials up to degree n - 1."""
    x, w = L.leggauss(n + 2)
    def values(d):
        return np.array([L.legval(x, L.legder(np.eye(n)[i], d) if d else np.eye(n)[i]) for i in range(n)])
    return (values(a) * w) @ values(b).T


def row(frequency, shapes):
    return "    (%.6g, [%s])," % (frequency, ", ".join("%.4f" % s for s in shapes))


def plate(nu=0.3, n=24, modes=64, places=((0.9, 0.84), (0.0, 0.0), (0.5, 0.3))):
    """omega a^2 sqrt(rho h / D) for side a; places from the centre, in half sides."""
    g = {(a, b): gram(n, a, b) for a, b in [(0, 0), (1, 1), (2, 2), (2, 0), (0, 2)]}
    k = 16 * (np.kron(g[2, 2], g[0, 0]) + np.kron(g[0, 0], g[2, 2])
              + nu * (np.kron(g[2, 0], g[0, 2]) + np.kron(g[0, 2], g[2, 0]))
              + 2 * (1 - nu) * np.kron(g[1, 1], g[1, 1]))
    m = np.kron(g[0, 0], g[0, 0])
    value, vector = eigh(k, m)
    at = [np.kron([L.legval(u, np.eye(n)[i]) for i in range(n)], [L.legval(v, np.eye(n)[i]) for i in range(n)])
          for u, v in places]
    rows = [i for i in range(len(value)) if value[i] > 1.0][:modes]
    # The mean square over the area 4 is 1.
    return [(np.sqrt(value[i]), [2 * a @ vector[:, i] for a in at]) for i in rows]


def disc(nu=0.3, highest=420.0, places=(0.97, 0.0, 0.5)):
    """omega R^2 sqrt(rho h / D) for radius R; places in radii; a degenerate pair has its antinode at the place."""
    found = []
    for n in range(0, 22):
        def edge(f, df, d2f, lam):  # the two edge conditions of a Bessel function of lam r at r = 1
            laplace = lam**2 * d2f + lam * df - n * n * f
            moment = lam**2 * d2f + nu * (lam * df - n * n * f)
            return moment, laplace
        def conditions(lam):
            j = [jv(n, lam), jvp(n, lam), jvp(n, lam, 2)]
            i = [iv(n, lam), ivp(n, lam), ivp(n, lam, 2)]
            mj, _ = edge(*j, lam)
            mi, _ = edge(*i, lam)
            # Kirchhoff's edge force: d(laplacian)/dr + (1 - nu) n^2 (f - f') with laplacian J = -lam^2 J, I = +lam^2 I.
            vj = -lam**3 * j[1] + (1 - nu) * n * n * (j[0] - lam * j[1])
            vi = lam**3 * i[1] + (1 - nu) * n * n * (i[0] - lam * i[1])
            return mj, mi, vj, vi
        def determinant(lam):
            mj, mi, vj, vi = conditions(lam)
            return (mj * vi - mi * vj) / iv(n, lam)**1
        grid = np.linspace(0.6, np.sqrt(highest), 3000)
        values = [determinant(x) for x in grid]
        for a, b, fa, fb in zip(grid, grid[1:], values, values[1:]):
            if fa * fb < 0:
                lam = brentq(determinant, a, b, xtol=1e-12)
                mj, mi, vj, vi = conditions(lam)
                c = -mj / mi
                w = lambda r: jv(n, lam * r) + c * iv(n, lam * r)
                mean = 2 * quad(lambda r: w(r)**2 * r, 0, 1)[0] * (0.5 if n else 1.0)
                found.append((lam**2, [w(r) / np.sqrt(mean) for r in places], n))
    found.sort(key=lambda f: f[0])
    return found


def block(nu=0.3, sides=(1.0, 0.5, 0.25), degree=14, modes=48, places=((0.94, 0.9), (0.0, 0.0), (0.55, 0.3))):
    """omega L sqrt(rho / E) for the longest side L; struck on its largest face, along the normal."""
    half = np.array(sides) / 2
    lame, shear = nu / ((1 + nu) * (1 - 2 * nu)), 1 / (2 * (1 + nu))
    basis = [(i, j, k) for i in range(degree + 1) for j in range(degree + 1 - i) for k in range(degree + 1 - i - j)]
    g = {(a, b): gram(degree + 1, a, b) for a in (0, 1) for b in (0, 1)}
    index = np.array(basis)
    def integral(a, b):
        """Integral of d_a f d_b g; a, b name the axis that is derived."""
        out = np.ones((len(basis), len(basis))) * half.prod()
        for axis in range(3):
            da, db = int(a == axis), int(b == axis)
            out *= g[da, db][np.ix_(index[:, axis], index[:, axis])] / half[axis] ** (da + db)
        return out
    n = len(basis)
    d = [[integral(a, b) for b in range(3)] for a in range(3)]
    mass = integral(None, None)
    stiff = np.zeros((3 * n, 3 * n))
    for p in range(3):
        for q in range(3):
            part = lame * d[p][q] + shear * d[q][p]
            if p == q:
                part = part + shear * (d[0][0] + d[1][1] + d[2][2])
            stiff[p * n:(p + 1) * n, q * n:(q + 1) * n] = part
    full = np.kron(np.eye(3), mass)
    value, vector = eigh(stiff, full)
    volume = 8 * half.prod()
    at = []
    for u, v in places:
        f = np.array([L.legval(u, np.eye(degree + 1)[i]) * L.legval(v, np.eye(degree + 1)[j]) * 1.0 for i, j, _ in basis])
        at.append(np.concatenate([np.zeros(2 * n), f]))
    rows = [i for i in range(len(value)) if value[i] > 1e-6][:modes]
    return [(np.sqrt(value[i]), [np.sqrt(volume) * a @ vector[:, i] for a in at]) for i in rows]


def bowl(last=14):
    """omega a^2 sqrt(rho h / (D (1 - nu))) for radius a, and the normal motion at the rim."""
    out = []
    for s in range(2, last + 1):
        tan = lambda t: np.tan(t / 2) ** (2 * s)
        bend = quad(lambda t: tan(t) / np.sin(t) ** 3, 1e-9, np.pi / 2)[0]
        # With u = v = sin t, w = s + cos t times tan^s(t / 2).
        move = quad(lambda t: tan(t) * ((s + np.cos(t)) ** 2 + 2 * np.sin(t) ** 2) * np.sin(t), 1e-9, np.pi / 2)[0]
        # Area 2 pi, cos^2 averages 1/2.
        out.append((np.sqrt(4 * (s**3 - s) ** 2 * bend / move), [s / np.sqrt(move / 2)]))
    return out


def timoshenko(slenderness=30.0, nu=0.3, kappa=5 / 6, modes=10):
    """omega L^2 sqrt(rho A / (E I)) of a free bar of length slenderness x thickness."""
    r2 = 1 / 12 / slenderness**2
    s2 = r2 * 2 * (1 + nu) / kappa
    def equation(b):
        b2 = b * b
        root = np.sqrt((r2 - s2) ** 2 + 4 / b2)
        alpha, beta = np.sqrt(max((-(r2 + s2) + root) / 2, 0.0)), np.sqrt((r2 + s2 + root) / 2)
        x, y = b * alpha, b * beta
        return (2 - 2 * np.cosh(x) * np.cos(y)
                + b / np.sqrt(1 - b2 * r2 * s2) * (b2 * r2 * (r2 - s2) ** 2 + (3 * r2 - s2)) * np.sinh(x) * np.sin(y)) / np.cosh(x)
    grid = np.linspace(5, 1000, 40000)
    values = [equation(b) for b in grid]
    return [brentq(equation, a, b) for a, b, fa, fb in zip(grid, grid[1:], values, values[1:]) if fa * fb < 0][:modes]


if __name__ == "__main__":
    for name, rows in [("PLATE", plate()), ("DISC", disc()), ("BLOCK", block()), ("BOWL", bowl())]:
        print(f"pub(super) const {name}: [(f64, [f64; {len(rows[0][1])}]); {len(rows)}] = [")
        print("\n".join(row(r[0], r[1]) for r in rows))
        print("];")
    print("// bar, Timoshenko:", ", ".join("%.5g" % b for b in timoshenko()))
    ratios = [f for f, _ in bowl()]
    print("// bowl ratios:", ", ".join("%.4f" % (f / ratios[0]) for f in ratios[:4]))
    print("// plate, disc, first:", ["%.3f" % p[0] for p in plate()[:6]], [("%.3f" % p[0], p[2]) for p in disc()[:8]])
    print("// block of higher degree:", ["%.5f" % p[0] for p in block(degree=10)[:8]], ["%.5f" % p[0] for p in block()[:8]])
