#!/usr/bin/env python3
"""Builds scenes with Blender, exports them as artists would, and renders them with Cycles.

    python3.11 -m venv bpy && bpy/bin/pip install 'bpy==4.5.*'
    bpy/bin/python tests/peers/blender_scenes.py OUT [--samples 256] [--runs 4] [--size 320x240]
                                                 [--scene glass --scene trees …]

Of every scene, OUT gets NAME.glb, NAME.gltf and NAME.obj, NAME.glb.toml and NAME.obj.toml that add what
the format cannot say, NAME.cycles.K.exr of --runs independent seeds, and NAME.regions.exr with
NAME.json, which say what material is seen where. `compare_blender.py` reads all of it; README.md says what differs.
Nothing is downloaded: geometry and images are made here.
"""

import argparse
import math
import sys
from pathlib import Path

import numpy as np

import blender_build as build
import blender_export as export

# White: Cycles tints what is refracted by the root of the base colour, glTF by all of it.
CLEAR = {"Base_Color": (1, 1, 1, 1), "Transmission_Weight": 1.0}


def tiles(size=256, across=8):
    """A floor of two colours of tiles with joints, and a gradient that shows which way is up."""
    v, u = np.mgrid[0:size, 0:size] / size
    odd = (np.floor(u * across) + np.floor(v * across)) % 2
    colour = np.where(odd[..., None], [0.78, 0.62, 0.45], [0.25, 0.35, 0.5])
    colour = colour * (0.7 + 0.3 * v[..., None])
    joint = np.minimum(u * across % 1, v * across % 1) < 0.06
    return np.where(joint[..., None], 0.85, colour)


def leaf(size=128):
    """A leaf, its mask in alpha; the colour goes on behind the mask."""
    v, u = (np.mgrid[0:size, 0:size] + 0.5) / size
    width = 0.42 * np.sin(math.pi * np.clip(v, 0, 1)) ** 0.7
    inside = np.abs(u - 0.5) < width
    vein = np.abs(np.abs(u - 0.5) - 0.25 * (v * 5 % 1)) < 0.02
    green = np.where(vein[..., None], [0.45, 0.6, 0.25], [0.25, 0.48, 0.15])
    return np.concatenate([green, inside[..., None]], axis=2)


def dimples(size=256, across=6, height=0.12):
    """A normal map of round bumps, +y up as glTF and Blender have it."""
    v, u = (np.mgrid[0:size, 0:size] + 0.5) / size * across
    slope = [-height * math.pi * np.cos(2 * math.pi * a) for a in (u, v)]
    normal = np.stack([slope[0], slope[1], np.ones_like(u)], axis=2)
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return normal * 0.5 + 0.5


def glass(folder):
    """Glass, amber and brass on a textured floor, under a lamp of glowing mesh and a point light."""
    sky = (0.15, 0.18, 0.22)
    build.fresh_scene(sky)
    floor = build.principled("floor", Roughness=0.6)
    build.textured(floor, build.image("tiles", tiles(), folder), scale=3.0)
    clear = build.principled("glass", **CLEAR, Roughness=0.0, IOR=1.5)
    build.solid(clear, thickness=1.0)
    amber = build.principled("amber", **CLEAR, Roughness=0.0, IOR=1.45)
    build.solid(amber, thickness=0.8, density=20.0, colour=(0.99, 0.96, 0.9))
    frosted = build.principled("frosted", **CLEAR, Roughness=0.3, IOR=1.5)
    build.solid(frosted, thickness=0.8)
    brass = build.principled("brass", Base_Color=(0.85, 0.6, 0.25, 1), Metallic=1.0, Roughness=0.25)
    lamp = build.principled("lamp", Base_Color=(0, 0, 0, 1), Emission_Color=(1, 0.9, 0.75, 1))
    lamp.node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 12.0
    build.place(build.plane("floor", 4.0, floor), "floor")
    build.place(build.ball("ball", 0.6, clear), "ball", (-0.5, 0.3, 0.61))
    build.place(build.box("block", (0.35, 0.35, 0.35), amber), "block", (0.7, -0.5, 0.36), (0, 0, 0.5))
    build.place(build.ball("frosted", 0.35, frosted), "frosted", (-0.5, -0.9, 0.36))
    build.place(build.ball("brass", 0.5, brass), "brass", (0.9, 0.8, 0.51))
    build.place(build.plane("lamp", 0.6, lamp), "lamp", (0.6, 0.2, 3.0), (math.pi, 0.3, 0))
    build.light("bulb", "POINT", 60.0, (-2.0, -1.5, 2.5), color=(0.7, 0.8, 1.0))
    build.camera((0.3, -4.2, 2.1), (0.1, 0.0, 0.4), 42)
    return export.Described(
        sky=sky,
        media={"amber": {"sigma_a": [20 * -math.log(c) for c in (0.99, 0.96, 0.9)], "sigma_s": 0.0}},
        materials={"amber": {"kind": "dielectric", "ior": 1.45, "inside": "amber"}},
    )


