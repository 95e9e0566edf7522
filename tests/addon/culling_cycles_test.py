"""Simplify leaves out the instances that it leaves out in Cycles of the same Blender."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import recording
from support.cycles import picture, pictures
from support.nodes import Graph, new_material, show

PLACES = [(x, y, z) for x in (-5.0, -2.6, -1.3, 0.4, 2.2, 4.7) for y in (-8.0, -5.8, -3.0) for z in (-0.8, 0.8)]
"""Around the camera: behind it, beside it, at the borders of the picture, and in it."""


def glowing() -> bpy.types.Material:
    material = new_material("Glow")
    show(material, Graph(material)("TexCoord", "Generated"))
    return material


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a camera at (0, -6, 0), which looks at a mirror that shows what is behind it."""
    recording.add_camera(lens=30.0, clip_start=0.3)
    scene.camera.location, scene.camera.rotation_euler = (0.0, -6.0, 0.0), (np.pi / 2, 0.0, 0.0)
    mirror = new_material("Mirror")
    show(mirror, Graph(mirror)("BsdfGlossy", "BSDF", {"Roughness": 0.0}))
    bpy.ops.mesh.primitive_plane_add(size=40.0, rotation=(np.pi / 2, 0.0, 0.25))
    bpy.context.object.data.materials.append(mirror)
    scene.render.use_simplify = True
    return scene


def add_cubes() -> list[bpy.types.Object]:
    material = glowing()
    bpy.ops.mesh.primitive_cube_add(size=0.5)
    first = bpy.context.object
    first.data.materials.append(material)
    cubes = [first]
    for index, place in enumerate(PLACES):
        cube = first if index == 0 else first.copy()
        cube.location, cube.rotation_euler = place, (0.2, 0.3 * index, 0.1)
        if index:
            bpy.context.scene.collection.objects.link(cube)
            cubes.append(cube)
    return cubes


def add_instances() -> list[bpy.types.Object]:
    """Adds a cube on each vertex of a mesh."""
    mesh = bpy.data.meshes.new("Points")
    mesh.from_pydata(PLACES, [], [])
    points = bpy.data.objects.new("Points", mesh)
    points.instance_type = "VERTS"
    bpy.context.scene.collection.objects.link(points)
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0.0, 0.0, 0.0))
    cube = bpy.context.object
    cube.data.materials.append(glowing())
    cube.parent = points
    return [cube]


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("way", ["distance", "camera", "both", "one or the other"])
@pytest.mark.parametrize("add", [add_cubes, add_instances])
def test_a9_instances_are_culled(add: object, way: str, kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    stage.camera.data.type = kind
    cubes = add()
    cycles = stage.cycles
    cycles.use_distance_cull, cycles.distance_cull_margin = way != "camera", 2.4
    cycles.use_camera_cull, cycles.camera_cull_margin = way != "distance", 0.05
    for index, cube in enumerate(cubes):
        cube.cycles.use_distance_cull = index % 2 == 0 if way == "one or the other" else True
        cube.cycles.use_camera_cull = index % 2 == 1 if way == "one or the other" else True
    expected, found = pictures(stage, tmp_path, 64)
    stage.render.use_simplify = False
    whole = picture(stage, tmp_path, "GRADUS")
    assert np.abs(expected - whole).max() > 0.2, "nothing is culled"
    assert np.abs(expected - found).max() < 0.04


@pytest.mark.parametrize("way", ["distance 0", "panorama", "without switches"])
def test_a9_instances_are_not_culled(way: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    cycles = stage.cycles
    cycles.use_distance_cull, cycles.use_camera_cull = True, way != "distance 0"
    cycles.distance_cull_margin = 0.0 if way == "distance 0" else 2.4
    if way == "panorama":
        stage.camera.data.type = "PANO"
    for cube in add_cubes():
        cube.cycles.use_distance_cull = cube.cycles.use_camera_cull = way != "without switches"
    expected, found = pictures(stage, tmp_path, 64)
    assert np.abs(expected - found).max() < 0.04
