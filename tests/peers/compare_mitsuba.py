#!/usr/bin/env python3
"""Renders five scenes with Tyndall and with Mitsuba 3, and tests that the images agree.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy scipy
    cargo build --release -p tyndall
    venv/bin/python tests/peers/compare_mitsuba.py target/release/tyndall

For every scene: the mean of the image by a z-test per channel (three standard errors: a false alarm
of 0.3 % each), and every pixel by a z-test with Sidak's correction at a false-alarm rate of 1 % an
image. Exits 1 if any fails. Mitsuba renders RUNS images of independent seeds, whose spread gives its
standard error; Tyndall's comes from the variance layer of its EXR.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np
from scipy.stats import t

from mitsuba_scenes import NAMES, copy_scene, to_mitsuba

mi.set_variant("scalar_rgb")

INTEGRATOR = {"type": "volpath", "max_depth": -1, "rr_depth": 100}
RUNS = 64
SAMPLES = 16  # of Mitsuba, a pixel and a run
PASSES = 1024  # of Tyndall
FALSE_ALARM = 0.01
ROUNDING = 1e-6


def render_mitsuba(source):
    scene = mi.load_dict(to_mitsuba(source, INTEGRATOR))
    runs = [np.array(mi.render(scene, spp=SAMPLES, seed=seed)) for seed in range(RUNS)]
    return np.mean(runs, axis=0), np.var(runs, axis=0, ddof=1) / RUNS


def render_tyndall(command, source):
    image = source.with_suffix(".exr")
    arguments = [command, "render", source, "-o", image, "--passes", PASSES, "--seed", 1]
    subprocess.run([str(a) for a in arguments], check=True, stderr=subprocess.DEVNULL)
    layers = dict(mi.Bitmap(str(image)).split())
    mean = np.array(layers["<root>"], dtype=np.float64)
    variance = np.array(layers["variance"], dtype=np.float64)
    if mean.ndim == 2 or mean.shape[2] == 1:
        mean, variance = (np.repeat(v.reshape(64, 64, 1), 3, axis=2) for v in (mean, variance))
    return mean, variance


def compare(name, ours, theirs):
    (a, va), (b, vb) = ours, theirs
    passes = True
    for channel in range(3):
        difference = a[..., channel].mean() - b[..., channel].mean()
        error = np.sqrt((va + vb)[..., channel].sum()) / a[..., channel].size
        z = difference / error
        relative = difference / b[..., channel].mean()
        passes &= abs(z) <= 3
        print(f"{name:20} {'RGB'[channel]} tyndall {a[..., channel].mean():.6f} "
              f"mitsuba {b[..., channel].mean():.6f} ({relative:+.3%}) z {z:+.2f}")
    # The variance of a pixel is itself uncertain: Welch's t, by its quantile with Sidak's correction.
    freedom = (va + vb) ** 2 / np.maximum(va**2 / (PASSES - 1) + vb**2 / (RUNS - 1), 1e-300)
    freedom = np.clip(freedom, RUNS - 1, None)
    # What is the same in every sample (the sky) may differ by the rounding of f32.
    distance = np.maximum(np.abs(a - b) - ROUNDING * b, 0)
    z = distance / np.sqrt(np.maximum(va + vb, 1e-30))
    tests = z[..., 0].size if np.allclose(a[..., 0], a[..., 1]) else z.size
    limit = t.isf((1 - (1 - FALSE_ALARM) ** (1 / tests)) / 2, freedom)
    passes &= bool((z <= limit).all())
    worst = (z / limit).argmax()
    print(f"{name:20} pixels: |z| {z.flat[worst]:.2f} of at most {limit.flat[worst]:.2f}, "
          f"rms {np.sqrt((z**2).mean()):.3f}")
    return passes


def main():
    command = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        results = []
        for name in sys.argv[2:] or NAMES:
            source = copy_scene(name, Path(folder))
            ours, theirs = render_tyndall(command, source), render_mitsuba(source)
            results.append(compare(name, ours, theirs))
    print("agree" if all(results) else "DISAGREE")
    sys.exit(not all(results))


if __name__ == "__main__":
    main()
