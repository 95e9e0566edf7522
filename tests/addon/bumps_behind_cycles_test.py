"""Bumps of surfaces that are seen from behind are those of Cycles in the same Blender.

There, bumps of values that are interpolated on a face are the same on both of its sides, and bumps of values that are
computed from positions stand out on both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import cycles, recording
from support.nodes import Graph, new_material, new_world, output_of, show

Socket = bpy.types.NodeSocket

COORDINATES: dict[str, Callable[[Graph], Socket]] = {
    "generated": lambda g: g("TexCoord", "Generated"),
    "UV": lambda g: g("TexCoord", "UV"),
    "UV map": lambda g: g("UVMap", "UV"),
    "attribute": lambda g: g("Attribute", "Vector", attribute_name="Place"),
    "parametric": lambda g: g("NewGeometry", "Parametric"),
    "object": lambda g: g("TexCoord", "Object"),
    "position": lambda g: g("NewGeometry", "Position"),
}
# Before 4.5 bumps of Cycles compare heights of neighbouring pixels, which are far apart here.
SCALE, TOLERANCE = (1.0, 0.12) if bpy.app.version >= (4, 5, 0) else (0.7, 0.2)
SIDES = {"front": 0.0, "behind": math.pi}


def waves(graph: Graph, coordinates: str) -> Socket:
    vector = COORDINATES[coordinates](graph)
    noise = graph("TexNoise", "Color", {"Vector": vector, "Scale": 1.5, "Detail": 0.0})
    return graph("SeparateXYZ", "X", {"Vector": noise})


def bumped(graph: Graph, coordinates: str) -> Socket:
    return graph("Bump", "Normal", {"Height": waves(graph, coordinates), "Distance": 0.6})


@pytest.fixture
def plane(scene: bpy.types.Scene) -> bpy.types.Object:
    """Returns a plane with an attribute, tilted before the camera under a sun and a grey world."""
    recording.add_camera(lens=60.0)
    scene.camera.location, scene.camera.rotation_euler = (0.0, -5.0, 0.0), (1.571, 0.0, 0.0)
    bpy.ops.mesh.primitive_plane_add(size=2.4)
    plane = bpy.context.object
    places = [tuple(vertex.co) for vertex in plane.data.vertices]
    attribute = plane.data.attributes.new("Place", "FLOAT_VECTOR", "POINT")
    for value, place in zip(attribute.data, places, strict=True):
        value.vector = (0.8 * place[0], place[1], 0.3)
    sun = recording.add(bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 2.0, 0.1, (0.9, 0.3, 0.4)
    scene.world = new_world((0.3, 0.3, 0.3))
    scene.cycles.sample_clamp_indirect = scene.cycles.blur_glossy = 0.0
    return plane


def compare(scene: bpy.types.Scene, folder: Path) -> None:
    """Compares the middle of the pictures, which the plane fills."""
    expected, found = (image[2:7, 4:12] for image in cycles.pictures(scene, folder))
    assert expected.std(axis=(0, 1)).max() > 0.015, "the bumps do not show"
    error = np.abs(found - expected).mean()
    print(f"  {error:.4f} of {expected.mean():.3f}, which varies by {expected.std(axis=(0, 1)).max():.3f}")
    assert error < TOLERANCE * expected.std(axis=(0, 1)).max()


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("coordinates", COORDINATES)
def test_normals_of_bumps(
    plane: bpy.types.Object, scene: bpy.types.Scene, tmp_path: Path, coordinates: str, side: str
) -> None:
    """Regression: bumps of generated and UV coordinates and of attributes were inverted behind."""
    material = new_material("Bumped")
    graph = Graph(material)
    inputs = {"Vector": bumped(graph, coordinates), "Vector_001": (0.5, 0.5, 0.5), "Vector_002": (0.5, 0.5, 0.5)}
    show(material, graph("VectorMath", "Vector", inputs, operation="MULTIPLY_ADD"))
    plane.data.materials.append(material)
    plane.rotation_euler = (1.3 + SIDES[side], 0.0, 0.2)
    compare(scene, tmp_path)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("coordinates", ["generated", "UV", "object"])
def test_bumps_by_displacement(
    plane: bpy.types.Object, scene: bpy.types.Scene, tmp_path: Path, coordinates: str, side: str
) -> None:
    material = new_material("Displaced")
    graph = Graph(material)
    show(material, graph("BsdfDiffuse", "BSDF"))
    moved = graph("Displacement", "Displacement", {"Height": waves(graph, coordinates), "Scale": SCALE})
    graph.tree.links.new(moved, output_of(material).inputs["Displacement"])
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = "BUMP"
    plane.data.materials.append(material)
    plane.rotation_euler = (1.3 + SIDES[side], 0.0, 0.2)
    compare(scene, tmp_path)


def test_bumps_within_a_ball(plane: bpy.types.Object, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Light that leaves a solid passes its bumps from behind."""
    material = new_material("Clear")
    graph = Graph(material)
    inputs = {"Normal": bumped(graph, "generated"), "Roughness": 0.2, "IOR": 1.2}
    show(material, graph("BsdfRefraction", "BSDF", inputs))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, location=(0.0, -1.0, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)
    plane.rotation_euler, plane.location = (1.57, 0.0, 0.0), (0.0, 1.0, 0.0)
    checks = new_material("Checks")
    graph = Graph(checks)
    show(checks, graph("TexChecker", "Color", {"Scale": 2.0}))
    plane.data.materials.append(checks)
    compare(scene, tmp_path)
