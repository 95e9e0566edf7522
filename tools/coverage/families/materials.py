"""Rows of the settings of materials, and of surfaces without nodes or without a material."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from .. import rna, stages
from ..row import NOISY, Family, Row

SKIPPED = ("preview_*", "use_preview*", "paint_*", "show_*", "line_*", "lineart", "*_texture*", "grease_pencil")
"""Properties of the viewport, of painting and of Freestyle."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    material = stages.material()
    family = Family("Materials", "Material", stage, NOISY)
    yield from family.rows(rna.changes(material, SKIPPED))
    yield from family.rows(rna.of_part("cycles", rna.changes(material.cycles)))
    yield family.row(" absent", remove)
    if bpy.app.version < (5, 0, 0):
        flat = Family("Materials", "Material without nodes", stage_without_nodes, NOISY)
        yield from flat.rows(rna.changes(material, SKIPPED))
    yield family.row(" of the object", link_to_object)
    yield family.row(" by face", add_slot)


def stage() -> Any:
    """Returns a material of a ball that is partly transparent, and emits."""
    ball = stages.room()
    bpy.context.scene.view_layers[0].use_pass_material_index = True
    block = stages.material("BsdfDiffuse", (0.9, 0.8, 0.7))
    tree = block.node_tree
    output, solid = (next(n for n in tree.nodes if n.type == kind) for kind in ("OUTPUT_MATERIAL", "BSDF_DIFFUSE"))
    mixed, clear, added, light = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "BsdfTransparent", "AddShader", "Emission")
    )
    light.inputs[0].default_value, light.inputs[1].default_value = (0.8, 0.4, 0.2, 1.0), 0.3
    tree.links.new(solid.outputs[0], mixed.inputs[1])
    tree.links.new(clear.outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], added.inputs[0])
    tree.links.new(light.outputs[0], added.inputs[1])
    tree.links.new(added.outputs[0], output.inputs["Surface"])
    ball.data.materials[0] = block
    return block


def stage_without_nodes() -> Any:
    material = stage()
    material.use_nodes = False
    return material


def remove(_material: Any) -> None:
    bpy.data.objects["Ball"].data.materials.clear()


def link_to_object(_material: Any) -> None:
    slot = bpy.data.objects["Ball"].material_slots[0]
    slot.link = "OBJECT"
    slot.material = stages.material("Emission", (0.8, 0.4, 0.2))


def add_slot(_material: Any) -> None:
    data = bpy.data.objects["Ball"].data
    data.materials.append(stages.material("Emission", (0.8, 0.4, 0.2)))
    for polygon in data.polygons:
        polygon.material_index = polygon.index % 2
