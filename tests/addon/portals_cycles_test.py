"""Ray portals show what they show in Cycles of the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import cycles, images, recording
from support.nodes import Graph, new_material, show

pytestmark = pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeBsdfRayPortal"), reason="portals came with 4.2")

Socket = bpy.types.NodeSocket


def moved(graph: Graph, offset: tuple[float, ...]) -> Socket:
    """Returns the position of the surface, moved by an offset."""
    here = graph("NewGeometry", "Position")
    return graph("VectorMath", "Vector", {"Vector": here, "Vector_001": offset}, operation="ADD")


def portal(graph: Graph, **inputs: Any) -> Socket:
    return graph("BsdfRayPortal", "BSDF", inputs)


def mixed(graph: Graph, first: Socket, second: Socket) -> Socket:
    return graph("MixShader", "Shader", {"Shader": first, "Shader_001": second})


CASES: dict[str, Callable[[Graph], Socket]] = {
    "straight": lambda g: portal(g, Color=(0.5, 0.9, 0.7, 1.0)),
    "elsewhere": lambda g: portal(g, Position=moved(g, (2.0, 0.0, 0.3))),
    "turned": lambda g: portal(g, Position=moved(g, (0.0, 1.0, 0.5)), Direction=(0.1, 0.5, -1.0)),
    "turned in place": lambda g: portal(g, Direction=(0.3, 1.0, -0.2)),
    "diffuse, too": lambda g: mixed(g, portal(g, Position=moved(g, (2.0, 0.0, 0.0))), g("BsdfDiffuse", "BSDF")),
    "glossy, too": lambda g: mixed(g, portal(g), g("BsdfGlossy", "BSDF", {"Roughness": 0.2})),
    "into itself": lambda g: portal(g, Color=(0.9, 0.9, 0.9, 1.0), Position=moved(g, (0.0, -1.0, 0.0))),
}


def add_plane(shown: bpy.types.Material, size: float, location: tuple[float, ...], turn: float = 0.0) -> None:
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=(turn, 0.0, 0.0))
    bpy.context.object.data.materials.append(shown)


def build(scene: bpy.types.Scene, make: Callable[[Graph], Socket]) -> None:
    """Makes a floor of checks with a wall, both lit by a light and a grey world, and a portal before the wall."""
    images.prepare(scene)
    floor = new_material("Floor")
    checks = Graph(floor)
    color = checks("TexChecker", "Color", {"Vector": checks("TexCoord", "Object"), "Scale": 1.3})
    show(floor, checks("BsdfDiffuse", "BSDF", {"Color": color}))
    add_plane(floor, 12.0, (0.0, 0.0, 0.0))
    add_plane(floor, 12.0, (0.0, 3.0, 0.0), np.pi / 2)
    door = new_material("Door")
    show(door, make(Graph(door)))
    add_plane(door, 2.0, (0.0, 0.5, 0.8), np.pi / 2)
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    light = bpy.data.lights.new("Light", "AREA")
    light.energy, light.size = 150.0, 1.5
    recording.add(light, "Light", (1.0, -0.5, 3.0))
    camera = recording.add_camera()
    camera.location, camera.rotation_euler = (0.0, -4.0, 1.6), (1.35, 0.0, 0.0)
    scene.cycles.sample_clamp_indirect = 0.0


CLEAR = {
    "clear": lambda g: g("BsdfTransparent", "BSDF"),
    "half a portal": lambda g: mixed(g, portal(g), g("BsdfTransparent", "BSDF")),
}


@pytest.mark.parametrize("case", CASES)
def test_portals_show_what_they_show_in_cycles(scene: bpy.types.Scene, tmp_path: Path, case: str) -> None:
    build(scene, CASES[case])
    scene.cycles.transparent_max_bounces = 64
    expected, found = cycles.pictures(scene, tmp_path, 64)
    assert abs(found.mean() / expected.mean() - 1.0) < 0.01
    assert np.abs(found - expected).mean() < 0.05 * expected.mean()


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from 5.0 on, surfaces behind the limit show their emission")
def test_portals_end_with_the_limit_of_transparent_surfaces(scene: bpy.types.Scene, tmp_path: Path) -> None:
    build(scene, CASES["into itself"])
    scene.cycles.transparent_max_bounces = 2
    expected, found = cycles.pictures(scene, tmp_path, 64)
    assert np.abs(found - expected).mean() < 0.05 * expected.mean()


def test_light_through_a_half_transparent_portal_counts_once(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Cycles adds light samples that pass the transparent part to what rays find without weighting the two."""
    found = []
    for make in CLEAR.values():
        scene = bpy.data.scenes.new("Scene") if found else scene
        bpy.context.window.scene = scene
        build(scene, make)
        found.append(cycles.picture(scene, tmp_path, "GRADUS", 64))
    assert np.abs(found[1] - found[0]).mean() < 0.05 * found[0].mean()


def test_gradients_through_portals_are_unbiased(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """L2 keeps the mean of the picture. A biased gradient moves light between blocks of pixels."""
    build(scene, CASES["diffuse, too"])
    plain = cycles.picture(scene, tmp_path, "GRADUS", 256)
    joined = cycles.picture(scene, tmp_path, "GRADUS", 256, integrator="GRADIENT", reconstruction="L2")
    assert np.abs(joined - plain).mean() < 0.015 * plain.mean()
