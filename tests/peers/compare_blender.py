#!/usr/bin/env python3
"""Renders what Blender exported, holds glTF against OBJ and glTF against Cycles.

    bpy/bin/pip install OpenEXR pillow numpy
    bpy/bin/python tests/peers/blender_scenes.py OUT
    cargo build --release -p tyndall
    bpy/bin/python tests/peers/compare_blender.py OUT target/release/tyndall [--passes 256]

Of every scene in OUT: NAME.glb.exr and NAME.obj.exr, and NAME.png, which shows from left to right glTF,
OBJ, Cycles, and glTF over Cycles (red is brighter, blue darker, full colour is a factor of two).

glTF against OBJ: a z-test of the mean of every region (one material, as far as it is seen) and channel,
with Sidak's correction at a false-alarm rate of 1 % a scene. `tyndall diff` says what single pixels do.

glTF against Cycles: the ratio of the means of every region, with its standard error: 1 within LIMIT,
or within the bounds of KNOWN where README.md has a reason for it; three standard errors are added.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path
from statistics import NormalDist

import numpy as np
import OpenEXR
from PIL import Image

FALSE_ALARM = 0.01
LIMIT = 0.03
STANDARD_ERRORS = 3
# Ratios to Cycles, least and most. README.md, "What differs", says why.
KNOWN = {
    "glass": {"amber": (0.9, 1.04), "floor": (1.0, 1.04)},
    "relief": {"plastic 0": (0.92, 1.0), "metal 3": (1.0, 1.07)},
}


def channels(path):
    part = OpenEXR.File(str(path), separate_channels=True).parts[0]
    return {name: channel.pixels.astype(np.float64) for name, channel in part.channels.items()}


def colour(layers, prefix=""):
    """Three channels, of grey images as well."""
    if f"{prefix}Y" in layers:
        return np.repeat(layers[f"{prefix}Y"][..., None], 3, axis=2)
    return np.stack([layers[f"{prefix}{c}"] for c in "RGB"], axis=2)


def render(command, scene, passes, seed):
    """A scene file by Tyndall: the image and the variance of its mean."""
    image = scene.with_suffix(".exr")
    arguments = [command, "render", scene, "-o", image, "--passes", passes, "--seed", seed]
    subprocess.run([str(a) for a in arguments], check=True)
    layers = channels(image)
    return colour(layers), colour(layers, "variance.")


def cycles(folder, name):
    """The mean of the runs of Cycles, and its variance."""
    paths = sorted(folder.glob(f"{name}.cycles.*.exr"))
    runs = np.array([colour(channels(path), "ViewLayer.Combined.") for path in paths])
    return runs.mean(axis=0), runs.var(axis=0, ddof=1) / len(runs)


def regions(folder, name):
    """Masks of what is seen, by the name of the material."""
    names = json.loads((folder / f"{name}.json").read_text())
    index = channels(folder / f"{name}.regions.exr")["ViewLayer.IndexMA.X"].round()
    masks = {"sky": index == 0} | {names[k]: index == int(k) for k in names}
    return {region: mask for region, mask in masks.items() if mask.any()}


def means(image, mask):
    """Of a region and channel: the mean and its standard error."""
    radiance, variance = image
    return radiance[mask].mean(axis=0), np.sqrt(variance[mask].sum(axis=0)) / mask.sum()


def hold_against_obj(name, gltf, obj, masks):
    tests = 3 * len(masks)
    limit = NormalDist().inv_cdf(1 - (1 - (1 - FALSE_ALARM) ** (1 / tests)) / 2)
    agrees = True
    for region, mask in masks.items():
        (a, ea), (b, eb) = means(gltf, mask), means(obj, mask)
        z = (a - b) / np.maximum(np.hypot(ea, eb), 1e-6 * b)
        same = bool((np.abs(z) <= limit).all())
        agrees &= same
        verdict = "agree" if same else "DIFFER"
        print(f"{name:8} {region:10} glTF/OBJ    {spread(a / b)}   z {spread(z)}   {verdict}")
    return agrees


def hold_against_cycles(name, gltf, reference, masks):
    agrees = True
    for region, mask in masks.items():
        (a, ea), (b, eb) = means(gltf, mask), means(reference, mask)
        ratio = a / b
        error = ratio * np.hypot(ea / a, eb / b)
        low, high = KNOWN.get(name, {}).get(region, (1 - LIMIT, 1 + LIMIT))
        slack = STANDARD_ERRORS * error
        fits = bool(((ratio >= low - slack) & (ratio <= high + slack)).all())
        agrees &= fits
        verdict = "as expected" if fits else f"NOT within {low} to {high}"
        print(f"{name:8} {region:10} glTF/Cycles {spread(ratio)}   ± {spread(error)}   {verdict}")
    return agrees


def spread(values):
    return " ".join(f"{v:+7.3f}" for v in values)


def sheet(path, images, ratio):
    """Images side by side at one exposure, and the ratio in red and blue."""
    white = np.percentile(images[-1], 95)
    shown = [np.clip(image / white, 0, 1) ** (1 / 2.2) for image in images]
    stops = np.clip(np.log2(np.maximum(ratio.mean(axis=2), 1e-6)), -1, 1)
    red, blue = np.clip(1 + stops, 0, 1), np.clip(1 - stops, 0, 1)
    shown.append(np.stack([red, np.minimum(red, blue), blue], axis=2))
    pixels = (np.concatenate(shown, axis=1) * 255).round().astype(np.uint8)
    Image.fromarray(pixels).save(path)


def smooth(image, width=3):
    """The mean of the pixels around each, so that noise does not drown a ratio."""
    padded = np.pad(image, ((width // 2,) * 2, (width // 2,) * 2, (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, (width, width), axis=(0, 1))
    return windows.mean(axis=(-2, -1))


def compare(name, folder, command, passes):
    masks = regions(folder, name)
    reference = cycles(folder, name)
    gltf = render(command, folder / f"{name}.glb.toml", passes, 1)
    images, agrees = [gltf[0]], True
    if (folder / f"{name}.obj.toml").exists():
        obj = render(command, folder / f"{name}.obj.toml", passes, 2)
        images.append(obj[0])
        agrees = hold_against_obj(name, gltf, obj, masks)
    agrees &= hold_against_cycles(name, gltf, reference, masks)
    images.append(reference[0])
    ratio = smooth(gltf[0]) / np.maximum(smooth(reference[0]), 1e-6)
    sheet(folder / f"{name}.png", images, ratio)
    return agrees


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path, help="that blender_scenes.py wrote")
    parser.add_argument("command", type=Path, help="the tyndall command")
    parser.add_argument("--passes", type=int, default=256)
    parser.add_argument("--scene", action="append", help="default: all")
    options = parser.parse_args()
    names = options.scene or sorted(p.stem for p in options.folder.glob("*.json"))
    command = options.command.resolve()
    results = [compare(n, options.folder, command, options.passes) for n in names]
    print("as expected" if all(results) else "NOT as expected")
    sys.exit(not all(results))


if __name__ == "__main__":
    main()
