"""Rows of modifiers: each type on a mesh. Engines get what modifiers have made of it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import bpy

from .. import stages
from ..row import Family, Row


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    family = Family("Modifiers", "Modifier", stage)
    obj = stages.mesh("CUBE")
    for kind in types():
        try:
            modifier = obj.modifiers.new("Probe", kind)
        except (TypeError, RuntimeError):
            continue
        if modifier is None:  # of another kind of object
            continue
        yield family.row(f" {kind}", partial(add, kind))
        obj.modifiers.clear()


def types() -> list[str]:
    return [item.identifier for item in bpy.types.Modifier.bl_rna.properties["type"].enum_items]


def stage() -> Any:
    """Shows a mesh that emits its coordinates, with other objects that modifiers may refer to."""
    block = bpy.data.materials.new("Coordinates")
    tree, output = stages.empty_tree(block, "ShaderNodeOutputMaterial")
    place, shader = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeEmission")
    tree.links.new(place.outputs["Generated"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    stages.mesh("PLANE", stages.checks(1.3), "Ground", scale=(6.0, 6.0, 1.0), location=(0.03, 0.02, -2.0))
    stages.mesh("SPHERE", block, "Target", location=(1.2, 0.4, 0.3), scale=(0.8, 0.7, 0.6))
    obj = stages.mesh("SPHERE", block, "Shown", rotation_euler=(0.2, 0.3, 0.4))
    stages.black_world()
    stages.camera((0.5, -6.0, 3.5))
    bpy.context.scene.frame_set(3)
    return obj


def add(kind: str, obj: Any) -> None:
    """Adds a modifier with another object, a vertex group and strengths that show."""
    modifier = obj.modifiers.new("Modifier", kind)
    for name, value in {
        "object": bpy.data.objects["Target"],
        "target": bpy.data.objects["Target"],
        "vertex_group": "Group" if kind in {"MASK", "VERTEX_WEIGHT_EDIT"} else None,
        "angle": 0.8,
        "factor": 0.4,
        "thickness": 0.2,
        "width": 0.3,
        "height": 0.5,
        "ratio": 0.5,
        "levels": 1,
        "render_levels": 2,
        "voxel_size": 0.2,
        "iterations": 2,
        "frame_duration": 6.0,
    }.items():
        prop = modifier.bl_rna.properties.get(name)
        if value is not None and prop is not None and not prop.is_readonly:
            try:
                setattr(modifier, name, value)
            except TypeError:  # a property of the same name and another type
                continue
