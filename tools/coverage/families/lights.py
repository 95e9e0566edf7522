"""Rows of the types of lights and of their properties: a light over a floor with a ball that casts a shadow."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import bpy

from .. import rna, stages
from ..row import NOISY, Family, Row

ENERGY = {"SUN": 3.0, "AREA": 80.0}  # others have 150 W

SKIPPED = ("type", "shadow_[!s]*", "contact_*", "use_contact*", "cutoff_distance", "use_custom_distance")
"""Properties of EEVEE, and the type, which has rows of its own."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for kind in rna.enum_values(bpy.data.lights.new("Probe", "POINT"), "type"):
        yield from rows_of(kind)


def rows_of(kind: str) -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    light = bpy.data.lights.new("Probe", kind)
    family = Family("Lights", f"Light {kind}", partial(stage, kind), NOISY)
    yield family.row("", brighten)
    yield from family.rows(rna.of_part("data", rna.changes(light, SKIPPED)))
    yield from family.rows(rna.of_part("data.cycles", rna.changes(light.cycles)))
    yield family.row(".data.node_tree", use_nodes)
    yield family.row(".scale", scale)
    yield family.row(".scale with Normal in its nodes", partial(scale_with_nodes, "Normal"))
    yield family.row(" instances with Random in its nodes", partial(instance_with_nodes, "Random"))


def stage(kind: str) -> Any:
    stages.mesh("PLANE", stages.material(), "Floor", scale=(4.0, 4.0, 1.0))
    glossy = stages.material("BsdfGlossy", (0.7, 0.6, 0.5), Roughness=0.5)
    stages.mesh("SPHERE", glossy, "Ball", scale=(0.5,) * 3, location=(-0.4, 0.3, 0.6))
    stages.black_world()
    stages.camera((0.0, -4.5, 3.5), (0.0, 0.0, 0.4), lens=45.0)
    return stages.light(kind, ENERGY.get(kind, 150.0), location=(0.9, -0.6, 1.9), rotation_euler=(0.35, 0.3, 0.2))


def brighten(light: Any) -> None:
    light.data.energy *= 2.0


def use_nodes(light: Any) -> None:
    tree, output = stages.empty_tree(light.data, "ShaderNodeOutputLight")
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (0.9, 0.5, 0.3, 1.0), 0.7
    tree.links.new(node.outputs[0], output.inputs["Surface"])


def scale(light: Any) -> None:
    light.scale = (1.5, 0.7, 1.2)


def show_in_nodes(light: Any, kind: str, output: str) -> None:
    """Makes the light's colour of an output of a node, without negative values."""
    tree, last = stages.empty_tree(light.data, "ShaderNodeOutputLight")
    source, emission = tree.nodes.new(kind), tree.nodes.new("ShaderNodeEmission")
    absolute = tree.nodes.new("ShaderNodeVectorMath")
    absolute.operation = "ABSOLUTE"
    tree.links.new(next(socket for socket in source.outputs if socket.name == output), absolute.inputs[0])
    tree.links.new(absolute.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], last.inputs["Surface"])


def scale_with_nodes(output: str, light: Any) -> None:
    scale(light)
    show_in_nodes(light, "ShaderNodeTexCoord", output)


def instance_with_nodes(output: str, light: Any) -> None:
    """Shows two instances of the light in place of the light."""
    show_in_nodes(light, "ShaderNodeObjectInfo", output)
    light.pass_index = 2
    instanced = bpy.data.collections.new("Instanced")
    instanced.objects.link(light)
    bpy.context.scene.collection.objects.unlink(light)
    for x, color in ((-0.9, (0.8, 0.4, 0.2, 0.6)), (0.4, (0.3, 0.5, 0.9, 0.8))):
        empty = stages.add(None, "Instancer", location=(x, 0.0, 0.0), color=color)
        empty.instance_type, empty.instance_collection = "COLLECTION", instanced
