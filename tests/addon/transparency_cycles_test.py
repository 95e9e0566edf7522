"""Rays pass as many transparent surfaces as those of Cycles in the same Blender, and end as these do."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images
from support.cycles import pictures
from support.nodes import new_world, shader_material

SHEETS = 5


def add_plane(look: bpy.types.Material, location: tuple[float, float, float], size: tuple[float, float]) -> None:
    """Adds a vertical plane that faces the camera, or a horizontal one below it if its location is lower."""
    is_floor = location[2] < -2.0
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=location, rotation=(0.0 if is_floor else np.pi / 2, 0.0, 0.0))
    bpy.context.object.scale = (*size, 1.0)
    bpy.context.object.data.materials.append(look)


@pytest.fixture
def sheets() -> bpy.types.Scene:
    """Returns a scene with 0 to 5 clear sheets, from left to right, and a mirror below.

    Behind the sheets are a wall that is lit, a wall that emits and the world. The sun lights them through the sheets.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    clear = shader_material("BsdfTransparent", {"Color": (0.9, 0.8, 0.7, 1.0)})
    for i in range(SHEETS):
        left = -3.0 + 1.3 * i
        add_plane(clear, (0.5 * (left + 9.0), -2.0 + 0.5 * i, 0.0), (9.0 - left, 12.0))
    add_plane(shader_material("BsdfDiffuse", {"Color": (0.8, 0.8, 0.8, 1.0)}), (0.0, 2.0, -0.9), (14.0, 1.4))
    add_plane(shader_material("Emission", {"Strength": 0.7}), (0.0, 2.0, 0.4), (14.0, 1.2))
    mirror = shader_material("BsdfAnisotropic", {"Color": (0.7, 0.7, 0.7, 1.0), "Roughness": 0.0})
    add_plane(mirror, (0.0, -3.0, -2.2), (14.0, 4.0))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -9.0, 0.0), (1.5, 0.0, 0.0)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 2.0, 0.0, (0.9, 0.0, 0.5)
    for item in (camera, sun):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.2, 0.3, 0.5)
    return scene


@pytest.mark.parametrize("limit", [0, 1, 2, 4])
def test_rays_end_behind_the_last_transparent_surface(sheets: bpy.types.Scene, tmp_path: Path, limit: int) -> None:
    """They ended at the surface that was one too many, and were lit at the one before."""
    sheets.cycles.transparent_max_bounces = limit
    cycles, gradus = pictures(sheets, tmp_path, 64)
    assert cycles.max() > 0.5
    assert cycles.min() < 0.01  # behind too many sheets
    np.testing.assert_allclose(gradus, cycles, atol=0.02)


@pytest.mark.parametrize("limit", [0, 8])
def test_rays_pass_lights_without_a_limit(sheets: bpy.types.Scene, tmp_path: Path, limit: int) -> None:
    """Cycles counts lights among the transparent surfaces, and a warning names it (cycles_settings_test.py)."""
    for item in [item for item in sheets.objects if item.type == "MESH"]:
        bpy.data.objects.remove(item)
    light = bpy.data.objects.new("Area", bpy.data.lights.new("Area", "AREA"))
    light.data.energy, light.data.size, light.visible_camera = 100.0, 40.0, True
    light.location, light.rotation_euler = (0.0, -2.0, 0.0), (-np.pi / 2, 0.0, 0.0)
    sheets.collection.objects.link(light)
    sheets.world = new_world((0.2, 0.3, 0.5))
    sheets.cycles.transparent_max_bounces = limit
    cycles, gradus = pictures(sheets, tmp_path, 4)
    assert gradus.min() > 0.15  # the world behind the light
    assert (cycles.min() > 0.15) == (limit > 0)
    if limit > 0:
        np.testing.assert_allclose(gradus, cycles, atol=1e-3)
