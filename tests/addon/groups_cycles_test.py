"""Groups, muted nodes, reroutes and loops of links: inputs without a link act as in Cycles of the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images, recording
from support.cycles import picture, pictures
from support.nodes import Graph, new_material, show

Socket = bpy.types.NodeSocket
Use = Callable[[Graph, Socket], Socket]
"""Adds nodes that read a socket, and returns what they make of it."""

VALUES = {"Float": 0.3, "Vector": (0.4, 0.2, 0.7), "Color": (0.7, 0.3, 0.2, 1.0)}


class _Owner:
    """What `Graph` takes a tree from."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.node_tree = tree


def add_socket(tree: bpy.types.NodeTree, name: str, way: str, kind: str, is_hidden: bool) -> None:
    if hasattr(tree, "interface"):
        added = tree.interface.new_socket(name, in_out=way, socket_type=f"NodeSocket{kind}")
    else:
        added = (tree.inputs if way == "INPUT" else tree.outputs).new(f"NodeSocket{kind}", name)
    added.hide_value = is_hidden


def group(graph: Graph, kind: str, use: Use | None, is_hidden: bool = True) -> bpy.types.Node:
    """Adds a group that makes a colour of an input In. Without `use`, its output has no link."""
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    add_socket(tree, "In", "INPUT", kind, is_hidden)
    add_socket(tree, "Out", "OUTPUT", "Color", is_hidden)
    first, last = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    if use is not None:
        tree.links.new(use(Graph(_Owner(tree)), first.outputs[0]), last.inputs[0])
    node = graph.tree.nodes.new("ShaderNodeGroup")
    node.node_tree = tree
    node.inputs[0].default_value = VALUES[kind]
    return node


def noise(graph: Graph, vector: Socket) -> Socket:
    return graph("TexNoise", "Color", {"Vector": vector, "Scale": 2.0})


def halved(graph: Graph, value: Socket) -> Socket:
    return graph("Math", "Value", {"Value": value, "Value_001": 0.5}, operation="MULTIPLY")


def facing(graph: Graph, normal: Socket) -> Socket:
    return graph("LayerWeight", "Facing", {"Normal": normal})


def picture_of(graph: Graph, vector: Socket) -> Socket:
    image = bpy.data.images.new("gradient", 4, 4, float_buffer=True)
    image.pixels.foreach_set(np.linspace(0.0, 1.0, 64, dtype=np.float32))
    return graph("TexImage", "Color", {"Vector": vector}, image=image)


def value_of(graph: Graph, vector: Socket) -> Socket:
    return graph("VectorMath", "Vector", {"Vector": vector, "Vector_001": (0.1, 0.1, 0.1)}, operation="ADD")


def rerouted(use: Use) -> Use:
    def with_reroute(graph: Graph, value: Socket) -> Socket:
        node = graph.tree.nodes.new("NodeReroute")
        graph.tree.links.new(value, node.inputs[0])
        return use(graph, node.outputs[0])

    return with_reroute


def muted(use: Use) -> Use:
    """Reads a value through a muted node."""

    def with_muted(graph: Graph, value: Socket) -> Socket:
        passed = graph("VectorMath", "Vector", {"Vector": value})
        passed.node.mute = True
        return use(graph, passed)

    return with_muted


def nested(kind: str, use: Use, is_hidden: bool = True) -> Use:
    def with_group(graph: Graph, value: Socket) -> Socket:
        inner = group(graph, kind, use, is_hidden)
        graph.tree.links.new(value, inner.inputs[0])
        return inner.outputs[0]

    return with_group


def unlinked(kind: str, use: Use, is_hidden: bool = True) -> Callable[[Graph], Socket]:
    """Returns what makes a group whose input has no link."""
    return lambda graph: group(graph, kind, use, is_hidden).outputs[0]


def of_muted_group(graph: Graph) -> Socket:
    node = group(graph, "Vector", noise)
    node.mute = True
    return noise(graph, node.outputs[0])


def of_muted_node(graph: Graph) -> Socket:
    passed = graph("VectorMath", "Vector")
    passed.node.mute = True
    return noise(graph, passed)


def of_reroute(graph: Graph) -> Socket:
    return noise(graph, graph.tree.nodes.new("NodeReroute").outputs[0])


def of_group_without_tree(graph: Graph) -> Socket:
    node = group(graph, "Vector", noise)
    out = value_of(graph, node.outputs[0])
    tree = node.node_tree
    bpy.data.node_groups.remove(tree)
    return out


CASES: dict[str, Callable[[Graph], Socket]] = {
    "noise": unlinked("Vector", noise),
    "noise of a shown value": unlinked("Vector", noise, is_hidden=False),
    "noise of a number": unlinked("Float", noise),
    "noise of a color": unlinked("Color", noise, is_hidden=False),
    "image": unlinked("Vector", picture_of),
    "image of a shown value": unlinked("Vector", picture_of, is_hidden=False),
    "image of a number": unlinked("Float", picture_of),
    "image in a group in a group": unlinked("Vector", nested("Vector", picture_of)),
    "image in a group with a shown value in a group": unlinked("Vector", nested("Vector", picture_of, is_hidden=False)),
    "image in a group in a group with a shown value": unlinked("Vector", nested("Vector", picture_of), is_hidden=False),
    "image behind a reroute in a group": unlinked("Vector", rerouted(picture_of)),
    "normal": unlinked("Vector", facing),
    "normal of a shown value": unlinked("Vector", facing, is_hidden=False),
    "normal that is computed": lambda graph: facing(graph, graph("CombineXYZ", "Vector", {"X": 0.4, "Z": 0.7})),
    "value": unlinked("Vector", value_of),
    "shown value": unlinked("Vector", value_of, is_hidden=False),
    "group in a group": unlinked("Vector", nested("Vector", noise)),
    "group with a shown value in a group": unlinked("Vector", nested("Vector", noise, is_hidden=False)),
    "group in a group with a shown value": unlinked("Vector", nested("Vector", noise), is_hidden=False),
    "group in a group of another type": unlinked("Float", nested("Vector", noise), is_hidden=False),
    "reroute in a group": unlinked("Vector", rerouted(noise)),
    "muted node in a group": unlinked("Vector", muted(noise)),
    "muted node in a group with a shown value": unlinked("Vector", muted(noise), is_hidden=False),
    "output without a link": lambda graph: noise(graph, group(graph, "Vector", None).outputs[0]),
    "shown output without a link": lambda graph: noise(graph, group(graph, "Vector", None, False).outputs[0]),
    "muted group": of_muted_group,
    "muted node": of_muted_node,
    "reroute": of_reroute,
    "group without a tree": of_group_without_tree,
}


