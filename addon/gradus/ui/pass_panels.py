"""Passes of a view layer: Blender's switches where it has them, ours besides. The stock panel is an empty shell."""

from __future__ import annotations

from typing import Any

import bpy

from .base import EnginePanel

DATA = ("use_pass_z", "use_pass_mist", "use_pass_position", "use_pass_normal", "use_pass_vector", "use_pass_uv")
INDEXES = ("use_pass_object_index", "use_pass_material_index")
LIGHT = tuple(
    (kind, tuple(f"use_pass_{kind}_{part}" for part in ("direct", "indirect", "color"))) for kind in ("diffuse", "glossy", "transmission")
)
OTHER_LIGHT = ("use_pass_emit", "use_pass_environment", "use_pass_ambient_occlusion")
OF_COMPONENTS = (
    "use_pass_components",
    "use_pass_component_reflectance",
    "use_pass_component_irradiance",
    "use_pass_component_normal",
    "use_pass_component_depth",
    "use_pass_component_uv",
    "use_pass_component_index",
    "use_pass_component_emit",
    "use_pass_component_motion",
    "use_pass_component_irradiance_motion",
)
OURS = ("use_pass_gradients", "use_pass_variance", "use_pass_error", "use_pass_sample_count", "use_pass_denoising")


class PassPanel(EnginePanel):
    bl_context = "view_layer"


class GRADUS_VIEWLAYER_PT_passes(PassPanel, bpy.types.Panel):
    bl_label = "Passes"

    def draw(self, _context: Any) -> None:
        pass


class GRADUS_VIEWLAYER_PT_passes_data(PassPanel, bpy.types.Panel):
    bl_label = "Data"
    bl_parent_id = "GRADUS_VIEWLAYER_PT_passes"

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
    bl_parent_id = "GRADUS_VIEWLAYER_PT_passes"

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
    bl_parent_id = "GRADUS_VIEWLAYER_PT_passes"

    def draw(self, context: Any) -> None:
        column = self.columns().column(heading="Include", align=True)
        for name in OURS:
            column.prop(context.view_layer.gradus, name)


class GRADUS_VIEWLAYER_PT_passes_components(PassPanel, bpy.types.Panel):
    bl_label = "Components"
    bl_parent_id = "GRADUS_VIEWLAYER_PT_passes"

    def draw(self, context: Any) -> None:
        layout = self.columns()
        column = layout.column(heading="Include", align=True)
        column.active = context.scene.gradus.use_decomposition
        for name in OF_COMPONENTS:
            column.prop(context.view_layer.gradus, name)
        if not context.scene.gradus.use_decomposition:
            layout.label(text="Render Properties > Decomposition is off", icon="INFO")


CLASSES = (
    GRADUS_VIEWLAYER_PT_passes,
    GRADUS_VIEWLAYER_PT_passes_data,
    GRADUS_VIEWLAYER_PT_passes_light,
    GRADUS_VIEWLAYER_PT_passes_components,
    GRADUS_VIEWLAYER_PT_passes_gradus,
)
