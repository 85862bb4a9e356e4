"""How far the levels of photographs can be trusted: strokes over what `from-photo` makes of a material's colour map against strokes over the
heights of its own normal map.

Run: python3 photographs.py ASPERITY WORK SET …, sets being folders that hold color.* and normal.*; needs numpy, scipy and Pillow.

A texel is 62.5 µm: waves felt at 250–400 Hz and 0.1 m/s are 4–6.4 texels long, so that both maps hold them. The normal map's surface has no micro-relief of
its own. Plain contrast between 1 and 8 texels is the baseline.
"""
import glob, json, os, re, subprocess, sys
import numpy as np
from PIL import Image
from scipy.io import wavfile
from scipy.signal import welch
from scipy.stats import spearmanr

TEXEL_M = 62.5e-6
FULL_SCALE_M = 0.02
BANDS = [(30, 120), (120, 250), (250, 400)]
PROGRAM, WORK = sys.argv[1:3]


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return done.stdout


def levels_db(folder, displacement, relief_m, micro_m, stem):
    """Felt levels, dB re 1 µm, of the folder's stroke over another map."""
    text = open(f"{folder}/scene.toml").read()
    text = text.replace('displacement = "displacement.png"', f'displacement = "{displacement}"')
    text = re.sub(r"\nrelief_m = .*", f"\nrelief_m = {max(relief_m, 1e-9):.9f}", text)
    text = re.sub(r"\nmicro_relief_m = .*", f"\nmicro_relief_m = {micro_m:.4e}", text)
    text = re.sub(r"\nfull_scale = .*", f"\nfull_scale = {FULL_SCALE_M}", text)
    open(f"{folder}/{stem}.toml", "w").write(text)
    run("render", f"{folder}/{stem}.toml", "-o", f"{folder}/{stem}")
    rate, felt = wavfile.read(f"{folder}/{stem}.haptic.wav")
    felt = felt.astype(float) * FULL_SCALE_M * 1e6
    f, power = welch(felt[rate // 10 : 19 * rate // 10], rate, nperseg=8192)
    return [10 * np.log10(power[(f >= a) & (f < b)].sum() * f[1] + 1e-30) for a, b in BANDS]


def contrast_db(picture):
    grey = np.asarray(Image.open(picture).convert("L")) / 255.0
    h, w = grey.shape
    r = np.hypot(np.fft.fftfreq(h)[:, None], np.fft.fftfreq(w)[None, :])
    spectrum = np.fft.fft2(grey - grey.mean())[(r >= 1 / 8) & (r <= 1 / 2)]
    return 20 * np.log10(np.sqrt((abs(spectrum) ** 2).sum()) / grey.size + 1e-9)


made, true, contrast = [], [], []
for folder in sys.argv[3:]:
    name = os.path.basename(os.path.normpath(folder))
    [colour], [normal] = (glob.glob(f"{folder}/{kind}.*") for kind in ("color", "normal"))
    out = f"{WORK}/{name}"
    width_m = TEXEL_M * Image.open(colour).size[0]
    photo = json.loads(run("texture", "from-photo", colour, "-o", out, "--width-m", width_m, "--json"))
    heights = json.loads(run("texture", "from-normals", normal, "-o", f"{out}/true.png", "--json"))
    made.append(levels_db(out, "displacement.png", photo["relief_m"], photo["micro_relief_m"], "made"))
    relief_m = heights["relief_per_px"] * width_m / heights["width"]
    true.append(levels_db(out, "true.png", relief_m, 0.0, "mapped"))
    contrast.append(contrast_db(colour))
    print(f"{name:34}", *(f"{m:6.1f} {t:6.1f}" for m, t in zip(made[-1], true[-1])), f"{contrast[-1]:6.1f}", flush=True)
made, true = np.array(made), np.array(true)
for band, (a, b) in enumerate(BANDS):
    error = made[:, band] - true[:, band]
    ranks = [spearmanr(x, true[:, band])[0] for x in (made[:, band], contrast)]
    print(
        f"{a}–{b} Hz: error {np.median(abs(error)):.1f} dB (median), {np.median(error):+.1f} of it common; "
        f"spread {made[:, band].std():.1f} / {true[:, band].std():.1f} dB; rank {ranks[0]:.2f}, contrast {ranks[1]:.2f}"
    )
