"""Pieces that scenes of Blender are put together from: materials, meshes, images, lights."""

import math

import bpy
import numpy as np
from mathutils import Vector


def fresh_scene(world):
    """An empty file whose world radiates `world` from everywhere."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*world, 1.0)
    background.inputs["Strength"].default_value = 1.0
    return scene


def image(name, pixels, folder, colour=True):
    """An image of rows from the bottom up, values as stored in the file (sRGB where `colour`)."""
    height, width = pixels.shape[:2]
    result = bpy.data.images.new(name, width, height, alpha=True)
    result.colorspace_settings.name = "sRGB" if colour else "Non-Color"
    # Colour does not bleed into what the mask takes away.
    result.alpha_mode = "CHANNEL_PACKED"
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., : pixels.shape[2]] = pixels
    result.pixels.foreach_set(rgba.ravel())
    result.filepath_raw = str(folder / f"{name}.png")
    result.file_format = "PNG"
    result.save()
    return result


def principled(name, **inputs):
    """A material of one Principled BSDF: its inputs by name, `Base_Color=(…)` for "Base Color"."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ")].default_value = value
    return material


def texture_node(material, picture, scale=1.0):
    """An image node of the material, its texture coordinates times `scale`."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    if scale != 1.0:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (scale, scale, scale)
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    return node


def textured(material, picture, scale=1.0, mask=False):
    """Base colour from an image; with `mask`, there is nothing where its alpha is at most one half."""
    tree = material.node_tree
    shader = tree.nodes["Principled BSDF"]
    node = texture_node(material, picture, scale)
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    if mask:
        cut = tree.nodes.new("ShaderNodeMath")
        cut.operation = "GREATER_THAN"
        cut.inputs[1].default_value = 0.5
        tree.links.new(node.outputs["Alpha"], cut.inputs[0])
        tree.links.new(cut.outputs[0], shader.inputs["Alpha"])
    return material


def bumpy(material, picture, scale=1.0):
    """A normal map on a Principled material."""
    tree = material.node_tree
    normal = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(texture_node(material, picture, scale).outputs["Color"], normal.inputs["Color"])
    tree.links.new(normal.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])
    return material


def solid(material, thickness, density=0.0, colour=(1.0, 1.0, 1.0)):
    """Says to the glTF exporter that a transmissive material bounds a solid, which may absorb.

    Of the same two numbers, Cycles absorbs `density` (1 − `colour`) and glTF −`density` ln `colour`,
    which is 1 % more at a colour of 0.98 and 5 % at 0.9: take a dense medium of a pale colour.
    """
    tree = material.node_tree
    group = bpy.data.node_groups.get("glTF Material Output")
    if group is None:
        group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
        group.interface.new_socket("Occlusion", socket_type="NodeSocketFloat")
        group.interface.new_socket("Thickness", socket_type="NodeSocketFloat")
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.inputs["Thickness"].default_value = thickness
    if density > 0:
        absorption = tree.nodes.new("ShaderNodeVolumeAbsorption")
        absorption.inputs["Density"].default_value = density
        absorption.inputs["Color"].default_value = (*colour, 1.0)
        output = tree.nodes["Material Output"]
        tree.links.new(absorption.outputs[0], output.inputs["Volume"])
    return material


def fog(name, sigma_a, sigma_s, g):
    """A material of nothing but a homogeneous medium; its numbers are a custom property as well."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    add = tree.nodes.new("ShaderNodeAddShader")
    # Scattering is density times colour, absorption density times (1 − colour): one node for each.
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = max(sigma_s)
    scatter.inputs["Color"].default_value = (*(s / max(sigma_s) for s in sigma_s), 1.0)
    scatter.inputs["Anisotropy"].default_value = g
    absorb = tree.nodes.new("ShaderNodeVolumeAbsorption")
    absorb.inputs["Density"].default_value = max(sigma_a)
    absorb.inputs["Color"].default_value = (*(1 - a / max(sigma_a) for a in sigma_a), 1.0)
    tree.links.new(scatter.outputs[0], add.inputs[0])
    tree.links.new(absorb.outputs[0], add.inputs[1])
    tree.links.new(add.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    # Without "surface", it would be opaque: glTF has no material that is not there.
    material["tyndall"] = {
        "surface": "none",
        "sigma_a": list(sigma_a),
        "sigma_s": list(sigma_s),
        "g": g,
    }
    return material


def place(thing, name, location=(0, 0, 0), rotation=(0, 0, 0), scale=1.0):
    """An object of the scene from a mesh, light or camera."""
    result = bpy.data.objects.new(name, thing)
    result.location = location
    result.rotation_euler = rotation
    result.scale = (scale, scale, scale)
    bpy.context.scene.collection.objects.link(result)
    return result


def mesh(name, vertices, faces, materials, uvs=None, slots=None, smooth=False):
    """A mesh: `uvs` a face corner, `slots` the index of the material of each face."""
    result = bpy.data.meshes.new(name)
    result.from_pydata([tuple(v) for v in vertices], [], faces)
    for material in materials:
        result.materials.append(material)
    if uvs is not None:
        layer = result.uv_layers.new(name="UVMap")
        layer.data.foreach_set("uv", np.asarray(uvs, np.float32).ravel())
    if slots is not None:
        result.polygons.foreach_set("material_index", slots)
    result.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    result.update()
    return result


def plane(name, half, material):
    h = half
    corners = [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)]
    return mesh(name, corners, [(0, 1, 2, 3)], [material], [(0, 0), (1, 0), (1, 1), (0, 1)])


