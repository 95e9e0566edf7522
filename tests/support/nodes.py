"""Helpers of the node tests: short definitions of materials, and resources that record requests."""

from __future__ import annotations

from typing import Any

import bpy


class Resources:
    """Records the keys of images in the order of requests."""

    pixel = (1.0 / 64.0, 1.0 / 36.0)

    def __init__(self) -> None:
        self.images: list[Any] = []
        self.aovs: dict[str, int] = {}

    def image(self, image: Any, image_user: Any, is_boxed: bool = False) -> int:
        if image not in self.images:
            self.images.append(image)
        return self.images.index(image) + 1

    def text(self, path: str, owner: Any) -> str | None:
        return None

    def view_layer_color(self, name: str) -> tuple[float, ...]:
        return (0.0, 0.0, 0.0, 0.0)

    def scene_time(self) -> tuple[float, float]:
        return (0.5, 12.0)

    def warn(self, text: str) -> None:
        raise AssertionError(text)


def new_material(name: str = "Material") -> bpy.types.Material:
    """Returns a material whose tree has only an output node."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    tree.nodes.new("ShaderNodeOutputMaterial")
    return material


def output_of(material: bpy.types.Material) -> bpy.types.Node:
    return next(node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")


def socket(sockets: Any, identifier: str) -> bpy.types.NodeSocket:
    return next(item for item in sockets if item.identifier == identifier)


def show(material: bpy.types.Material, source: bpy.types.NodeSocket) -> None:
    """Links a socket to the surface; values are linked through an emission."""
    tree = material.node_tree
    if source.type != "SHADER":
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(source, emission.inputs["Color"])
        source = emission.outputs[0]
    tree.links.new(source, output_of(material).inputs["Surface"])


class Graph:
    """A shorthand for building node trees."""

    def __init__(self, material: bpy.types.Material) -> None:
        self.tree = material.node_tree

    def __call__(
        self, kind: str, output: str, inputs: dict[str, Any] | None = None, **properties: Any
    ) -> bpy.types.NodeSocket:
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            target = socket(node.inputs, name)
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, target)
            else:
                target.default_value = value
        return socket(node.outputs, output)

    def place(self) -> bpy.types.NodeSocket:
        return self("TexCoord", "Object")


def translate(block: Any, kind: str = "SURFACE", resources: Resources | None = None) -> Any:
    from gradus import nodes

    return nodes.translate(block, kind, resources or Resources())


def op_names(program: Any) -> list[str]:
    """Returns the operations of a program in order."""
    from gradus.nodes.ops import Op

    return [Op(node[0]).name for node in program.nodes]


def shader_material(kind: str, inputs: dict[str, Any]) -> bpy.types.Material:
    """Returns a material of one shader node, whose inputs are linked to sockets or have values."""
    material = new_material(kind)
    show(material, Graph(material)(kind, "Emission" if kind == "Emission" else "BSDF", inputs))
    return material


def new_world(color: tuple[float, float, float]) -> bpy.types.World:
    """Returns a world of one colour in every version of Blender."""
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    background.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    return world