def reroute(graph: Graph) -> Socket:
    return graph.tree.nodes.new("NodeReroute").outputs[0]


def chain_of_reroutes(graph: Graph) -> Socket:
    last = graph.tree.nodes.new("NodeReroute")
    graph.tree.links.new(reroute(graph), last.inputs[0])
    return last.outputs[0]


def into_a_group(graph: Graph) -> Socket:
    node = group(graph, "Float", halved)
    graph.tree.links.new(reroute(graph), node.inputs[0])
    return node.outputs[0]


# Before Blender 5.0, a reroute without a link is a value of 0 that is linked.
CASES |= {
    "reroute to a number": lambda graph: graph("Math", "Value", {"Value": reroute(graph), "Value_001": 0.4}),
    "chain of reroutes": lambda graph: graph("Math", "Value", {"Value": chain_of_reroutes(graph), "Value_001": 0.4}),
    "reroute to a colour": lambda graph: graph("Gamma", "Color", {"Color": reroute(graph), "Gamma": 0.0}),
    "reroute to a group": lambda graph: graph("Math", "Value", {"Value": into_a_group(graph), "Value_001": 0.2}),
}


@pytest.fixture(scope="module")
def stage() -> bpy.types.Scene:
    """Returns a scene with a smooth sphere that fills the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    recording.add_camera(type="ORTHO", ortho_scale=1.2).location = (0.0, 0.0, 5.0)
    bpy.ops.mesh.primitive_uv_sphere_add(rotation=(0.7, 0.2, 0.3))
    bpy.ops.object.shade_smooth()
    return scene


@pytest.mark.parametrize("name", CASES)
def test_a9_inputs_without_a_link(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    material = new_material()
    show(material, CASES[name](Graph(material)))
    mesh = bpy.context.object.data
    mesh.materials.clear()
    mesh.materials.append(material)
    expected, found = pictures(stage, tmp_path)
    assert expected.max() > 0.01
    assert np.abs(expected - found).mean() < 0.01 * expected.mean()


def loop_of_numbers(graph: Graph) -> Socket:
    """Returns a value that is added to itself. Inputs whose links close a loop have their own values in Cycles."""
    first = graph("Math", "Value", {"Value": 0.25}, operation="ADD")
    second = graph("Math", "Value", {"Value": first, "Value_001": 0.125}, operation="ADD")
    graph.tree.links.new(second, first.node.inputs[0])
    return second


def loop_apart(graph: Graph) -> Socket:
    loop_of_numbers(graph)
    return graph("CombineXYZ", "Vector", {"X": 0.5})


def loop_in_a_group(graph: Graph) -> Socket:
    return group(graph, "Vector", lambda inner, value: loop_of_numbers(inner)).outputs[0]


def loop_through_a_group(graph: Graph) -> Socket:
    """Returns an output of a group that is linked to its own input. Cycles cuts the loop within the group."""
    node = group(graph, "Float", halved)
    graph.tree.links.new(node.outputs[0], node.inputs[0])
    return node.outputs[0]


def loop_through_a_reroute(graph: Graph) -> Socket:
    """Returns what a reroute passes on whose link closes a loop through a group."""
    node = group(graph, "Float", halved)
    added = graph("Math", "Value", {"Value": node.outputs[0], "Value_001": 0.25}, operation="ADD")
    way = graph.tree.nodes.new("NodeReroute")
    graph.tree.links.new(added, way.inputs[0])
    graph.tree.links.new(way.outputs[0], node.inputs[0])
    return added


def loop_of_shaders(graph: Graph) -> Socket:
    mixed = graph("MixShader", "Shader")
    graph.tree.links.new(graph("Emission", "Emission", {"Color": (0.5, 0.2, 0.1, 1.0)}), mixed.node.inputs[1])
    graph.tree.links.new(mixed, mixed.node.inputs[2])
    return mixed


LOOPS = [loop_of_numbers, loop_apart, loop_in_a_group, loop_through_a_group, loop_through_a_reroute, loop_of_shaders]


@pytest.mark.parametrize("make", LOOPS)
def test_a9_loops_of_links(make: Callable[[Graph], Socket], scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: from Blender 5.0 on, Cycles shows a material with a loop black. As it may hang, it is not run."""
    recording.add_camera(type="ORTHO", ortho_scale=1.2).location = (0.0, 0.0, 5.0)
    bpy.ops.mesh.primitive_uv_sphere_add()
    material = new_material()
    show(material, make(Graph(material)))
    bpy.context.object.data.materials.append(material)
    found = picture(scene, tmp_path, "GRADUS")
    expected = picture(scene, tmp_path, "CYCLES") if bpy.app.version < (5, 0, 0) else np.zeros_like(found)
    np.testing.assert_allclose(found, expected, atol=0.005)
