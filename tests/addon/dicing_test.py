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


@pytest.fixture
def ball(scene: bpy.types.Scene) -> bpy.types.Object:
    """Returns a displaced ball with a Subdivision modifier of one level."""
    images.prepare(scene)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=1.3)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    modifier = ball.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    material = new_material()
    graph = Graph(material)
    waves = graph("TexNoise", "Fac", {"Vector": graph("TexCoord", "Generated"), "Scale": 8.0, "Detail": 0.0})
    moved = graph("Displacement", "Displacement", {"Height": waves, "Midlevel": 0.5, "Scale": 0.7})
    graph.tree.links.new(graph("BsdfDiffuse", "BSDF"), output_of(material).inputs["Surface"])
    graph.tree.links.new(moved, output_of(material).inputs["Displacement"])
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = "DISPLACEMENT"
    ball.data.materials.append(material)
    sun = recording.add(bpy.data.lights.new("Sun", "SUN"), "Sun")
    sun.data.energy, sun.rotation_euler = 3.0, (0.6, 0.5, 0.0)
    camera = recording.add(bpy.data.cameras.new("Camera"), "Camera", (0.0, -6.0, 0.0))
    camera.rotation_euler = (math.radians(90.0), 0.0, 0.0)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    return ball


def test_a_diced_mesh_is_displaced_as_in_cycles(scene: bpy.types.Scene, ball: bpy.types.Object, tmp_path: Path) -> None:
    coarse = picture(scene, tmp_path, "GRADUS")
    dice(ball, scene, 1.0)
    expected, found = pictures(scene, tmp_path)
    # Cycles before 4.5 has another limit surface.
    tolerance = 0.03 if bpy.app.version >= (4, 5, 0) else 0.045
    assert np.abs(found - expected).mean() < tolerance * expected.mean()
    assert np.abs(coarse - expected).mean() > 0.05 * expected.mean()


def test_the_rate_and_its_limits_are_exported(scene: bpy.types.Scene, ball: bpy.types.Object) -> None:
    from gradus.export.dicing import NO_DICING, dicing_of

    assert dicing_of(ball, scene, 64, False) == NO_DICING
    dice(ball, scene, 2.0)
    scene.cycles.dicing_rate, scene.cycles.preview_dicing_rate = 1.5, 6.0
    scene.cycles.max_subdivisions, scene.cycles.offscreen_dicing_scale = 9, 3.0
    found = dicing_of(ball, scene, 64, False)
    assert (found.levels, found.offscreen_scale) == (9, 3.0)
    assert found.rate == pytest.approx(3.0 / 64.0)
    assert dicing_of(ball, scene, 64, True).rate == pytest.approx(12.0 / 64.0)
    modifier = ball.modifiers[-1]
    if hasattr(modifier, "adaptive_space"):
        modifier.adaptive_space, modifier.adaptive_object_edge_length = "OBJECT", 0.25
        found = dicing_of(ball, scene, 64, False)
        assert (found.rate, found.length) == (0.0, 0.25)
    modifier.show_render = False
    assert dicing_of(ball, scene, 64, False) == NO_DICING


def test_another_dicing_camera_is_named(scene: bpy.types.Scene, ball: bpy.types.Object) -> None:
    dice(ball, scene, 8.0)
    assert recording.export(scene)[1].warnings == []
    scene.cycles.dicing_camera = recording.add(bpy.data.cameras.new("Other"), "Other")
    warnings = recording.export(scene)[1].warnings
    assert len(warnings) == 1 and "dicing camera is ignored" in warnings[0]
