#!/usr/bin/env python3
"""Time to equal variance of Tyndall's path tracer and of Mitsuba 3's, all cores, on four scenes.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy scipy
    apt-get install libllvm19          # or set DRJIT_LIBLLVM_PATH to a libLLVM of 16 or newer
    cargo build --release -p tyndall
    venv/bin/python tests/peers/speed_mitsuba.py target/release/tyndall [--quick] [--scene NAME]…

Nothing else should run on the machine. Exits 1 if Tyndall takes longer than the bounds below. About
eight minutes on two cores, two with --quick.

What is compared is time × variance: the time of one sample times the variance of an image of one
sample a pixel, mean over pixels and channels. Half of it is the same noise in half the time.

Time. Every renderer renders an image of few samples and one of many, in turn with the others, ROUNDS
times over with new seeds; of each the shortest time counts, and the time of a sample is the slope
between the two. That leaves out what does not grow with samples: loading, building of trees, start of
threads, and Mitsuba's tracing of Python to kernels. Kernels are compiled and cached by a pilot image.
Tyndall's time is the `tyndall.seconds` of its image, which begins after the scene is built.

Variance. The spread of the timed images of many samples over the rounds, times their samples. The two
variants of Mitsuba draw from the same distribution and share the estimate. Its standard error, from
the spread over pixels, is printed; that of the image's mean tests that both render the same.

Fairness. Same size, box filter, independent samples. Of Mitsuba the better of `volpath` and
`volpathmis` is taken, variant by variant and scene by scene, both with their default Russian roulette
(rr_depth 5; off, `volpath` takes seven times the time for the same variance in fog_box) and no limit of
depth. Tyndall carries one channel where a scene is grey; Mitsuba's rgb variants always three.
"""

import argparse
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path


def find_llvm():
    """The newest libLLVM of the system: those before 16 abort on what Dr.Jit emits."""
    found = {}
    for path in Path("/usr/lib").glob("*-linux-gnu/libLLVM*.so*"):
        version = re.search(r"(?:LLVM-|so\.)(\d+)", path.name)
        if version and int(version[1]) >= 16:
            found[int(version[1])] = path
    if not found:
        sys.exit("no libLLVM of 16 or newer: install libllvm19, or set DRJIT_LIBLLVM_PATH")
    return str(found[max(found)])


os.environ.setdefault("DRJIT_LIBLLVM_PATH", find_llvm())

import mitsuba as mi  # noqa: E402
import numpy as np  # noqa: E402

mi.set_variant("scalar_rgb", "llvm_ad_rgb")
import drjit as dr  # noqa: E402

from mitsuba_scenes import NAMES, copy_scene, to_mitsuba  # noqa: E402

# Of Tyndall's time × variance over that of each variant, at most; in a grid of smoke half of either.
BOUNDS = {"scalar_rgb": 0.5, "llvm_ad_rgb": 1.0}
SMOKE_BOUND = 0.5
INTEGRATORS = ["volpath", "volpathmis"]
TIMED = [name for name in NAMES if name != "smoke_in_box"]
SIZE = 256
FEW = 8  # The image of few samples has this fraction of those of the other.
WORST_Z = 4.0


