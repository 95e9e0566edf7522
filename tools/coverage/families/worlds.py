"""Rows of the properties of a world: its nodes, mist, occlusion, visibility and sampling."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from .. import rna, stages
from ..row import NOISY, Family, Row

SKIPPED = ("sun_*", "use_sun_*", "probe_*", "use_eevee*", "cycles_visibility", "*viewport*")
"""Properties of EEVEE."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    world = bpy.data.worlds.new("Probe")
    family = Family("World", "World", stage, NOISY)
    yield family.row("", remove)
    yield from family.rows(rna.changes(world, SKIPPED, ("mist_settings", "light_settings")))
    yield from family.rows(rna.of_part("cycles", rna.changes(world.cycles)))
    visibility = getattr(world, "cycles_visibility", None)
    if visibility is not None:
        yield from family.rows(rna.of_part("cycles_visibility", rna.changes(visibility)))
    plain = Family("World", "World without nodes", stage_without_nodes, NOISY)
    yield plain.row(".color", recolor)


def stage() -> Any:
    stages.room()
    layer = bpy.context.scene.view_layers[0]
    layer.use_pass_mist = layer.use_pass_ambient_occlusion = True
    world = bpy.context.scene.world
    world.mist_settings.start, world.mist_settings.depth = 3.0, 5.0
    return world


def stage_without_nodes() -> Any:
    world = stage()
    world.node_tree.nodes.clear()
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = False
    world.color = (0.3, 0.5, 0.7)
    return world


def remove(_world: Any) -> None:
    bpy.context.scene.world = None


def recolor(world: Any) -> None:
    world.color = (0.7, 0.2, 0.4)
