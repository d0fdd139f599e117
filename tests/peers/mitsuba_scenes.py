"""Scene files of Tyndall as scenes of Mitsuba 3: what `scenes/` uses of the format, no more.

Set a variant of Mitsuba before `to_mitsuba`: its transforms and grids belong to one.
"""

import tomllib
from pathlib import Path

import mitsuba as mi
import numpy as np

SCENES = Path(__file__).parent / "scenes"
NAMES = ["fog_box", "anisotropic_fog_box", "smoke", "smoke_in_box", "glass_ball"]
SCALE = 10.0  # Mitsuba takes coefficients up to 1, times a scale


def copy_scene(name, folder):
    """Puts a scene file, and the grid that it may name, into a folder. Its path."""
    text = (SCENES / f"{name}.toml").read_text()
    target = folder / f"{name}.toml"
    target.write_text(text)
    for medium in tomllib.loads(text).get("media", {}).values():
        if "file" in medium:
            mi.VolumeGrid(plume()[..., None]).write(str(folder / medium["file"]))
    return target


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


def to_mitsuba(path, integrator, size=None):
    """The dictionary of a scene file, with an image of `size` × `size` pixels if given."""
    file = tomllib.loads(path.read_text())
    media = {name: medium(m, path.parent) for name, m in file.get("media", {}).items()}
    scene = {"type": "scene", "integrator": integrator}
    around = file["camera"].get("medium")
    if around and file["media"][around]["kind"] == "grid":
        # Nothing but its box, and a medium of Mitsuba needs a shape around it.
        scene["box"] = cube(file["media"][around]) | {"interior": media[around], "bsdf": {"type": "null"}}
        around = None
    if around:
        # One object for all who name it.
        scene["around"] = media[around]
        media[around] = {"type": "ref", "id": "around"}
    around = media.get(around)
    scene["sensor"] = sensor(file, around, size)
    for k, shape in enumerate(file.get("shapes", [])):
        scene[f"shape{k}"] = solid(shape, file["materials"], media, around)
    if "environment" in file:
        scene["sky"] = {"type": "constant", "radiance": rgb(file["environment"]["radiance"])}
    return scene


def rgb(value):
    return {"type": "rgb", "value": np.broadcast_to(value, 3).tolist()}


def sensor(file, around, size):
    camera, film = file["camera"], file["film"]
    sensor = {
        "type": "perspective",
        "fov": camera["fov"],
        "near_clip": 1e-4,
        "far_clip": 100.0,
        "to_world": mi.ScalarTransform4f().look_at(
            origin=camera["position"], target=camera["look_at"], up=[0, 1, 0]
        ),
        "film": {
            "type": "hdrfilm",
            "width": size or film["width"],
            "height": size or film["height"],
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
    }
    return sensor | ({"medium": around} if around else {})


def phase(medium):
    description = medium.get("phase", "isotropic")
    if description == "isotropic":
        return {"type": "isotropic"}
    return {"type": "hg", "g": description["g"]}


def medium(description, folder):
    if description["kind"] == "grid":
        grid = mi.VolumeGrid(str(folder / description["file"]))
        box = mi.ScalarTransform4f().translate(description["min"])
        box = box.scale(np.subtract(description["max"], description["min"]).tolist())
        return {
            "type": "heterogeneous",
            "sigma_t": {"type": "gridvolume", "grid": grid, "to_world": box},
            "albedo": {"type": "constvolume", "value": rgb(description["albedo"])},
            "scale": description["scale"],
            "phase": phase(description),
        }
    sigma_a, sigma_s = (np.broadcast_to(description[f"sigma_{c}"], 3) for c in "as")
    return {
        "type": "homogeneous",
        "sigma_t": rgb((sigma_a + sigma_s) / SCALE),
        "scale": SCALE,
        "albedo": rgb(sigma_s / (sigma_a + sigma_s)),
        "phase": phase(description),
    }


def solid(description, materials, media, around):
    """A box or sphere. What is opaque has the medium of the camera on whichever side is seen."""
    material = materials[description["material"]]
    if description["kind"] == "sphere":
        shape = {"type": "sphere"} | {key: description[key] for key in ("center", "radius")}
    else:
        shape = cube(description)
    opaque = material["kind"] == "diffuse"
    inside = around if opaque else media.get(material["inside"])
    shape |= {"exterior": around} if around else {}
    shape |= {"interior": inside} if inside else {}
    if "emission" in description:
        shape["emitter"] = {"type": "area", "radiance": rgb(description["emission"])}
    return shape | {"bsdf": bsdf(material)}


def cube(description):
    low, high = np.array(description["min"]), np.array(description["max"])
    place = mi.ScalarTransform4f().translate(((low + high) / 2).tolist())
    return {"type": "cube", "to_world": place.scale(((high - low) / 2).tolist())}


def bsdf(material):
    if material["kind"] == "diffuse":
        diffuse = {"type": "diffuse", "reflectance": rgb(material["reflectance"])}
        return {"type": "twosided", "bsdf": diffuse}
    if material["kind"] == "dielectric":
        return {"type": "dielectric", "int_ior": material["ior"], "ext_ior": 1.0}
    return {"type": "null"}
