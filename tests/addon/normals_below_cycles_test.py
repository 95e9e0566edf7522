"""Normals that point below the surface give what they give in Cycles of the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import cycles, recording
from support.nodes import Graph, new_material, new_world, show, socket

Socket = bpy.types.NodeSocket


def black_map(graph: Graph) -> Socket:
    """Returns the normal of a map that is black."""
    return graph("NormalMap", "Normal", {"Color": (0.0, 0.0, 0.0, 1.0)})


def straight_down(graph: Graph) -> Socket:
    """Returns the opposite of the surface's normal."""
    return graph("VectorMath", "Vector", {"Vector": graph("NewGeometry", "Normal"), "Scale": -1.0}, operation="SCALE")


def slanted(graph: Graph) -> Socket:
    """Returns a normal of one direction for the whole ball, so that it is above the surface on one side only."""
    return graph("CombineXYZ", "Vector", {"X": 0.8, "Y": -0.5, "Z": 0.6})


NORMALS: dict[str, Callable[[Graph], Socket]] = {
    "black map": black_map,
    "straight down": straight_down,
    "slanted": slanted,
}

SHADERS: dict[str, tuple[str, dict[str, Any]]] = {
    "Diffuse": ("BsdfDiffuse", {}),
    "rough Diffuse": ("BsdfDiffuse", {"Roughness": 0.7}),
    "Glossy": ("BsdfAnisotropic", {"Roughness": 0.4}),
    "Glass": ("BsdfGlass", {"Roughness": 0.3}),
    "Refraction": ("BsdfRefraction", {"Roughness": 0.3}),
    "Toon": ("BsdfToon", {}),
    "Velvet": ("BsdfVelvet" if bpy.app.version < (4, 0, 0) else "BsdfSheen", {}),
    "Principled": ("BsdfPrincipled", {"Base Color": (0.8, 0.5, 0.3, 1.0)}),
}


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a smooth ball in a sun and a grey world."""
    camera = recording.add_camera(lens=60.0)
    camera.location, camera.rotation_euler = (0.0, -5.0, 0.0), (1.571, 0.0, 0.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    sun = recording.add(bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 2.0, 0.1, (0.9, 0.3, 0.4)
    scene.world = new_world((0.5, 0.5, 0.5))
    scene.cycles.sample_clamp_indirect = scene.cycles.blur_glossy = 0.0
    return scene


@pytest.mark.parametrize("shader", SHADERS)
@pytest.mark.parametrize("normal", NORMALS)
def test_normals_below(stage: bpy.types.Scene, tmp_path: Path, normal: str, shader: str) -> None:
    """Normals were mirrored to the side of the viewer, so that surfaces were grey which are nearly black in Cycles."""
    if bpy.app.version < (4, 0, 0) and normal == "slanted" and shader in {"Glass", "Refraction", "Velvet"}:
        pytest.skip("before 4.0 Cycles refracts light from the viewer's side of the surface, too")
    kind, inputs = SHADERS[shader]
    material = new_material()
    graph = Graph(material)
    out = graph(kind, "BSDF", inputs)
    graph.tree.links.new(NORMALS[normal](graph), socket(out.node.inputs, "Normal"))
    show(material, out)
    bpy.context.object.data.materials.append(material)
    expected, found = cycles.pictures(stage, tmp_path, 64)
    ball = (slice(1, 8), slice(4, 12))
    print(f"  {shader}: {expected[ball].mean():.4f}, found {found[ball].mean():.4f}")
    assert abs(found[ball].mean() - expected[ball].mean()) < 0.02 * expected[ball].mean() + 0.008
    assert np.abs(found - expected).mean() < 0.02
