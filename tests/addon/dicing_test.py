"""Adaptive subdivision divides meshes until their edges are as short as in Cycles."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images, recording
from support.cycles import picture, pictures
from support.nodes import Graph, new_material, output_of


def dice(obj: bpy.types.Object, scene: bpy.types.Scene, rate: float) -> None:
    """Switches adaptive subdivision of an object on."""
    modifier = obj.modifiers[-1]
    if hasattr(modifier, "use_adaptive_subdivision"):
        modifier.use_adaptive_subdivision = True
        modifier.adaptive_pixel_size = rate
    else:
        scene.cycles.feature_set = "EXPERIMENTAL"
        obj.cycles.use_adaptive_subdivision = True
        obj.cycles.dicing_rate = rate


def displaced(
    obj: bpy.types.Object, coordinates: str, noise: dict[str, float], scale: float, turns: tuple[float, float]
) -> None:
    """Gives a smooth object a Subdivision modifier and a noise that moves its vertices, and the scene light and camera.

    turns: angles of the sun and of the camera from the vertical, in radians.
    """
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    material = new_material()
    graph = Graph(material)
    height = graph("TexNoise", "Fac", {"Vector": graph("TexCoord", coordinates), **noise})
    moved = graph("Displacement", "Displacement", {"Height": height, "Midlevel": 0.5, "Scale": scale})
    graph.tree.links.new(graph("BsdfDiffuse", "BSDF"), output_of(material).inputs["Surface"])
    graph.tree.links.new(moved, output_of(material).inputs["Displacement"])
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = "DISPLACEMENT"
    obj.data.materials.append(material)
    scene = bpy.context.scene
    sun = recording.add(bpy.data.lights.new("Sun", "SUN"), "Sun")
    sun.data.energy, sun.rotation_euler = 3.0, (turns[0], 0.5, 0.0)
    scene.camera = recording.add(bpy.data.cameras.new("Camera"), "Camera")
    scene.camera.rotation_euler = (turns[1], 0.0, 0.0)
    scene.world = bpy.data.worlds.new("World")


@pytest.fixture
def ball(scene: bpy.types.Scene) -> bpy.types.Object:
    """Returns a displaced ball with a Subdivision modifier of one level."""
    images.prepare(scene)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=1.3)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    displaced(ball, "Generated", {"Scale": 8.0, "Detail": 0.0}, 0.7, (0.6, math.radians(90.0)))
    scene.camera.location = (0.0, -6.0, 0.0)
    return ball


def test_a_diced_mesh_is_displaced_as_in_cycles(scene: bpy.types.Scene, ball: bpy.types.Object, tmp_path: Path) -> None:
    coarse = picture(scene, tmp_path, "GRADUS")
    dice(ball, scene, 1.0)
    expected, found = pictures(scene, tmp_path)
    # Cycles before 4.5 has another limit surface.
    tolerance = 0.03 if bpy.app.version >= (4, 5, 0) else 0.045
    assert np.abs(found - expected).mean() < tolerance * expected.mean()
    assert np.abs(coarse - expected).mean() > 0.05 * expected.mean()


@pytest.fixture
def terrain(scene: bpy.types.Scene) -> bpy.types.Object:
    """Returns a displaced plain with corners far outside of the picture, whose camera stands on it."""
    images.prepare(scene)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=200.0)
    terrain = bpy.context.object
    bpy.ops.object.shade_smooth()
    displaced(terrain, "Object", {"Scale": 0.5, "Detail": 3.0}, 1.5, (1.1, math.radians(75.0)))
    scene.camera.location = (0.0, 0.0, 2.0)
    return terrain


def test_a_terrain_to_the_horizon_is_diced_as_in_cycles(
    scene: bpy.types.Scene, terrain: bpy.types.Object, tmp_path: Path
) -> None:
    coarse = picture(scene, tmp_path, "GRADUS")
    dice(terrain, scene, 1.0)
    expected, found = pictures(scene, tmp_path)
    assert np.abs(found - expected).mean() < 0.04 * expected.mean()
    assert np.abs(coarse - expected).mean() > 0.2 * expected.mean()


def test_triangles_are_as_small_as_in_cycles_near_and_far(
    scene: bpy.types.Scene, terrain: bpy.types.Object, tmp_path: Path
) -> None:
    dice(terrain, scene, 6.0)
    material = terrain.data.materials[0]
    graph = Graph(material)
    lines = graph("Emission", "Emission", {"Color": graph("Wireframe", "Fac", {"Size": 0.2}, use_pixel_size=True)})
    graph.tree.links.new(lines, output_of(material).inputs["Surface"])
    expected, found = pictures(scene, tmp_path)
    # Rows of blocks from the camera's feet to the horizon. Twice the triangles have 1.4 times the length of lines.
    for rows in (slice(0, 2), slice(2, 4)):
        assert found[rows].mean() == pytest.approx(expected[rows].mean(), rel=0.15)


def test_the_rate_and_its_limits_are_exported(scene: bpy.types.Scene, ball: bpy.types.Object) -> None:
    from gradus.export.dicing import NO_DICING, dicing_of

    assert dicing_of(ball, scene, 64, False) == NO_DICING
    dice(ball, scene, 2.0)
    scene.cycles.dicing_rate, scene.cycles.preview_dicing_rate = 1.5, 6.0
    scene.cycles.max_subdivisions, scene.cycles.offscreen_dicing_scale = 9, 3.0
    found = dicing_of(ball, scene, 64, False)
    assert (found.levels, found.offscreen_scale) == (9, 3.0)
    assert found.rate == pytest.approx(3.0 / 64.0)
    assert found.tolerance == 1.0
    preview = dicing_of(ball, scene, 64, True)
    assert preview.rate == pytest.approx(12.0 / 64.0)
    assert preview.tolerance == 2.0
    modifier = ball.modifiers[-1]
    if hasattr(modifier, "adaptive_space"):
        modifier.adaptive_space, modifier.adaptive_object_edge_length = "OBJECT", 0.25
        found = dicing_of(ball, scene, 64, False)
        assert (found.rate, found.length) == (0.0, 0.25)
    modifier.show_render = False
    assert dicing_of(ball, scene, 64, False) == NO_DICING


def test_meshes_are_diced_for_the_dicing_camera(
    scene: bpy.types.Scene, terrain: bpy.types.Object, tmp_path: Path
) -> None:
    """A camera far above the plain sees all its triangles as small; those at the feet of the other one stay large."""
    dice(terrain, scene, 6.0)
    near, _ = pictures(scene, tmp_path)
    above = recording.add(bpy.data.cameras.new("Above"), "Above", (0.0, 0.0, 150.0))
    scene.cycles.dicing_camera = above
    expected, found = pictures(scene, tmp_path)
    difference = np.abs(expected - near).mean()
    assert difference > 0.05 * expected.mean()
    assert np.abs(found - expected).mean() < 0.5 * difference
    recorded = recording.export(scene)[0].dicing_camera
    assert tuple(recorded.matrix[12:15]) == (0.0, 0.0, 150.0)
    scene.cycles.dicing_camera = None
    assert recording.export(scene)[0].dicing_camera is None
