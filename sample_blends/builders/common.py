"""What all sample scenes share: an empty scene, settings, meshes, materials, lamps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import bpy

Color = tuple[float, float, float]
Vector = tuple[float, float, float]


def register_engine() -> bool:
    """Registers Gradus, so that files can name it as their engine; without it they name Cycles."""
    try:
        import gradus

        gradus.register()
    except Exception as error:  # the add-on is not needed to make the files
        print(f"samples: Gradus is not registered: {error}")
        return False
    return True


def reset() -> None:
    """An empty file with one empty scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.context.scene.name = "Scene"


def save(path: Path) -> None:
    """Saves without backup, compressed."""
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True, relative_remap=True)
    print(f"samples: {path.name} {path.stat().st_size // 1024} kB")


def settings(width: int, height: int, samples: int = 64, bounces: int = 8) -> bpy.types.Scene:
    """Size and quality, for Gradus and for Cycles."""
    scene = bpy.context.scene
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = bounces
    for name in ("diffuse_bounces", "glossy_bounces", "transmission_bounces"):
        setattr(scene.cycles, name, bounces)
    scene.cycles.sample_clamp_indirect = 0.0
    scene.cycles.blur_glossy = 0.0
    render.engine = "CYCLES"
    if hasattr(scene, "gradus"):
        render.engine = "GRADUS"
        limits = dict.fromkeys(("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"), bounces)
        for name, value in {"samples": samples, **limits}.items():
            if hasattr(scene.gradus, name):
                setattr(scene.gradus, name, value)
    return scene


def link(
    data: bpy.types.ID | None, name: str, location: Vector = (0, 0, 0), rotation: Vector = (0, 0, 0), scale: Vector = (1, 1, 1)
) -> bpy.types.Object:
    """An object of `data` in the scene; rotation in degrees."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = location
    obj.rotation_euler = [math.radians(angle) for angle in rotation]
    obj.scale = scale
    return obj


def camera(location: Vector, target: Vector, lens: float = 50.0) -> bpy.types.Object:
    """The scene's camera, looking at a point."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    obj = link(data, "Camera", location)
    aim(obj, target)
    bpy.context.scene.camera = obj
    return obj


def aim(obj: bpy.types.Object, target: Vector) -> None:
    """Turns local -Z towards a point, Y up."""
    from mathutils import Vector as MathVector

    direction = MathVector(target) - obj.location
    obj.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def area_lamp(
    name: str, location: Vector, target: Vector, size: tuple[float, float], watts: float, color: Color = (1, 1, 1)
) -> bpy.types.Object:
    """A rectangle that shines at a point."""
    data = bpy.data.lights.new(name, "AREA")
    data.shape = "RECTANGLE"
    data.size, data.size_y = size
    data.energy, data.color = watts, color
    obj = link(data, name, location)
    aim(obj, target)
    return obj


def world(color: Color, strength: float) -> bpy.types.World:
    """A world of one colour."""
    block = bpy.data.worlds.new("World")
    block.use_nodes = True
    background = block.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength
    bpy.context.scene.world = block
    return block


def key(obj: bpy.types.Object, path: str, values: list[tuple[int, tuple[float, ...]]]) -> None:
    """Linear keys, so that vectors are easy to predict."""
    for frame, value in values:
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)
    for curve in obj.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


# Meshes


