"""Exports the scene that is open in Blender, and renders it with Cycles."""

import json
import math
from dataclasses import dataclass, field

import bpy
import numpy as np


@dataclass
class Described:
    """What exports do not say: the sky, and of OBJ the media, their materials, and masks."""

    sky: tuple
    media: dict = field(default_factory=dict)
    materials: dict = field(default_factory=dict)
    masks: dict = field(default_factory=dict)
    obj: bool = True


def write(name, described, size, folder):
    """NAME.glb, NAME.gltf, NAME.obj, and the scene files that include them."""
    # The exporter takes the camera's vertical angle from the picture's shape.
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y = size
    bpy.context.view_layer.update()
    for kind, file in (("GLB", f"{name}.glb"), ("GLTF_SEPARATE", f"{name}.gltf")):
        bpy.ops.export_scene.gltf(
            filepath=str(folder / file),
            export_format=kind,
            export_cameras=True,
            export_lights=True,
            export_extras=True,
            export_animations=False,
        )
    glb = {"include": [{"file": f"{name}.glb"}], **film(size), **environment(described)}
    (folder / f"{name}.glb.toml").write_text(toml(glb))
    if described.obj:
        bpy.ops.wm.obj_export(
            filepath=str(folder / f"{name}.obj"),
            export_pbr_extensions=True,
            export_triangulated_mesh=True,
            path_mode="RELATIVE",
        )
        mask(folder / f"{name}.mtl", described.masks)
        (folder / f"{name}.obj.toml").write_text(toml(obj_scene(name, described, size)))


def mask(path, masks):
    """Adds to an MTL file the masks that Blender's exporter leaves out."""
    text = path.read_text()
    for material, picture in masks.items():
        text = text.replace(f"newmtl {material}\n", f"newmtl {material}\nmap_d {picture}\n")
    path.write_text(text)


def film(size):
    return {"film": {"width": size[0], "height": size[1]}}


def environment(described):
    return {"environment": {"radiance": list(described.sky)}}


def obj_scene(name, described, size):
    """The scene around an OBJ file, which has neither camera nor lights nor media."""
    shape = {"kind": "obj", "file": f"{name}.obj"}
    if described.materials:
        shape["materials"] = {material: material for material in described.materials}
    media = {name: {"kind": "homogeneous", **medium} for name, medium in described.media.items()}
    return {
        "camera": obj_camera(),
        **film(size),
        **environment(described),
        **({"media": media} if media else {}),
        **({"materials": described.materials} if described.materials else {}),
        "shapes": [shape],
        "lights": [obj_light(o) for o in bpy.context.scene.objects if o.type == "LIGHT"],
    }


def y_up(vector):
    """From Blender's axes, z up, to those of its exports."""
    x, y, z = vector
    return [x, z, -y]


def axis(thing):
    """Where a camera or light looks, its −z axis, in the axes of exports."""
    return y_up(-thing.matrix_world.to_3x3().normalized().col[2])


def obj_camera():
    camera = bpy.context.scene.camera
    position = y_up(camera.matrix_world.translation)
    return {
        "kind": "pinhole",
        "position": position,
        "look_at": [p + d for p, d in zip(position, axis(camera))],
        "up": y_up(camera.matrix_world.to_3x3().col[1]),
        "fov": math.degrees(camera.data.angle_x),
    }


def obj_light(thing):
    """A light in the units of scene files.

    Blender's POINT and SPOT radiate energy / 4π W/sr, a spot whatever its cone; SUN is W·m⁻².
    """
    data = thing.data
    if data.type == "SUN":
        irradiance = [data.energy * c for c in data.color]
        return {"kind": "directional", "direction": axis(thing), "irradiance": irradiance}
    light = {
        "kind": data.type.lower(),
        "position": y_up(thing.matrix_world.translation),
        "intensity": [data.energy / (4 * math.pi) * c for c in data.color],
    }
    if data.type == "SPOT":
        half = math.degrees(data.spot_size) / 2
        light |= {"direction": axis(thing), "cone_angle": half}
        # As the glTF exporter has it.
        light["falloff_angle"] = half * (1 - data.spot_blend)
    return light


def toml(document):
    """TOML of tables, lists of tables and values; what lies deeper is written inline."""
    lines = []
    for key, value in document.items():
        if isinstance(value, list):
            for table in value:
                lines += [f"[[{key}]]", *entries(table), ""]
        elif all(isinstance(v, dict) for v in value.values()):
            for name, table in value.items():
                lines += [f"[{key}.{name}]", *entries(table), ""]
        else:
            lines += [f"[{key}]", *entries(value), ""]
    return "\n".join(lines)


def entries(table):
    return [f"{key} = {inline(value)}" for key, value in table.items()]


def inline(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(entries(value)) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(inline(v) for v in value) + "]"
    if isinstance(value, str):
        return json.dumps(value)
    return repr(int(value)) if isinstance(value, int) else repr(float(np.float64(value)))


def render(name, samples, runs, folder):
    """NAME.cycles.K.exr, linear; NAME.regions.exr and NAME.json, of the materials that are seen."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    settings = scene.render.image_settings
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
    scene.view_settings.view_transform = "Raw"
    physical(scene.cycles)
    scene.cycles.samples = samples
    for run in range(runs):
        scene.cycles.seed = run
        scene.render.filepath = str(folder / f"{name}.cycles.{run}.exr")
        bpy.ops.render.render(write_still=True)
    if runs:
        regions(name, folder)


def regions(name, folder):
    """The layer IndexMA of one sample: the material that is seen, fog being taken away."""
    scene = bpy.context.scene
    names = {}
    for index, material in enumerate(bpy.data.materials, 1):
        material.pass_index = index
        names[index] = material.name
    for thing in scene.objects:
        thing.hide_render = any("tyndall" in slot.material for slot in thing.material_slots)
    bpy.context.view_layer.use_pass_material_index = True
    scene.cycles.samples = 1
    scene.render.filepath = str(folder / f"{name}.regions.exr")
    bpy.ops.render.render(write_still=True)
    (folder / f"{name}.json").write_text(json.dumps(names))


def physical(cycles):
    """Nothing clamped, smoothed, blurred or left out."""
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_fast_gi = False
    cycles.max_bounces = 1024
    for kind in ("diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", 1024)
