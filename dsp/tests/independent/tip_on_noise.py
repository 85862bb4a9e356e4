"""What a sphere takes off a self-affine surface, octave by octave: an exact (parabolic, separable) dilation in numpy.

    python tip_on_noise.py      prints the figures of `a_sphere_takes_off_what_its_dilation_takes_off`

4096 x 1024 points of 10 um; PSD of a line (q^2 + (1/4 mm)^2)^(-alpha/2), octave about 1 mm of 11 um * 10^(R - 1).
"""
import numpy as np

DX_M = 10e-6


def surface(seed, roughness, shape=(4096, 1024)):
    alpha = 2.5 - 1.5 * roughness
    rng = np.random.default_rng(seed)
    q = np.hypot(np.fft.fftfreq(shape[0], DX_M)[:, None], np.fft.rfftfreq(shape[1], DX_M)[None, :])
    amplitude = (q**2 + (1 / 4e-3) ** 2) ** (-(alpha + 1) / 4)
    amplitude[0, 0] = 0
    amplitude[q > 1 / 30e-6] = 0
    h = np.fft.irfft2(amplitude * (rng.normal(size=q.shape) + 1j * rng.normal(size=q.shape)), shape)
    return h * 11e-6 * 10 ** (roughness - 1) / octaves(h)[3]


def along_one_axis(h, radius_m):
    reach = int(np.sqrt(2 * radius_m * np.ptp(h)) / DX_M) + 1
    out = h.copy()
    for k in range(1, reach + 1):
        below = (k * DX_M) ** 2 / (2 * radius_m)
        np.maximum(out, np.maximum(np.roll(h, k, 0), np.roll(h, -k, 0)) - below, out=out)
    return out


def dilated(h, radius_m):
    return along_one_axis(along_one_axis(h, radius_m).T, radius_m).T


def octaves(h):
    power = (np.abs(np.fft.rfft(h - h.mean(), axis=0)) ** 2).mean(1)
    q = np.fft.rfftfreq(h.shape[0], DX_M)
    centres = 1 / (8e-3 * 0.5 ** np.arange(8))
    return np.array([np.sqrt(2 * power[(q >= c / 2**0.5) & (q < c * 2**0.5)].sum()) / len(h) for c in centres])


for radius_m in (1.6e-3, 0.4e-3, 5e-3):
    for roughness in (0.1, 0.5, 1.0):
        h = surface(3, roughness)
        taken = 20 * np.log10(octaves(dilated(h, radius_m)) / octaves(h))
        print(radius_m, roughness, " ".join(f"{x:.1f}" for x in taken))
