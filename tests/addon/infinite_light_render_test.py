"""Light whose strength is not finite, or exceeds what sums of samples hold, is named and leaves the picture finite."""

from __future__ import annotations

import math
from collections.abc import Callable

import bpy
import numpy as np
import pytest
from gradus import store
from support import recording
from support.nodes import Graph, new_material, show


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


def infinite(tree: bpy.types.NodeTree, coordinates: str) -> bpy.types.NodeSocket:
    """Returns a vector of nodes whose values are infinite at most points."""
    found = tree.nodes.new("ShaderNodeTexCoord").outputs[coordinates]
    for _ in range(2):
        product = tree.nodes.new("ShaderNodeVectorMath")
        product.operation, product.inputs[1].default_value = "MULTIPLY", (3e38, 3e38, 3e38)
        tree.links.new(found, product.inputs[0])
        found = product.outputs[0]
    return found


def add_surface(scene: bpy.types.Scene, kind: str) -> Graph:
    """Adds a square whose material has no surface yet, under a grey sky."""
    set_world(scene, 1.0)
    material = new_material(kind)
    recording.add(recording.grid(2), "Square").data.materials.append(material)
    return Graph(material)


def surface_of_nodes(scene: bpy.types.Scene) -> str:
    graph = add_surface(scene, "Glowing")
    show(bpy.data.materials["Glowing"], graph("Emission", "Emission", {"Color": infinite(graph.tree, "Object")}))
    return "light, closures or bumps of 'Glowing' were left out where they are not finite"


def bump_of_nodes(scene: bpy.types.Scene) -> str:
    graph = add_surface(scene, "Bumpy")
    normal = graph("Bump", "Normal", {"Height": infinite(graph.tree, "Object")})
    show(bpy.data.materials["Bumpy"], graph("BsdfDiffuse", "BSDF", {"Normal": normal}))
    return "light, closures or bumps of 'Bumpy' were left out where they are not finite"


def sky_of_nodes(scene: bpy.types.Scene) -> str:
    tree = set_world(scene, 1.0)
    tree.links.new(infinite(tree, "Generated"), tree.nodes["Background"].inputs["Color"])
    return "light, closures or bumps of 'Sky' were left out where they are not finite"


@pytest.mark.parametrize(
    "make",
    [
        infinite_world,
        huge_world,
        world_of_nodes,
        huge_sun,
        surface_of_nodes,
        bump_of_nodes,
        sky_of_nodes,
    ],
)
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
