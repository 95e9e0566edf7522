"""Orientation at a glance: four colours on a wall and on a box, four colours around the horizon, a mirror ball between."""

from __future__ import annotations

import bpy

from . import common

RED, GREEN, BLUE, YELLOW = (0.8, 0.1, 0.1), (0.1, 0.7, 0.15), (0.1, 0.2, 0.8), (0.85, 0.75, 0.1)


def quarters(u: float, v: float) -> common.Color:
    """Lower left red, lower right green, upper left blue, upper right yellow."""
    if v < 0.5:
        return RED if u < 0.5 else GREEN
    return BLUE if u < 0.5 else YELLOW


def horizon(u: float, v: float) -> common.Color:
    """Around: -X red, -Y green, +X blue (the centre of the image), +Y yellow; darker below."""
    sector = int((u * 4.0 + 0.5) % 4.0)
    color = (RED, YELLOW, BLUE, GREEN)[sector]
    shade = 0.35 if v < 0.5 else 0.6 + 0.4 * v
    return tuple(min(1.0, shade * channel + (0.25 if v > 0.85 else 0.0)) for channel in color)


def _world(image: bpy.types.Image, turn: float) -> None:
    block = common.world((1, 1, 1), 1.0)
    tree = block.node_tree
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, turn)
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def _vertex_colours(obj: bpy.types.Object) -> None:
    """A byte colour on each corner of a box."""
    layer = obj.data.color_attributes.new("Col", "BYTE_COLOR", "CORNER")
    for index, item in enumerate(layer.data):
        item.color = (*(RED, GREEN, BLUE, YELLOW)[index % 4], 1.0)


def _attribute_material() -> bpy.types.Material:
    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = "Col"
        node = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(attribute.outputs["Color"], node.inputs["Color"])
        return node.outputs[0]

    return common.material("Vertex colours", build)


def build() -> None:
    """A board, a box with vertex colours, a generated-coordinates block, a mirror ball, all under the four-colour sky."""
    common.settings(640, 360)
    _world(common.image("Horizon", 128, 64, horizon), 0.0)
    board = common.textured("Board", common.image("Quarters", 64, 64, quarters), 0.6)
    common.quad("Board", [(-2.2, 0.8, 0.2), (-0.6, 0.8, 0.2), (-0.6, 0.8, 1.8), (-2.2, 0.8, 1.8)], board)
    common.quad("Ground", [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], common.diffuse("Ground", (0.5, 0.5, 0.5)))
    _vertex_colours(common.box("Colours", (1.5, -0.2, 0.4), (0.8, 0.8, 0.8), _attribute_material(), turn=30))
    common.sphere("Mirror", (0.2, 0.3, 0.6), 0.6, common.principled("Mirror", (0.95, 0.95, 0.95), 0.0, 1.0))

    def generated(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        checker = tree.nodes.new("ShaderNodeTexChecker")
        checker.inputs["Scale"].default_value = 4.0
        checker.inputs["Color1"].default_value = (0.8, 0.8, 0.75, 1.0)
        checker.inputs["Color2"].default_value = (0.1, 0.12, 0.2, 1.0)
        node = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(coordinates.outputs["Generated"], checker.inputs["Vector"])
        tree.links.new(checker.outputs["Color"], node.inputs["Color"])
        return node.outputs[0]

    common.box("Generated", (-1.2, -1.0, 0.25), (0.9, 0.5, 0.5), common.material("Generated", generated), turn=-20)
    common.camera((0.0, -5.0, 1.6), (0.0, 0.0, 0.8), lens=40)
