"""Panels of view layers: passes, visibility and overrides.

Blender has switches of some passes, and Gradus adds others.
"""

from __future__ import annotations

from typing import Any

import bpy

from .. import passes
from .base import EnginePanel

DATA = ("use_pass_z", "use_pass_mist", "use_pass_position", "use_pass_normal", "use_pass_vector", "use_pass_uv")
INDEXES = ("use_pass_object_index", "use_pass_material_index")
LIGHT = tuple(
    (kind, tuple(f"use_pass_{kind}_{suffix}" for suffix in ("direct", "indirect", "color")))
    for kind in ("diffuse", "glossy", "transmission")
)
OTHER_LIGHT = ("use_pass_emit", "use_pass_environment", "use_pass_ambient_occlusion")


class ViewLayerPanel(EnginePanel):
    bl_context = "view_layer"


class PassPanel(ViewLayerPanel):
    """Mixin for panels above Blender's own panels of Cryptomatte, AOVs and light groups."""

    bl_parent_id = "VIEWLAYER_PT_layer_passes"
    bl_order = -1


class GRADUS_VIEWLAYER_PT_passes_data(PassPanel, bpy.types.Panel):
    bl_label = "Data"

    def draw(self, context: Any) -> None:
        layout, layer = self.columns(), context.view_layer
        column = layout.column(heading="Include", align=True)
        for name in DATA:
            column.prop(layer, name)
        column = layout.column(heading="Indexes", align=True)
        for name in INDEXES:
            column.prop(layer, name)
        layout.prop(layer, "pass_alpha_threshold")


class GRADUS_VIEWLAYER_PT_passes_light(PassPanel, bpy.types.Panel):
    bl_label = "Light"

    def draw(self, context: Any) -> None:
        layout, layer = self.columns(), context.view_layer
        for kind, names in LIGHT:
            column = layout.column(heading=kind.capitalize(), align=True)
            for name in names:
                column.prop(layer, name, text=name.rsplit("_", 1)[1].capitalize())
        column = layout.column(heading="Other", align=True)
        for name in OTHER_LIGHT:
            column.prop(layer, name)


class GRADUS_VIEWLAYER_PT_passes_gradus(PassPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context: Any) -> None:
        column = self.columns().column(heading="Include", align=True)
        for name in passes.SAMPLING_SWITCHES:
            column.prop(context.view_layer.gradus, name)


class GRADUS_VIEWLAYER_PT_passes_components(PassPanel, bpy.types.Panel):
    bl_label = "Components"

    def draw(self, context: Any) -> None:
        layout = self.columns()
        column = layout.column(heading="Include", align=True)
        column.active = context.scene.gradus.use_decomposition
        for name in passes.COMPONENT_SWITCHES:
            column.prop(context.view_layer.gradus, name)
        if not context.scene.gradus.use_decomposition:
            layout.label(text="Render Properties > Decomposition is off", icon="INFO")


class GRADUS_VIEWLAYER_PT_filter(ViewLayerPanel, bpy.types.Panel):
    bl_label = "Filter"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layer = context.view_layer
        column = self.columns().column(heading="Include")
        column.prop(layer, "use_sky", text="Environment")
        column.prop(layer, "use_solid", text="Surfaces")


class GRADUS_VIEWLAYER_PT_override(ViewLayerPanel, bpy.types.Panel):
    bl_label = "Override"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, layer = self.columns(), context.view_layer
        layout.prop(layer, "material_override")
        if hasattr(layer, "world_override"):  # not in 3.4
            layout.prop(layer, "world_override")
        layout.prop(layer, "samples")


CLASSES = (
    GRADUS_VIEWLAYER_PT_passes_data,
    GRADUS_VIEWLAYER_PT_passes_light,
    GRADUS_VIEWLAYER_PT_passes_components,
    GRADUS_VIEWLAYER_PT_passes_gradus,
    GRADUS_VIEWLAYER_PT_filter,
    GRADUS_VIEWLAYER_PT_override,
)