@dataclass
class Measured:
    """Times and images of one renderer with one integrator."""

    name: str
    render: callable  # of samples a pixel and a seed: seconds, image
    samples: int = 0
    short: list = field(default_factory=list)
    long: list = field(default_factory=list)
    images: list = field(default_factory=list)

    def pilot(self, seconds):
        """Compiles, and chooses the number of samples that takes about this long."""
        self.render(FEW, 0)
        few, _ = self.render(FEW, 0)
        more, _ = self.render(2 * FEW, 0)
        slope = max(more - few, 0.2 * few) / FEW
        self.samples = FEW * max(2, round(seconds / slope / FEW))

    def round(self, seed):
        self.short.append(self.render(self.samples // FEW, seed)[0])
        seconds, image = self.render(self.samples, seed + 1)
        self.long.append(seconds)
        self.images.append(image)

    def seconds_a_sample(self):
        samples = (self.samples - self.samples // FEW) * SIZE * SIZE
        return (min(self.long) - min(self.short)) / samples

    def noise(self):
        """How much slower the other rounds were than the fastest."""
        return float(np.median(self.long) / min(self.long) - 1)

    def variance(self):
        """Of one sample, the mean over pixels; its standard error; samples that it is from."""
        pixels = self.samples * np.var(self.images, axis=0, ddof=1).mean(axis=2)
        error = pixels.std() / math.sqrt(pixels.size)
        return pixels.mean(), error, self.samples * (len(self.images) - 1)

    def mean(self):
        """Of the image, and its standard error."""
        error = math.sqrt(self.variance()[0] / (self.samples * len(self.images))) / SIZE
        return np.mean(self.images), error


def tyndall(command, source):
    image = source.with_suffix(".exr")

    def render(samples, seed):
        arguments = ["render", source, "-o", image, "--passes", samples, "--seed", seed]
        size = [f"--set=film.width={SIZE}", f"--set=film.height={SIZE}"]
        arguments = [command, *map(str, arguments), *size]
        subprocess.run(arguments, check=True, stderr=subprocess.DEVNULL)
        bitmap = mi.Bitmap(str(image))
        seconds = float(bitmap.metadata()["tyndall.seconds"])
        radiance = np.array(dict(bitmap.split())["<root>"], dtype=np.float64)
        return seconds, radiance.reshape(SIZE, SIZE, -1)

    return Measured("tyndall", render)


def mitsuba(variant, integrator, source):
    mi.set_variant(variant)
    settings = {"type": integrator, "max_depth": -1}
    scene = mi.load_dict(to_mitsuba(source, settings, SIZE))

    def render(samples, seed):
        mi.set_variant(variant)
        start = time.perf_counter()
        image = mi.render(scene, spp=samples, seed=seed)
        dr.eval(image)
        dr.sync_thread()
        return time.perf_counter() - start, np.array(image, dtype=np.float64)

    return Measured(f"{variant} {integrator}", render)


def pooled(measured):
    """The variance of an integrator from all variants that have it."""
    parts = [m.variance() for m in measured]
    total = sum(samples for _, _, samples in parts)
    mean = sum(v * samples for v, _, samples in parts) / total
    error = math.sqrt(sum((e * samples) ** 2 for _, e, samples in parts)) / total
    return mean, error


def measure(command, source, rounds, seconds):
    ours = tyndall(command, source)
    peers = {
        (variant, integrator): mitsuba(variant, integrator, source)
        for variant in BOUNDS
        for integrator in INTEGRATORS
    }
    everyone = [ours, *peers.values()]
    for measured in everyone:
        measured.pilot(seconds)
    for k in range(rounds):
        for measured in everyone:
            measured.round(1 + 2 * k)
    return ours, peers


def report(scene, ours, peers):
    """Prints a scene's table. Whether it keeps the bounds, and the means agree."""
    variance, error = pooled([ours])
    our_cost = line(scene, ours, variance, error, "")
    keeps = True
    for variant, bound in BOUNDS.items():
        if scene == "smoke":
            bound = SMOKE_BOUND
        costs = {}
        for integrator in INTEGRATORS:
            peer = peers[variant, integrator]
            shared = pooled([peers[v, integrator] for v in BOUNDS])
            ratio = our_cost / (shared[0] * peer.seconds_a_sample())
            costs[ratio] = line(scene, peer, *shared, f"{ratio:8.3f}")
            (a, ea), (b, eb) = ours.mean(), peer.mean()
            z = (a - b) / math.hypot(ea, eb)
            if abs(z) > WORST_Z:
                keeps = False
                print(f"{scene}: the means of the images differ: {a:.6f}, {b:.6f}, z {z:+.1f}")
        ratio = max(costs)
        keeps &= ratio <= bound
        verdict = "kept" if ratio <= bound else "MISSED"
        print(f"{scene:20} {ratio:.3f} of {variant}, at most {bound}: {verdict}", flush=True)
    return keeps


def line(scene, measured, variance, error, ratio):
    speed = measured.seconds_a_sample()
    print(f"{scene:20} {measured.name:22} {1e-6 / speed:9.3f} {variance:11.5f} {error / variance:6.1%}"
          f" {1e6 * speed * variance:13.6f} {ratio:>8} {measured.samples:6} {measured.noise():+7.1%}")
    return speed * variance


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("command", type=Path, help="the tyndall command")
    parser.add_argument("--scene", action="append", choices=NAMES, help="default: four")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    rounds, seconds = (2, 0.7) if options.quick else (5, 2.0)
    print(f"{'scene':20} {'renderer':22} {'Msample/s':>9} {'variance':>11} {'±':>6} "
          f"{'µs × variance':>13} {'ratio':>8} {'spp':>6} {'noise':>7}", flush=True)
    keeps = True
    with tempfile.TemporaryDirectory() as folder:
        for name in options.scene or TIMED:
            source = copy_scene(name, Path(folder))
            measured = measure(options.command.resolve(), source, rounds, seconds)
            keeps &= report(name, *measured)
    sys.exit(not keeps)


if __name__ == "__main__":
    main()
