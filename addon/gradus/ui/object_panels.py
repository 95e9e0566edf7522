"""Panels of objects: ray visibility, which Blender leaves to the engine, and the shadow terminator."""

from __future__ import annotations

from typing import Any

import bpy

from ..export import shadow_terminator
from ..export.visibility import RAY_SWITCHES
from .base import EnginePanel, draw_light_group

SURFACES = frozenset({"MESH", "CURVE", "SURFACE", "META", "FONT"})
SHOWN = SURFACES | {"LIGHT", "EMPTY"}  # empties may instance collections


class GRADUS_OBJECT_PT_ray_visibility(EnginePanel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.object is not None and context.object.type in SHOWN

    def draw(self, context: Any) -> None:
        layout, obj = self.columns(), context.object
        column = layout.column()
        for name, _ in RAY_SWITCHES:
            if name != "visible_volume_scatter":
                column.prop(obj, name, text=name.removeprefix("visible_").capitalize())
        if obj.type in SURFACES or obj.type == "LIGHT":
            layout.prop(obj, "is_shadow_catcher")
        if obj.type in SURFACES:
            layout.prop(obj, "is_holdout")


class GRADUS_OBJECT_PT_shadow_terminator(EnginePanel, bpy.types.Panel):
    bl_label = "Shadow Terminator"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        obj = context.object
        is_surface = obj is not None and obj.type in SURFACES
        return super().poll(context) and is_surface and shadow_terminator.owner(obj) is not None

    def draw(self, context: Any) -> None:
        owner = shadow_terminator.owner(context.object)
        column = self.columns().column()
        column.prop(owner, shadow_terminator.GEOMETRY_OFFSET, text="Geometry Offset")
        column.prop(owner, shadow_terminator.shading_offset_name(owner), text="Shading Offset")


class GRADUS_OBJECT_PT_light_group(EnginePanel, bpy.types.Panel):
    bl_label = "Light Group"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        obj = context.object
        return super().poll(context) and obj is not None and (obj.type in SURFACES or obj.type == "LIGHT")

    def draw(self, context: Any) -> None:
        draw_light_group(self.columns(), context.object, context.view_layer)


CLASSES = (GRADUS_OBJECT_PT_ray_visibility, GRADUS_OBJECT_PT_shadow_terminator, GRADUS_OBJECT_PT_light_group)