def tree_mesh(bark, leaves, rng, branches=7, leaves_each=24):
    """A trunk and branches of six-sided cones, and a crown of square cards."""
    vertices, faces, uvs, slots = [], [], [], []

    def cone(foot, tip, radius):
        axis = np.subtract(tip, foot)
        across = np.cross(axis, [0.3, 0.5, 0.8])
        across /= np.linalg.norm(across)
        other = np.cross(axis / np.linalg.norm(axis), across)
        start = len(vertices)
        for end, r in ((foot, radius), (tip, 0.3 * radius)):
            for k in range(6):
                turn = math.pi / 3 * k
                vertices.append(end + r * (math.cos(turn) * across + math.sin(turn) * other))
        for k in range(6):
            n = (k + 1) % 6
            faces.append((start + k, start + n, start + 6 + n, start + 6 + k))
            uvs.extend([(k / 6, 0), ((k + 1) / 6, 0), ((k + 1) / 6, 1), (k / 6, 1)])
            slots.append(0)

    def card(centre, size):
        u, v = rng.normal(size=3), rng.normal(size=3)
        u /= np.linalg.norm(u)
        v -= u * (u @ v)
        v /= np.linalg.norm(v)
        start = len(vertices)
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            vertices.append(centre + size * (a * u + b * v))
        faces.append((start, start + 1, start + 2, start + 3))
        uvs.extend([(0, 0), (1, 0), (1, 1), (0, 1)])
        slots.append(1)

    top = np.array([0.05, -0.03, 2.0])
    cone(np.zeros(3), top, 0.12)
    for k in range(branches):
        height = 0.45 + 0.5 * k / branches
        turn = 2.4 * k
        foot = height * top
        reach = 1.0 - 0.6 * (height - 0.45)
        tip = foot + reach * np.array([math.cos(turn), math.sin(turn), 0.7])
        cone(foot, tip, 0.05)
        for _ in range(leaves_each):
            at = foot + rng.uniform(0.35, 1.05) * (tip - foot) + 0.22 * rng.normal(size=3)
            card(at, rng.uniform(0.07, 0.14))
    return build.mesh("tree", vertices, faces, [bark, leaves], uvs, slots)


def trees(folder):
    """A wood: 256 linked duplicates of one tree with masked leaves, under a sun and a blue sky."""
    sky = (0.35, 0.5, 0.8)
    build.fresh_scene(sky)
    rng = np.random.default_rng(7)
    ground = build.principled("ground", Base_Color=(0.28, 0.22, 0.14, 1), Roughness=1.0)
    bark = build.principled("bark", Base_Color=(0.2, 0.13, 0.08, 1), Roughness=0.9)
    leaves = build.principled("leaves", Roughness=0.7)
    build.textured(leaves, build.image("leaf", leaf(), folder), mask=True)
    build.place(build.plane("ground", 40.0, ground), "ground")
    tree = tree_mesh(bark, leaves, rng)
    for k in range(256):
        column, row = k % 16, k // 16
        x, y = 1.7 * (column - 7.5), 1.7 * row - 4.0
        at = (x + rng.uniform(-0.6, 0.6), y + rng.uniform(-0.6, 0.6), 0.0)
        rotation = (rng.normal() * 0.05, rng.normal() * 0.05, rng.uniform(0, 2 * math.pi))
        build.place(tree, f"tree.{k:03}", at, rotation, rng.uniform(0.7, 1.4))
    build.light("sun", "SUN", 4.0, (0, 0, 10), aim=(5, 7, 0), color=(1.0, 0.9, 0.75))
    build.camera((0.4, -11.0, 5.0), (0.0, 2.0, 0.6), 55)
    return export.Described(sky=sky, masks={"leaves": "leaf.png"})


