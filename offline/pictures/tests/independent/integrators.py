"""What other integrators reach on the inputs of examples/normal_map_table.rs.

Run: normal_map_table FOLDER … --write DIR; python3 integrators.py DIR

Frankot and Chellappa's projection in the Fourier domain with true derivatives and with central differences, and least squares on the
grid of differences by a cosine transform (the Poisson equation with free borders). No noise is taken off. Of every row: correlation, and
power in thirds of the spectrum of heights scaled to the true ones, as the example prints them.
"""
import glob, os, re, sys
import numpy as np
from scipy.fft import dctn, idctn

MOST = 8.0  # slopes above are an 8-bit map's noise


def slopes(red, green, blue, down):
    nx, ny, nz = 2 * red - 1, 2 * green - 1, 2 * blue - 1
    nz = np.maximum(nz, 1e-3)
    p, q = -nx / nz, (-ny if down else ny) / nz
    return np.clip(p, -MOST, MOST), np.clip(q, -MOST, MOST)


def fourier(p, q, central):
    h, w = p.shape
    wx = 2 * np.pi * np.fft.fftfreq(w)[None, :] + np.zeros((h, 1))
    wy = 2 * np.pi * np.fft.fftfreq(h)[:, None] + np.zeros((1, w))
    dx, dy = (np.sin(wx), np.sin(wy)) if central else (wx.copy(), wy.copy())
    dx[:, w // 2] = 0
    dy[h // 2, :] = 0
    square = dx**2 + dy**2
    square[square < (0.004 if central else 1e-12)] = np.inf
    p, q = p - p.mean(), q - q.mean()
    return np.fft.ifft2(-1j * (dx * np.fft.fft2(p) + dy * np.fft.fft2(q)) / square).real


def cosine(p, q):
    """Differences of neighbours are means of both slopes; div of them is the discrete Laplacian."""
    h, w = p.shape
    gx, gy = 0.5 * (p[:, 1:] + p[:, :-1]), 0.5 * (q[1:] + q[:-1])
    div = np.zeros((h, w))
    div[:, :-1] += gx
    div[:, 1:] -= gx
    div[:-1] += gy
    div[1:] -= gy
    cx, cy = np.cos(np.pi * np.arange(w) / w)[None, :], np.cos(np.pi * np.arange(h) / h)[:, None]
    laplace = 2 * cx + 2 * cy - 4
    laplace[0, 0] = np.inf
    return idctn(dctn(div, norm="ortho") / laplace, norm="ortho")


def without_slant(z):
    h, w = z.shape
    x, y = np.arange(w) - (w - 1) / 2, np.arange(h)[:, None] - (h - 1) / 2
    z = z - z.mean()
    return z - x * (z * x).sum() / ((x * x).sum() * h) - y * (z * y).sum() / ((y * y).sum() * w)


def thirds(z, window):
    h, w = z.shape
    if window:
        hann = lambda n: 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(n) + 0.5) / n)
        z = without_slant(z) * hann(h)[:, None] * hann(w)[None, :]
    power = abs(np.fft.fft2(z)) ** 2
    power[0, 0] = 0
    omega = np.hypot(2 * np.pi * np.fft.fftfreq(h)[:, None], 2 * np.pi * np.fft.fftfreq(w)[None, :])
    third = np.minimum((3 * omega / np.pi).astype(int), 2)
    return np.bincount(third.ravel(), power.ravel(), 3)


def told(z, truth, open_borders):
    if open_borders:
        z, truth = without_slant(z), without_slant(truth)
    z, truth = z - z.mean(), truth - truth.mean()
    r = (z * truth).sum() / np.sqrt((z * z).sum() * (truth * truth).sum())
    scaled = z * (truth * truth).sum() / (z * truth).sum()
    return r, thirds(scaled, open_borders) / thirds(truth, open_borders)


for path in sorted(glob.glob(os.path.join(sys.argv[1], "*.f32"))):
    name, variant, w, h = re.match(r"(.*?)__(.*)__(\d+)x(\d+)\.f32", os.path.basename(path)).groups()
    red, green, blue, truth = np.fromfile(path, "<f4").astype(float).reshape(4, int(h), int(w))
    open_borders = variant.startswith("cut")
    row = f"{name:40} {variant:18}"
    pairs = [slopes(red, green, blue, down) for down in (False, True)]
    found = {}
    for label, integrate in [
        ("exact", lambda p, q: fourier(p, q, False)),
        ("central", lambda p, q: fourier(p, q, True)),
        ("cosine", cosine),
    ]:
        found[label] = max((told(integrate(p, q), truth, open_borders) for p, q in pairs), key=lambda t: t[0])
    for label, (r, power) in found.items():
        row += f"  {label} {r:.4f} " + " ".join(f"{x:.2f}" for x in power)
    print(row, flush=True)
