"""Textures and environments have the right orientation, shown by images with four colours."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
from support import recording

RED, GREEN, BLUE, YELLOW = (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0)
SETTINGS = {"samples": 4, "integrator": "PATH", "reconstruction": "NONE", "max_bounces": 0}


def _image(
    width: int, height: int, color_at: Callable[[float, float], tuple[float, float, float]], pack: bool
) -> bpy.types.Image:
    """Creates an image from rows that start at the bottom. Pure colours are equal in encoded and linear form."""
    block = bpy.data.images.new("Colours", width, height)
    pixels = [
        value
        for y in range(height)
        for x in range(width)
        for value in (*color_at((x + 0.5) / width, (y + 0.5) / height), 1.0)
    ]
    block.pixels.foreach_set(pixels)
    if pack:
        block.pack()
    return block


def _quarters(u: float, v: float) -> tuple[int, int, int]:
    return (RED if u < 0.5 else GREEN) if v < 0.5 else (BLUE if u < 0.5 else YELLOW)


def _emissive(image: bpy.types.Image) -> bpy.types.Material:
    material = bpy.data.materials.new("Picture")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    texture, emission, output = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("TexImage", "Emission", "OutputMaterial")
    )
    texture.image = image
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


@pytest.mark.parametrize("pack", [True, False])
def test_image_texture(scene: bpy.types.Scene, render: Callable[..., Any], pack: bool) -> None:
    """Red is at the lower left, green at the lower right, blue at the upper left, yellow at the upper right."""
    recording.add_camera(type="ORTHO", ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 32
    mesh = recording.grid(1)
    mesh.materials.append(_emissive(_image(16, 16, _quarters, pack)))
    recording.add(mesh)
    picture = render(scene, **SETTINGS)["Combined"]
    for (x, y), color in {(8, 8): RED, (24, 8): GREEN, (8, 24): BLUE, (24, 24): YELLOW}.items():
        assert np.allclose(picture[y, x, :3], color, atol=1e-3)


def _world(scene: bpy.types.Scene, image: bpy.types.Image, turn: float) -> None:
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    tree = world.node_tree
    coordinates, mapping, texture = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "Mapping", "TexEnvironment")
    )
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, turn)
    texture.image = image
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    scene.world = world


def _horizon(u: float, v: float) -> tuple[int, int, int]:
    """Returns an environment: red at +X, the centre of the image, green at +Y, blue at -X, yellow at -Y, white above,
    black below."""
    if v > 0.75:
        return (1, 1, 1)
    if v < 0.25:
        return (0, 0, 0)
    return (BLUE, GREEN, RED, YELLOW)[int((u * 4.0 + 0.5) % 4.0)]


# Rotations of a camera by its direction.
VIEWS = {
    "+X": ((math.pi / 2, 0, -math.pi / 2), RED),
    "+Y": ((math.pi / 2, 0, 0), GREEN),
    "-X": ((math.pi / 2, 0, math.pi / 2), BLUE),
    "-Y": ((math.pi / 2, 0, math.pi), YELLOW),
    # Not exactly at the poles, where bilinear interpolation reaches the opposite edge of the image, as in Cycles.
    "+Z": ((math.pi - 0.3, 0, 0), (1, 1, 1)),
    "-Z": ((0.3, 0, 0), (0, 0, 0)),
}


@pytest.mark.parametrize("direction", VIEWS)
def test_environment(scene: bpy.types.Scene, render: Callable[..., Any], direction: str) -> None:
    camera = recording.add_camera(lens=200.0)
    camera.rotation_euler, color = VIEWS[direction]
    scene.render.resolution_x = scene.render.resolution_y = 4
    _world(scene, _image(64, 32, _horizon, True), 0.0)
    assert np.allclose(render(scene, **SETTINGS)["Combined"][:, :, :3], color, atol=1e-3)


def test_rotated_environment(scene: bpy.types.Scene, render: Callable[..., Any]) -> None:
    """Mapping rotates the direction before the lookup: with +90 degrees about Z, +X shows what +Y showed."""
    camera = recording.add_camera(lens=200.0)
    camera.rotation_euler, _ = VIEWS["+X"]
    scene.render.resolution_x = scene.render.resolution_y = 4
    _world(scene, _image(64, 32, _horizon, True), math.pi / 2)
    assert np.allclose(render(scene, **SETTINGS)["Combined"][:, :, :3], GREEN, atol=1e-3)


def test_environment_lights_from_its_side(scene: bpy.types.Scene, render: Callable[..., Any]) -> None:
    """A white wall that faces +X receives mostly red light."""
    _world(scene, _image(64, 32, _horizon, True), 0.0)
    material = bpy.data.materials.new("White")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    mesh = recording.grid(1)
    mesh.materials.append(material)
    recording.add(mesh).rotation_euler = (0.0, math.pi / 2, 0.0)
    camera = recording.add_camera(type="ORTHO", ortho_scale=1.0)
    camera.location = (5, 0, 0)
    camera.rotation_euler = (math.pi / 2, 0, math.pi / 2)
    scene.render.resolution_x = scene.render.resolution_y = 8
    red, green, blue = render(scene, **{**SETTINGS, "samples": 256})["Combined"][:, :, :3].mean(axis=(0, 1))
    assert red > 1.3 * green > 0 and blue < 0.5 * red
