#!/usr/bin/env python3
"""Renders four scenes with Tyndall and with Mitsuba 3, and tests that the images agree.

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

mi.set_variant("scalar_rgb")
from mitsuba import ScalarTransform4f as T  # noqa: E402

SCENES = Path(__file__).parent / "scenes"
RUNS = 64
SAMPLES = 16  # of Mitsuba, a pixel and a run
PASSES = 1024  # of Tyndall
FALSE_ALARM = 0.01
ROUNDING = 1e-6
SCALE = 10.0  # Mitsuba takes coefficients up to 1, times a scale


def sensor(position, look_at, fov, medium=None):
    film = {"type": "hdrfilm", "width": 64, "height": 64, "rfilter": {"type": "box"}}
    camera = {
        "type": "perspective",
        "fov": fov,
        "near_clip": 1e-4,
        "far_clip": 100.0,
        "to_world": T().look_at(origin=position, target=look_at, up=[0, 1, 0]),
        "film": film,
        "sampler": {"type": "independent"},
    }
    return camera | ({"medium": medium} if medium else {})


def fog_box(sigma_a, sigma_s, g, lamp, camera, extra=None):
    sigma_a, sigma_s = np.broadcast_to(sigma_a, 3), np.broadcast_to(sigma_s, 3)
    fog = {
        "type": "homogeneous",
        "sigma_t": {"type": "rgb", "value": list((sigma_a + sigma_s) / SCALE)},
        "scale": SCALE,
        "albedo": {"type": "rgb", "value": list(sigma_s / (sigma_a + sigma_s))},
        "phase": {"type": "hg", "g": g},
    }
    center, radius, radiance = lamp
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 100},
        "fog": fog,
        "sensor": sensor(*camera, medium={"type": "ref", "id": "fog"}),
        "walls": {
            "type": "cube",
            "interior": {"type": "ref", "id": "fog"},
            "bsdf": {
                "type": "twosided",
                "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}},
            },
        },
        "lamp": {
            "type": "sphere",
            "center": center,
            "radius": radius,
            "exterior": {"type": "ref", "id": "fog"},
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}},
        },
    }
    return scene | (extra or {})


def glass_ball():
    ball = {
        "type": "sphere",
        "center": [-0.2, -0.5, -0.2],
        "radius": 0.4,
        "exterior": {"type": "ref", "id": "fog"},
        "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0},
    }
    lamp = ([0.4, 0.55, -0.2], 0.3, 2.0)
    camera = ([0, 0, 0.9], [0, -0.2, 0], 80)
    return fog_box(0.05, 0.45, 0.3, lamp, camera, {"ball": ball})


def plume(n=64):
    """A bent column of soft puffs, zero towards the walls."""
    axis = (np.arange(n) + 0.5) / n
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    density = np.zeros((n, n, n))
    for k in range(24):
        t = k / 23
        center = (0.5 + 0.15 * np.sin(5 * t), 0.1 + 0.8 * t, 0.5 + 0.15 * np.cos(4 * t + 1))
        radius = 0.05 + 0.12 * t
        d2 = (x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2
        density += (0.6 + 0.4 * np.sin(9 * k)) * np.exp(-d2 / (2 * (radius / 2) ** 2))
    return (density / density.max()).astype(np.float32)


def smoke(folder):
    grid = mi.VolumeGrid(plume()[..., None])
    grid.write(str(folder / "smoke.vol"))
    medium = {
        "type": "heterogeneous",
        "sigma_t": {"type": "gridvolume", "grid": grid},
        "albedo": {
            "type": "constvolume",
            "value": {"type": "rgb", "value": [0.9, 0.8, 0.6]},
        },
        "scale": 10.0,
        "phase": {"type": "hg", "g": 0.4},
    }
    return {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 100},
        "sensor": sensor([0.5, 0.7, 3.0], [0.5, 0.5, 0.5], 35),
        "cube": {
            "type": "cube",
            "to_world": T().translate([0.5, 0.5, 0.5]).scale([0.5, 0.5, 0.5]),
            "bsdf": {"type": "null"},
            "interior": medium,
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.8, 0.9, 1.0]}},
    }


def scenes(folder):
    lamp = ([0.3, 0.4, -0.4], 0.2, 3.0)
    camera = ([0, 0, 0.9], [0, 0, 0], 90)
    yield "fog_box", fog_box(0.1, 0.4, 0.0, lamp, camera)
    chromatic = ([0.1, 0.3, 0.05], [0.6, 0.9, 1.5])
    yield "anisotropic_fog_box", fog_box(*chromatic, 0.8, lamp, camera)
    yield "smoke", smoke(folder)
    yield "glass_ball", glass_ball()


def render_mitsuba(scene):
    scene = mi.load_dict(scene)
    runs = [np.array(mi.render(scene, spp=SAMPLES, seed=seed)) for seed in range(RUNS)]
    return np.mean(runs, axis=0), np.var(runs, axis=0, ddof=1) / RUNS


def render_tyndall(command, name, folder):
    source, image = folder / f"{name}.toml", folder / f"{name}.exr"
    source.write_text((SCENES / f"{name}.toml").read_text())
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
        results = [
            compare(name, render_tyndall(command, name, Path(folder)), render_mitsuba(scene))
            for name, scene in scenes(Path(folder))
            if len(sys.argv) < 3 or name in sys.argv[2:]
        ]
    print("agree" if all(results) else "DISAGREE")
    sys.exit(not all(results))


if __name__ == "__main__":
    main()
