"""Displacement has the pictures of Cycles in the same Blender: as a bump, of vertices, and both."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images
from support.cycles import picture, pictures
from support.nodes import Graph, new_material, output_of

# Before 4.5 bumps of Cycles compare heights of neighbouring pixels, which are far apart here.
FREQUENCY, SCALE = (3.0, 0.6) if bpy.app.version >= (4, 5, 0) else (2.0, 0.4)
METHODS = ("BUMP", "DISPLACEMENT", "BOTH")


def waves(graph: Graph, scale: float = FREQUENCY) -> bpy.types.NodeSocket:
    return graph("TexNoise", "Fac", {"Vector": graph("TexCoord", "Generated"), "Scale": scale, "Detail": 0.0})


def height(graph: Graph, **properties: Any) -> bpy.types.NodeSocket:
    return graph(
        "Displacement", "Displacement", {"Height": waves(graph), "Midlevel": 0.4, "Scale": SCALE}, **properties
    )


def vector(graph: Graph, space: str) -> bpy.types.NodeSocket:
    inputs = {"Vector": graph("TexNoise", "Color", {"Vector": graph("TexCoord", "Generated"), "Scale": 2.0})}
    return graph("VectorDisplacement", "Displacement", {**inputs, "Midlevel": 0.5, "Scale": SCALE}, space=space)


def tilted(graph: Graph) -> bpy.types.NodeSocket:
    normal = graph("CombineXYZ", "Vector", {"X": 0.2, "Y": -0.3, "Z": 0.9})
    return graph("Displacement", "Displacement", {"Height": waves(graph), "Scale": SCALE, "Normal": normal})


def by_color(graph: Graph) -> bpy.types.NodeSocket:
    """Returns a colour, which moves the surface along the axes of the world."""
    return graph("MixRGB", "Color", {"Fac": waves(graph), "Color1": (0.0, 0.0, 0.0, 1.0), "Color2": (0.2, 0.1, 0.3, 1)})


CASES: dict[str, Callable[[Graph], bpy.types.NodeSocket]] = {
    "object": lambda g: height(g, space="OBJECT"),
    "world": lambda g: height(g, space="WORLD"),
    "normal": tilted,
    "vector tangent": lambda g: vector(g, "TANGENT"),
    "vector object": lambda g: vector(g, "OBJECT"),
    "vector world": lambda g: vector(g, "WORLD"),
    "color": by_color,
    "value": lambda g: g("Math", "Value", {"Value": waves(g), "Value_001": 0.4}, operation="MULTIPLY"),
    "constant": lambda g: g("RGB", "Color"),
}


@pytest.fixture(scope="module")
def stage() -> bpy.types.Scene:
    """Returns a scene with a smooth sphere and a flat, stretched grid under a sun."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(-1.6, 0.0, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.ops.mesh.primitive_grid_add(
        x_subdivisions=40, y_subdivisions=40, size=2.0, location=(1.5, 0.0, 0.0), rotation=(1.0, 0.0, 0.2)
    )
    bpy.context.object.scale = (1.3, 1.0, 0.6)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0.6, 0.5, 0.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -7.0, 1.5), (math.radians(78.0), 0.0, 0.0)
    for item in (sun, camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    return scene


def set_method(material: bpy.types.Material, method: str) -> None:
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = method


def displaced(method: str, source: Callable[[Graph], bpy.types.NodeSocket]) -> bpy.types.Material:
    """Returns a diffuse material with a displacement."""
    material = new_material()
    graph = Graph(material)
    output = output_of(material)
    graph.tree.links.new(graph("BsdfDiffuse", "BSDF"), output.inputs["Surface"])
    graph.tree.links.new(source(graph), output.inputs["Displacement"])
    set_method(material, method)
    return material


def test_displacement_shows(stage: bpy.types.Scene, tmp_path: Path) -> None:
    """The tests below could not fail if a bump, a true and no displacement had the same picture."""
    shown = []
    for method in ("BUMP", "DISPLACEMENT"):
        give(stage, displaced(method, CASES["object"]))
        shown.append(picture(stage, tmp_path, "GRADUS"))
    give(stage, displaced("BUMP", CASES["constant"]))
    shown.append(picture(stage, tmp_path, "GRADUS"))
    for i, a in enumerate(shown):
        for b in shown[:i]:
            assert np.abs(a - b).mean() > 0.028 * a.mean()


def give(scene: bpy.types.Scene, material: bpy.types.Material) -> None:
    for item in scene.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(material)


def compare(scene: bpy.types.Scene, folder: Path) -> None:
    """Compares the pictures of both engines. The silhouettes of rough surfaces take most of the tolerance."""
    expected, found = pictures(scene, folder)
    difference = np.abs(expected - found)
    scale = np.abs(expected).mean() + 1e-2
    assert difference.mean() / scale < 0.025
    assert np.quantile(difference, 0.95) / scale < 0.15
    assert np.abs(expected.mean(axis=(0, 1)) - found.mean(axis=(0, 1))).max() / scale < 0.02


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", CASES)
def test_displacement_is_that_of_cycles(name: str, method: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    give(stage, displaced(method, CASES[name]))
    compare(stage, tmp_path)


def add_ball(scene: bpy.types.Scene, material: bpy.types.Material, x: float) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(x, 0.0, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


@pytest.fixture
def balls(stage: bpy.types.Scene) -> Iterator[bpy.types.Scene]:
    """Returns the scene without its meshes. Those that the test adds are removed afterwards."""
    meshes = [item for item in stage.objects if item.type == "MESH"]
    for item in meshes:
        stage.collection.objects.unlink(item)
    yield stage
    for item in [item for item in stage.objects if item.type == "MESH"]:
        bpy.data.objects.remove(item)
    for item in meshes:
        stage.collection.objects.link(item)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("method", METHODS)
def test_instances_share_what_is_displaced(method: str, mirrored: bool, balls: bpy.types.Scene, tmp_path: Path) -> None:
    ball = add_ball(balls, displaced(method, CASES["object"]), 1.5)
    other = ball.copy()
    balls.collection.objects.link(other)
    other.location, other.rotation_euler = (-1.5, 0.0, 0.0), (0.5, 0.5, 0.5)
    other.scale = (-0.5 if mirrored else 0.5, 1.0, 1.3)
    compare(balls, tmp_path)


@pytest.mark.parametrize("method", METHODS)
def test_materials_displace_their_own_faces(method: str, balls: bpy.types.Scene, tmp_path: Path) -> None:
    for x, is_smooth in ((-1.5, True), (1.5, False)):
        mesh = add_ball(balls, displaced(method, CASES["object"]), x).data
        mesh.materials.append(displaced("BUMP", CASES["constant"]))
        for face in mesh.polygons:
            face.material_index = int(face.center.z > 0.1)
            face.use_smooth = is_smooth
    compare(balls, tmp_path)


@pytest.mark.parametrize("method", METHODS)
def test_tangent_space_without_a_uv_map(method: str, balls: bpy.types.Scene, tmp_path: Path) -> None:
    mesh = add_ball(balls, displaced(method, CASES["vector tangent"]), 0.0).data
    mesh.uv_layers.remove(mesh.uv_layers[0])
    compare(balls, tmp_path)


def test_a_bump_of_one_height_changes_nothing(balls: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: tangents turned from point to point of a bump, so that constant vectors bent the normals."""

    def one_height(graph: Graph) -> bpy.types.NodeSocket:
        inputs = {"Vector": graph("CombineXYZ", "Vector", {"X": 0.6, "Z": 0.3}), "Scale": 1.0}
        return graph("VectorDisplacement", "Displacement", inputs, space="TANGENT")

    ball = add_ball(balls, displaced("BUMP", one_height), 0.0)
    found = picture(balls, tmp_path, "GRADUS")
    ball.data.materials[0] = displaced("BUMP", CASES["constant"])
    plain = picture(balls, tmp_path, "GRADUS")
    assert plain.mean() > 0.01
    assert np.abs(found - plain).mean() < 0.01 * plain.mean()


@pytest.mark.parametrize("method", METHODS)
def test_displaced_meshes_deform(method: str, balls: bpy.types.Scene, tmp_path: Path) -> None:
    """A ball that grows while the shutter is open keeps its displacement."""
    ball = add_ball(balls, displaced(method, CASES["object"]), 0.0)
    ball.shape_key_add(name="Basis")
    key = ball.shape_key_add(name="Large")
    for point in key.data:
        point.co *= 1.8
    for frame, value in ((0, 0.0), (2, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    balls.frame_set(1)
    balls.render.use_motion_blur = True
    try:
        compare(balls, tmp_path)
    finally:
        balls.render.use_motion_blur = False


@pytest.mark.parametrize("method", METHODS)
def test_gradients_see_the_same_surface(method: str, balls: bpy.types.Scene, tmp_path: Path) -> None:
    """Shifted paths evaluate bumps as base paths do, so that L2 has the mean of plain paths."""
    for x in (-1.5, 1.5):
        add_ball(balls, displaced(method, CASES["object"]), x)
    balls.render.engine = "GRADUS"
    options = {"samples": 64, "pixel_filter": "BOX", "filter_width": 1.0, "noise_threshold": 0.0}
    plain = images.render(balls, tmp_path, integrator="PATH", reconstruction="NONE", **options)["Combined"][..., :3]
    shifted = images.render(balls, tmp_path, integrator="GRADIENT", reconstruction="L2", **options)
    difference = (shifted["Combined"][..., :3] - plain).reshape(9, 4, 16, 4, 3).mean(axis=(1, 3))
    assert np.abs(difference).mean() < 0.02 * plain.mean()
    assert abs(difference.mean()) < 0.005 * plain.mean()
