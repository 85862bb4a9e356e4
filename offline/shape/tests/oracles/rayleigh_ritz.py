"""Natural frequencies of a free rectangular block by Rayleigh-Ritz with Legendre products, the method of resonant
ultrasound spectroscopy. Independent of finite elements: global polynomials instead of elements.

    python3 rayleigh_ritz.py LX LY LZ (m) E (Pa) NU RHO (kg/m3) [DEGREE=12] [COUNT=42]

Needs numpy and scipy. Prints COUNT frequencies in Hz, one a line.
"""
import sys
import numpy as np
from scipy.linalg import eigh
from numpy.polynomial import legendre


def one_axis(degree):
    """Integrals over -1..1 of P_m P_n, P_m' P_n and P_m' P_n' for normalised Legendre polynomials."""
    x, w = legendre.leggauss(degree + 2)
    norm = np.sqrt((2 * np.arange(degree + 1) + 1) / 2)
    p = np.array([legendre.legval(x, np.eye(degree + 1)[i]) for i in range(degree + 1)]) * norm[:, None]
    d = np.array([legendre.legval(x, legendre.legder(np.eye(degree + 1)[i])) for i in range(degree + 1)]) * norm[:, None]
    return (p * w) @ p.T, (d * w) @ p.T, (d * w) @ d.T


def frequencies_hz(sides, young, nu, rho, degree=12, count=42):
    lam, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    pp, dp, dd = one_axis(degree)
    index = np.array([(i, j, k) for i in range(degree + 1) for j in range(degree + 1 - i) for k in range(degree + 1 - i - j)])
    n = len(index)

    def term(a, b):
        """Integral of d(phi_m)/dx_a d(phi_n)/dx_b over the block, up to the Jacobian that mass has as well."""
        out = np.ones((n, n))
        for axis in range(3):
            m = index[:, axis]
            if axis == a and axis == b:
                part = dd
            elif axis == a:
                part = dp
            elif axis == b:
                part = dp.T
            else:
                part = pp
            out *= part[np.ix_(m, m)]
        return out * (2 / sides[a]) * (2 / sides[b])

    grads = [[term(a, b) for b in range(3)] for a in range(3)]
    k = np.zeros((3 * n, 3 * n))
    trace = grads[0][0] + grads[1][1] + grads[2][2]
    for i in range(3):
        for j in range(3):
            block = lam * grads[i][j] + mu * grads[j][i]
            if i == j:
                block = block + mu * trace
            k[i * n:(i + 1) * n, j * n:(j + 1) * n] = block
    # The normalised polynomials have unit mass.
    values = eigh(k / rho, eigvals_only=True, subset_by_index=[0, count + 5])
    return np.sqrt(np.maximum(values[6:], 0)) / (2 * np.pi)


if __name__ == "__main__":
    numbers = [float(x) for x in sys.argv[1:]]
    degree = int(numbers[6]) if len(numbers) > 6 else 12
    count = int(numbers[7]) if len(numbers) > 7 else 42
    for hz in frequencies_hz(numbers[:3], *numbers[3:6], degree, count):
        print(f"{hz:.2f}")
