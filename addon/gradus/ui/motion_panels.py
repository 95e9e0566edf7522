"""Panels of motion blur for scenes and objects.

Position and steps are properties of Cycles, which both engines share.
"""

from __future__ import annotations

from typing import Any

import bpy

from ..export import shutter
from .base import EnginePanel, RenderPanel
from .object_panels import SURFACES

CURVE_SHAPES = (
    ("SMOOTH", "SMOOTHCURVE"),
    ("ROUND", "SPHERECURVE"),
    ("ROOT", "ROOTCURVE"),
    ("SHARP", "SHARPCURVE"),
    ("LINE", "LINCURVE"),
    ("MAX", "NOCURVE"),
)
"""Presets of the shutter curve and their icons."""


class GRADUS_RENDER_PT_motion_blur(RenderPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        layout, scene = self.columns(), context.scene
        layout.active = scene.render.use_motion_blur
        owner = shutter.position_owner(scene)
        if owner is not None:
            layout.prop(owner, "motion_blur_position", text="Position")
        layout.prop(scene.render, "motion_blur_shutter", text="Shutter")
        layout.prop(scene.gradus, "vector_with_motion_blur")


class GRADUS_RENDER_PT_motion_blur_curve(RenderPanel, bpy.types.Panel):
    bl_label = "Shutter Curve"
    bl_parent_id = "GRADUS_RENDER_PT_motion_blur"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, render = self.layout, context.scene.render
        layout.active = render.use_motion_blur
        layout.template_curve_mapping(render, "motion_blur_shutter_curve")
        row = layout.row(align=True)
        for shape, icon in CURVE_SHAPES:
            row.operator("render.shutter_curve_preset", icon=icon, text="").shape = shape


class GRADUS_OBJECT_PT_motion_blur(EnginePanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        obj = context.object
        shown = obj is not None and obj.type in SURFACES | {"CAMERA", "EMPTY"}
        return super().poll(context) and shown and hasattr(getattr(obj, "cycles", None), "use_motion_blur")

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.object.cycles, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        layout, obj = self.columns(), context.object
        layout.active = context.scene.render.use_motion_blur and obj.cycles.use_motion_blur
        layout.prop(obj.cycles, "motion_steps", text="Steps")
        if obj.type in SURFACES:
            layout.prop(obj.cycles, "use_deform_motion", text="Deformation")


CLASSES = (GRADUS_RENDER_PT_motion_blur, GRADUS_RENDER_PT_motion_blur_curve, GRADUS_OBJECT_PT_motion_blur)
