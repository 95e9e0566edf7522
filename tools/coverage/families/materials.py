"""Rows of the settings of materials, and of surfaces without nodes or without a material."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import bpy

from .. import rna, stages
from ..row import NOISY, Family, Row

SKIPPED = ("preview_*", "use_preview*", "paint_*", "show_*", "line_*", "lineart", "*_texture*", "grease_pencil")
"""Properties of the viewport, of painting and of Freestyle."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    material = stages.material()
    for name, maker in STAGES.items():
        family = Family("Materials", f"Material {name}", partial(stage, maker), NOISY)
        yield from family.rows(rna.changes(material, SKIPPED))
        yield from family.rows(rna.of_part("cycles", rna.changes(material.cycles)))
    yield Family("Materials", "Material absent", partial(stage, glass), NOISY).row("", remove)
    if bpy.app.version < (5, 0, 0):
        flat = Family("Materials", "Material without nodes", stage_without_nodes, NOISY)
        yield from flat.rows(rna.changes(material, SKIPPED))
    slots = Family("Materials", "Material slots", partial(stage, glass), NOISY)
    yield slots.row(" by object", link_to_object)
    yield slots.row(" by face", add_slot)


def glass() -> Any:
    return stages.material("BsdfGlass", (0.9, 0.8, 0.7))


def transparent() -> Any:
    return stages.material("BsdfTransparent", (0.5, 0.7, 0.6))


def emission() -> Any:
    return stages.material("Emission", (0.8, 0.4, 0.2))


STAGES = {"of glass": glass, "that is transparent": transparent, "that emits": emission}


def stage(maker: Any) -> Any:
    ball = stages.room()
    layer = bpy.context.scene.view_layers[0]
    layer.use_pass_material_index = True
    ball.data.materials[0] = maker()
    return ball.data.materials[0]


def stage_without_nodes() -> Any:
    material = stage(glass)
    material.use_nodes = False
    return material


def remove(_material: Any) -> None:
    bpy.data.objects["Ball"].data.materials.clear()


def link_to_object(_material: Any) -> None:
    slot = bpy.data.objects["Ball"].material_slots[0]
    slot.link = "OBJECT"
    slot.material = emission()


def add_slot(_material: Any) -> None:
    data = bpy.data.objects["Ball"].data
    data.materials.append(emission())
    for polygon in data.polygons:
        polygon.material_index = polygon.index % 2