def mesh_object(
    name: str, vertices: Sequence[Vector], faces: Sequence[Sequence[int]], material: bpy.types.Material | None = None, smooth: bool = False
) -> bpy.types.Object:
    """An object from vertices and faces, without UV map."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    if smooth:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if material is not None:
        mesh.materials.append(material)
    return link(mesh, name)


def quad(name: str, corners: Sequence[Vector], material: bpy.types.Material, tiles: float = 1.0) -> bpy.types.Object:
    """Four corners with a UV map over [0, tiles]."""
    obj = mesh_object(name, corners, [(0, 1, 2, 3)], material)
    uv = obj.data.uv_layers.new(name="UVMap")
    for index, value in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        uv.data[index].uv = (value[0] * tiles, value[1] * tiles)
    return obj


def box(name: str, center: Vector, size: Vector, material: bpy.types.Material, turn: float = 0.0, bevel: float = 0.0) -> bpy.types.Object:
    """A box, turned about Z by degrees; `bevel` rounds its edges."""
    x, y, z = (0.5 * length for length in size)
    vertices = [(sx * x, sy * y, sz * z) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    obj = mesh_object(name, vertices, faces, material)
    obj.location = center
    obj.rotation_euler[2] = math.radians(turn)
    if bevel > 0.0:
        modifier = obj.modifiers.new("Bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, 3
    return obj


def lathe(
    name: str, profile: Iterable[tuple[float, float]], material: bpy.types.Material, location: Vector = (0, 0, 0), steps: int = 64
) -> bpy.types.Object:
    """A profile (radius, height) turned about Z by a Screw modifier and smoothed: the file keeps the profile only."""
    points = [(radius, 0.0, height) for radius, height in profile]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [(index, index + 1) for index in range(len(points) - 1)], [])
    mesh.materials.append(material)
    obj = link(mesh, name, location)
    screw = obj.modifiers.new("Screw", "SCREW")
    screw.steps = screw.render_steps = steps
    screw.use_merge_vertices = True
    screw.merge_threshold = 1e-5
    screw.use_normal_calculate = True
    screw.use_smooth_shade = True
    return obj


def sphere(name: str, center: Vector, radius: float, material: bpy.types.Material, segments: int = 48) -> bpy.types.Object:
    """A sphere as a turned half circle."""
    half = segments // 2
    profile = [(radius * math.sin(math.pi * i / half), -radius * math.cos(math.pi * i / half)) for i in range(half + 1)]
    profile[0], profile[-1] = (0.0, -radius), (0.0, radius)
    return lathe(name, profile, material, center, segments)


# Materials


def material(name: str, build: Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]) -> bpy.types.Material:
    """A material; `build` makes its nodes and returns the socket for the surface."""
    block = bpy.data.materials.new(name)
    block.use_nodes = True
    tree = block.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(build(tree), output.inputs["Surface"])
    return block


def principled(name: str, color: Color, roughness: float = 0.5, metallic: float = 0.0, **inputs: float) -> bpy.types.Material:
    """A Principled BSDF; more inputs by their names, with _ for spaces."""

    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
        node.inputs["Base Color"].default_value = (*color, 1.0)
        node.inputs["Roughness"].default_value = roughness
        node.inputs["Metallic"].default_value = metallic
        for key, value in inputs.items():
            node.inputs[key.replace("_", " ")].default_value = value
        return node.outputs[0]

    return material(name, build)


def diffuse(name: str, color: Color) -> bpy.types.Material:
    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        node = tree.nodes.new("ShaderNodeBsdfDiffuse")
        node.inputs["Color"].default_value = (*color, 1.0)
        return node.outputs[0]

    return material(name, build)


def glass(name: str, color: Color = (1, 1, 1), roughness: float = 0.0, ior: float = 1.5) -> bpy.types.Material:
    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        node = tree.nodes.new("ShaderNodeBsdfGlass")
        node.distribution = "GGX"  # the default differs between versions
        node.inputs["Color"].default_value = (*color, 1.0)
        node.inputs["Roughness"].default_value = roughness
        node.inputs["IOR"].default_value = ior
        return node.outputs[0]

    return material(name, build)


def emission(name: str, color: Color, strength: float) -> bpy.types.Material:
    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        node = tree.nodes.new("ShaderNodeEmission")
        node.inputs["Color"].default_value = (*color, 1.0)
        node.inputs["Strength"].default_value = strength
        return node.outputs[0]

    return material(name, build)


def textured(name: str, image: bpy.types.Image, roughness: float = 0.5, scale: float = 1.0) -> bpy.types.Material:
    """A Principled BSDF with an image by UV."""

    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (scale, scale, scale)
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
        node.inputs["Roughness"].default_value = roughness
        tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
        return node.outputs[0]

    return material(name, build)


def image(name: str, width: int, height: int, color_at: Callable[[float, float], Color]) -> bpy.types.Image:
    """A packed PNG; color_at gets the pixel centre, u to the right and v up in [0, 1], and gives sRGB values."""
    block = bpy.data.images.new(name, width, height)
    pixels: list[float] = []
    for y in range(height):
        for x in range(width):
            pixels.extend((*color_at((x + 0.5) / width, (y + 0.5) / height), 1.0))
    block.pixels.foreach_set(pixels)
    block.pack()
    return block
