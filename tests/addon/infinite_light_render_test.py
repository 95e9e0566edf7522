"""Light whose strength is not finite, or exceeds what sums of samples hold, is named and leaves the picture finite."""

from __future__ import annotations

import math
from collections.abc import Callable

import bpy
import numpy as np
import pytest
from gradus import store
from support import recording


def set_world(scene: bpy.types.Scene, strength: float) -> bpy.types.NodeTree:
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    tree.nodes["Background"].inputs["Strength"].default_value = strength
    return tree


def infinite_world(scene: bpy.types.Scene) -> str:
    tree = set_world(scene, 1.0)
    tree.nodes["Background"].inputs["Color"].default_value = (math.inf, 1.0, 1.0, 1.0)
    return "the emission of 'Sky' "


def huge_world(scene: bpy.types.Scene) -> str:
    set_world(scene, 1e38)
    return "the emission of 'Sky' is too strong and was limited"


def world_of_nodes(scene: bpy.types.Scene) -> str:
    """A world whose strength goes from 0 to beyond all sums over the sky."""
    tree = set_world(scene, 1.0)
    place, product = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    product.operation, product.inputs[1].default_value = "MULTIPLY", (3e38, 3e38, 3e38)
    tree.links.new(place.outputs["Generated"], product.inputs[0])
    tree.links.new(product.outputs[0], tree.nodes["Background"].inputs["Color"])
    return "light that is not finite or too strong was left out"


def huge_sun(scene: bpy.types.Scene) -> str:
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = 3e38, 0.01
    recording.add(light, "Sun")
    return "1 lights were left out, the first is 'Sun': their values are not finite"


@pytest.mark.parametrize("make", [infinite_world, huge_world, world_of_nodes, huge_sun])
def test_light_beyond_all_numbers_is_named(
    scene: bpy.types.Scene,
    render: Callable[..., dict[str, np.ndarray]],
    make: Callable[[bpy.types.Scene], str],
) -> None:
    message = make(scene)
    recording.add_camera()
    scene.render.resolution_x = scene.render.resolution_y = 16
    found = render(scene, samples=8)["Combined"]
    assert np.isfinite(found).all()
    warnings = store.summaries[(scene.name, bpy.context.view_layer.name)]["warnings"]
    assert [text for text in warnings if text.startswith(message)], warnings