def fog(folder):
    """A glowing ball and a spotlight in a cube of fog that stands on a floor, with a ball and a post."""
    del folder
    sky = (0.02, 0.02, 0.03)
    build.fresh_scene(sky)
    coefficients = {"sigma_a": [0.02, 0.03, 0.05], "sigma_s": [0.3, 0.35, 0.4], "g": 0.5}
    floor = build.principled("floor", Base_Color=(0.5, 0.5, 0.5, 1), Roughness=0.8)
    red = build.principled("red", Base_Color=(0.6, 0.1, 0.08, 1), Roughness=0.5)
    lamp = build.principled("lamp", Base_Color=(0, 0, 0, 1), Emission_Color=(1, 0.8, 0.5, 1))
    lamp.node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 25.0
    mist = build.fog("mist", **coefficients)
    build.place(build.plane("floor", 6.0, floor), "floor")
    build.place(build.box("fog", (1.5, 1.5, 1.2), mist), "fog", (0, 0, 1.25))
    build.place(build.ball("lamp", 0.18, lamp), "lamp", (-0.5, 0.2, 1.1))
    build.place(build.ball("red", 0.35, red), "red", (0.6, -0.2, 0.45))
    build.place(build.box("post", (0.08, 0.08, 0.8), red), "post", (-0.1, -0.6, 0.9))
    build.light("spot", "SPOT", 150.0, (2.6, -1.0, 3.2), aim=(0.2, 0.2, 0.5),
                spot_size=math.radians(30), spot_blend=0.2, color=(0.6, 0.8, 1.0))
    build.camera((0.5, -5.6, 2.2), (0.0, 0.0, 1.0), 45)
    medium = coefficients | {"phase": {"kind": "henyey_greenstein", "g": coefficients["g"]}}
    del medium["g"]
    return export.Described(
        sky=sky, media={"mist": medium}, materials={"mist": {"kind": "null", "inside": "mist"}}
    )


def relief(folder):
    """Normal maps, roughnesses and metals under a low sun: what the OBJ format has no words for."""
    sky = (0.3, 0.3, 0.3)
    build.fresh_scene(sky)
    bumps = build.image("dimples", dimples(), folder, colour=False)
    wall = build.bumpy(build.principled("wall", Base_Color=(0.6, 0.55, 0.5, 1), Roughness=0.8), bumps)
    build.place(build.plane("wall", 2.5, wall), "wall")
    for k in range(4):
        for j, metallic in enumerate((0.0, 1.0)):
            name = f"{'metal' if metallic else 'plastic'} {k}"
            paint = build.principled(name, Base_Color=(0.7, 0.3, 0.2, 1), Metallic=metallic)
            shader = paint.node_tree.nodes["Principled BSDF"]
            shader.inputs["Roughness"].default_value = 0.1 + 0.3 * k
            if k == 2:
                build.bumpy(paint, bumps, scale=2.0)
            at = (-1.5 + k, -0.6 + 1.2 * j, 0.45)
            build.place(build.ball(name, 0.4, paint), name, at, (1.2, 0.3, 0.2 * k))
    build.light("sun", "SUN", 3.0, (0, 0, 5), aim=(3, 2, 3.2))
    build.camera((0.3, -3.2, 4.2), (0.0, -0.1, 0.2), 45)
    return export.Described(sky=sky, obj=False)


SCENES = {"glass": glass, "trees": trees, "fog": fog, "relief": relief}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--samples", type=int, default=256, help="of Cycles, a pixel and a run")
    parser.add_argument("--runs", type=int, default=4, help="of Cycles; 0 exports only")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--scene", action="append", choices=SCENES, help="default: all")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    size = tuple(int(n) for n in options.size.split("x"))
    for name in options.scene or SCENES:
        described = SCENES[name](options.out)
        export.write(name, described, size, options.out)
        export.render(name, options.samples, options.runs, options.out)


if __name__ == "__main__":
    sys.exit(main())