def box(name, half, material):
    x, y, z = half
    corners = [(i * x, j * y, k * z) for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return mesh(name, corners, faces, [material], [(0, 0), (1, 0), (1, 1), (0, 1)] * 6)


def ball(name, radius, material, rings=48):
    """A sphere of 2·`rings` by `rings` faces with smooth normals and texture coordinates."""
    columns = 2 * rings
    vertices, faces, uvs = [(0, 0, -radius)], [], []
    for i in range(1, rings):
        polar = math.pi * i / rings
        for j in range(columns):
            turn = 2 * math.pi * j / columns
            r = math.sin(polar)
            direction = Vector((r * math.cos(turn), r * math.sin(turn), -math.cos(polar)))
            vertices.append(radius * direction)
    top = len(vertices)
    vertices.append((0, 0, radius))
    for j in range(columns):
        k, u, v = (j + 1) % columns, j / columns, (j + 1) / columns
        faces.append((0, 1 + k, 1 + j))
        uvs += [((u + v) / 2, 0), (v, 1 / rings), (u, 1 / rings)]
        for i in range(rings - 2):
            a, b = 1 + i * columns, 1 + (i + 1) * columns
            low, high = (i + 1) / rings, (i + 2) / rings
            faces.append((a + j, a + k, b + k, b + j))
            uvs += [(u, low), (v, low), (v, high), (u, high)]
        last = 1 + (rings - 2) * columns
        faces.append((last + j, last + k, top))
        uvs += [(u, 1 - 1 / rings), (v, 1 - 1 / rings), ((u + v) / 2, 1)]
    return mesh(name, vertices, faces, [material], uvs, smooth=True)


def light(name, kind, energy, location, aim=None, **options):
    """A light without extent: POINT and SPOT in W, SUN in W·m⁻²."""
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    if kind == "SUN":
        data.angle = 0.0
    else:
        data.shadow_soft_size = 0.0
    for key, value in options.items():
        setattr(data, key, value)
    result = place(data, name, location)
    if aim is not None:
        result.rotation_euler = towards(location, aim)
    return result


def towards(position, target):
    """The rotation by which −z, the axis of cameras and lights, points at the target."""
    return (Vector(target) - Vector(position)).to_track_quat("-Z", "Y").to_euler()


def camera(position, target, fov_degrees):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    data.angle = math.radians(fov_degrees)
    data.clip_start, data.clip_end = 1e-3, 1e3
    result = place(data, "camera", position, towards(position, target))
    bpy.context.scene.camera = result
    return result
