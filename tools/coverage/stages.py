"""The scenes that rows share: geometry, cameras, lights, images and materials. They are made in an empty file."""

from __future__ import annotations

from typing import Any

import bmesh
import bpy
import numpy as np
from mathutils import Vector
from support import images

WIDTH, HEIGHT = 48, 32

SECOND_UV = np.array([[0.6, 0.1], [-0.1, 0.6], [0.35, -0.27]])
"""Maps positions to the second UV map, which is degenerate on none of the faces."""


def prepare(samples: int, seed: int) -> None:
    """Empties the file and sets up both engines. Rays go through the centres of pixels, so values have no noise."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    cycles = scene.cycles
    cycles.samples, cycles.seed = samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    scene.view_layers[0].gradus.use_pass_components = False


def add(data: Any, name: str = "Object", **place: Any) -> bpy.types.Object:
    obj = bpy.data.objects.new(name, data)
    for key, value in place.items():
        setattr(obj, key, value)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def camera(location: tuple[float, ...], target: tuple[float, ...] = (0, 0, 0), **settings: Any) -> bpy.types.Object:
    data = bpy.data.cameras.new("Camera")
    for name, value in settings.items():
        setattr(data, name, value)
    turn = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = add(data, "Camera", location=location, rotation_euler=turn)
    return bpy.context.scene.camera


def mesh(kind: str, material: Any = None, name: str = "Mesh", smooth: bool = True, **place: Any) -> bpy.types.Object:
    """Adds a plane, a cube or a sphere of size 2 with a UV map, a colour attribute and a vertex group."""
    data = bpy.data.meshes.new(name)
    shape = bmesh.new()
    if kind == "PLANE":
        bmesh.ops.create_grid(shape, x_segments=2, y_segments=2, size=1.0, calc_uvs=True)
    elif kind == "CUBE":
        bmesh.ops.create_cube(shape, size=2.0, calc_uvs=True)
    else:
        bmesh.ops.create_uvsphere(shape, u_segments=24, v_segments=12, radius=1.0, calc_uvs=True)
    shape.to_mesh(data)
    shape.free()
    if not data.uv_layers:
        data.uv_layers.new(name="UVMap")
    for polygon in data.polygons:
        polygon.use_smooth = smooth and kind == "SPHERE"
    if material is not None:
        data.materials.append(material)
    _add_attributes(data)
    obj = add(data, name, **place)
    group = obj.vertex_groups.new(name="Group")
    for vertex in data.vertices:
        group.add([vertex.index], 0.5 + 0.5 * vertex.co.x, "REPLACE")
    return obj


def _add_attributes(data: bpy.types.Mesh) -> None:
    """Adds a second UV map and the colour attribute "Col"."""
    positions = np.array([vertex.co for vertex in data.vertices], np.float32)
    corners = np.array([loop.vertex_index for loop in data.loops])
    second = data.uv_layers.new(name="Second", do_init=False)
    second.data.foreach_set("uv", (positions[corners] @ SECOND_UV + 0.3).astype(np.float32).ravel())
    color = data.color_attributes.new("Col", "FLOAT_COLOR", "CORNER")
    values = np.concatenate([positions[corners] * 0.4 + 0.5, np.full((len(corners), 1), 0.8, np.float32)], axis=1)
    color.data.foreach_set("color", values.astype(np.float32).ravel())


def empty_tree(block: Any, output: str) -> tuple[Any, Any]:
    """Returns the node tree of a material, world or light with an output node and nothing else, and that node."""
    if isinstance(block, bpy.types.Light) or bpy.app.version < (5, 0, 0):
        block.use_nodes = True
    tree = block.node_tree
    tree.nodes.clear()
    return tree, tree.nodes.new(output)


def material(
    kind: str = "BsdfDiffuse", color: tuple[float, ...] = (0.8, 0.8, 0.8), **inputs: Any
) -> bpy.types.Material:
    """Returns a material of one shader."""
    block = bpy.data.materials.new(kind)
    tree, output = empty_tree(block, "ShaderNodeOutputMaterial")
    node = tree.nodes.new(f"ShaderNode{kind}")
    node.inputs[0].default_value = (*color, 1.0)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return block


def checks(scale: float = 3.0, is_emission: bool = True) -> bpy.types.Material:
    """Returns a material of coloured checks by object coordinates, off the centres of pixels."""
    block = bpy.data.materials.new("Checks")
    tree, output = empty_tree(block, "ShaderNodeOutputMaterial")
    place, pattern = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexChecker")
    pattern.inputs["Scale"].default_value = scale
    pattern.inputs["Color1"].default_value, pattern.inputs["Color2"].default_value = (
        (0.9, 0.5, 0.1, 1),
        (0.1, 0.3, 0.8, 1),
    )
    shader = tree.nodes.new("ShaderNodeEmission" if is_emission else "ShaderNodeBsdfDiffuse")
    tree.links.new(place.outputs["Object"], pattern.inputs["Vector"])
    tree.links.new(pattern.outputs["Color"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return block


def gradient_world(strength: float = 1.0) -> bpy.types.World:
    """Sets a world whose colour changes smoothly with the direction."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    tree, output = empty_tree(scene.world, "ShaderNodeOutputWorld")
    place, scaled, shader = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "VectorMath", "Background"))
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = (0.3, 0.25, 0.35), (0.5, 0.45, 0.4)
    tree.links.new(place.outputs["Generated"], scaled.inputs[0])
    tree.links.new(scaled.outputs["Vector"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    shader.inputs["Strength"].default_value = strength
    if hasattr(scene.world.cycles, "sampling_method"):
        scene.world.cycles.sampling_method, scene.world.cycles.sample_map_resolution = "MANUAL", 64
    return scene.world


def black_world() -> None:
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    empty_tree(scene.world, "ShaderNodeOutputWorld")


def light(kind: str, energy: float, **place: Any) -> bpy.types.Object:
    data = bpy.data.lights.new("Light", kind)
    data.energy = energy
    return add(data, "Light", **place)


def pattern_image(is_float: bool = False, **settings: Any) -> bpy.types.Image:
    """Returns an image of 16×16 pixels, smooth in red and green, with blue checks and stripes of alpha.

    It has no dark colours, which 8 bits round by more than the tolerance.
    """
    image = bpy.data.images.new("pattern", 16, 16, alpha=True, float_buffer=is_float, **settings)
    y, x = np.mgrid[0:16, 0:16].astype(np.float32)
    alpha = np.where((x // 4) % 2 == 0, 1.0, 0.9)
    pixels = np.stack([0.4 + x / 25, 0.4 + y / 25, 0.6 + 0.3 * ((x // 4 + y // 4) % 2), alpha], axis=2).astype(
        np.float32
    )
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def surface_of_values(block: bpy.types.Material) -> None:
    """Shows a material that emits values on a tilted slab, a smooth sphere and a cube, seen in perspective."""
    slab = {"scale": (4.0, 3.0, 0.3), "rotation_euler": (0.15, 0.1, 0.07), "location": (0.03, 0.02, -0.9)}
    mesh("CUBE", block, "Slab", **slab)
    mesh("SPHERE", block, "Sphere", location=(-0.9, 0.1, 0.3), rotation_euler=(0.3, 0.5, 0.2))
    cube = {"location": (1.1, -0.2, 0.4), "rotation_euler": (0.5, 0.4, 0.3), "scale": (0.7, 0.55, 0.6)}
    mesh("CUBE", block, "Cube", **cube)
    black_world()
    camera((0.4, -1.3, 6.2), lens=50.0)


def lit_sphere(block: bpy.types.Material) -> bpy.types.Object:
    """Shows a material on a smooth sphere under a sun and a world that changes with the direction."""
    sphere = mesh("SPHERE", block, "Sphere", rotation_euler=(0.4, 0.2, 0.3))
    gradient_world()
    light("SUN", 1.5, rotation_euler=(0.6, 0.5, 0.0)).data.angle = 0.4
    camera((0.0, -3.6, 1.4), lens=50.0)
    return sphere


def room() -> bpy.types.Object:
    """Shows diffuse, glossy and transparent balls on a floor under a sun and a world. Returns the first ball."""
    mesh("PLANE", checks(1.3, is_emission=False), "Floor", scale=(4.0, 4.0, 1.0))
    ball = mesh("SPHERE", material("BsdfDiffuse", (0.7, 0.4, 0.2)), "Ball", scale=(0.6,) * 3, location=(-1.3, 0.2, 0.6))
    glossy = material("BsdfGlossy", (0.8, 0.7, 0.5), Roughness=0.5)
    mesh("SPHERE", glossy, "Glossy", scale=(0.6,) * 3, location=(0.1, 0.4, 0.6))
    mesh("SPHERE", material("BsdfGlass", (0.9, 1.0, 0.9)), "Glass", scale=(0.5,) * 3, location=(1.3, -0.2, 0.55))
    mesh("PLANE", material("Emission", (0.5, 0.25, 0.2)), "Emitter", scale=(0.3,) * 3, location=(0.5, -1.2, 0.3))
    gradient_world(0.6)
    light("SUN", 1.5, rotation_euler=(0.5, 0.4, 0.0)).data.angle = 0.0
    camera((0.0, -4.6, 3.2), (0.0, 0.0, 0.4), lens=42.0)
    return ball
