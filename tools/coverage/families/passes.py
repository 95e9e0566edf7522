"""Rows of the passes of view layers, and of the other settings of a view layer."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from typing import Any

import bpy

from .. import rna, stages
from ..row import FAINT, NOISY, Family, Row

SKIPPED = (
    "use",
    "samples",
    "active_*",
    "freestyle*",
    "use_freestyle",
    "depsgraph",
    "eevee",
    "gradus",
    "pass_cryptomatte_depth",
)
"""Properties of Freestyle and other engines. Blender itself crashes where the only view layer is not in use."""


LIGHT = re.compile(r"\.(use_pass_\w+_)(?:in)?direct=on")
"""Rows of passes with light that is divided by a colour."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    layer = bpy.context.scene.view_layers[0]
    family = Family("Passes and view layers", "View layer", stage, NOISY)
    parts = Family(family.title, family.name, stage_with_wall, FAINT)
    for suffix, change in rna.changes(layer, SKIPPED):
        if light := LIGHT.fullmatch(suffix):
            yield parts.row(suffix, partial(change_with_color, change, f"{light[1]}color"))
        else:
            yield family.row(suffix, change)
    yield from family.rows(rna.of_part("cycles", rna.changes(layer.cycles, ("name",))))
    yield family.row(".samples", take_samples)
    yield family.row(".material_override", override_material)
    clear = Family(family.title, "View layer above a transparent film", stage_above_clear_film, NOISY)
    yield clear.row(".use_pass_environment=on", show_environment)
    yield family.row(" second layer", add_layer)
    for kind in rna.enum_values(layer.aovs.add(), "type"):
        yield family.row(f" AOV {kind}", partial(add_aov, kind))
    if hasattr(layer, "lightgroups"):
        yield family.row(" light group", add_light_group)
    if hasattr(layer, "world_override"):
        yield family.row(".world_override", override_world)


def stage() -> Any:
    """Shows a room without caustics, whose noise passes of indirect light would show."""
    stages.room()
    cycles = bpy.context.scene.cycles
    cycles.caustics_reflective = cycles.caustics_refractive = False
    bpy.context.scene.world.mist_settings.start = 3.0
    bpy.context.scene.world.mist_settings.depth = 5.0
    for index, obj in enumerate(bpy.context.scene.objects):
        obj.pass_index = index + 1
        if obj.type == "MESH":
            obj.data.materials[0].pass_index = 2 * index + 1
    return bpy.context.scene.view_layers[0]


def stage_with_wall() -> Any:
    """Shows the room with a white wall in the sun behind it, because passes of little indirect light are noise."""
    layer = stage()
    place = {"scale": (4.0, 2.0, 1.0), "location": (0.0, 1.8, 1.6), "rotation_euler": (1.5708, 0.0, 0.0)}
    stages.mesh("PLANE", stages.material("BsdfDiffuse", (0.9, 0.9, 0.9)), "Wall", **place)
    return layer


def stage_above_clear_film() -> Any:
    layer = stage()
    bpy.data.objects["Floor"].hide_render = bpy.context.scene.render.film_transparent = True
    return layer


def change_with_color(change: rna.Change, color: str, layer: Any) -> None:
    """Switches a light pass on, and the pass of its colour if there is one."""
    change(layer)
    if hasattr(layer, color):
        setattr(layer, color, True)


def show_environment(layer: Any) -> None:
    layer.use_pass_environment = True


def take_samples(layer: Any) -> None:
    """Takes more samples than the scene asks for, so that the picture shows whether the layer's number counts."""
    layer.samples = 1024


def override_material(layer: Any) -> None:
    layer.material_override = stages.material("BsdfDiffuse", (0.3, 0.6, 0.4))


def override_world(layer: Any) -> None:
    world = bpy.data.worlds.new("Other")
    tree, output = stages.empty_tree(world, "ShaderNodeOutputWorld")
    shader = tree.nodes.new("ShaderNodeBackground")
    shader.inputs[0].default_value = (0.7, 0.3, 0.2, 1.0)
    tree.links.new(shader.outputs[0], output.inputs[0])
    layer.world_override = world


def add_layer(_layer: Any) -> None:
    bpy.context.scene.view_layers.new("Second").use_pass_normal = True


def add_aov(kind: str, layer: Any) -> None:
    aov = layer.aovs.add()
    aov.name, aov.type = "Extra", kind
    for obj in ("Ball", "Floor"):
        tree = bpy.data.objects[obj].data.materials[0].node_tree
        output = tree.nodes.new("ShaderNodeOutputAOV")
        if hasattr(output, "aov_name"):
            output.aov_name = "Extra"
        else:
            output.name = "Extra"
        output.inputs[0].default_value = (0.3, 0.7, 0.4, 1.0)
        output.inputs[1].default_value = 0.6


def add_light_group(layer: Any) -> None:
    group = layer.lightgroups.add(name="Sun")
    bpy.data.objects["Light"].lightgroup = group.name
