"""View layers: what they show, and what they replace for all that they show."""

from __future__ import annotations

from typing import Any

import bpy

from .base import EnginePanel


class LayerPanel(EnginePanel):
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012


class GRADUS_VIEWLAYER_PT_filter(LayerPanel, bpy.types.Panel):
    bl_label = "Filter"

    def draw(self, context: Any) -> None:
        layer = context.view_layer
        column = self.columns().column(heading="Include")
        column.prop(layer, "use_sky", text="Environment")
        column.prop(layer, "use_solid", text="Surfaces")


class GRADUS_VIEWLAYER_PT_override(LayerPanel, bpy.types.Panel):
    bl_label = "Override"

    def draw(self, context: Any) -> None:
        layout, layer = self.columns(), context.view_layer
        layout.prop(layer, "material_override")
        if hasattr(layer, "world_override"):  # not in 3.4
            layout.prop(layer, "world_override")
        layout.prop(layer, "samples")


CLASSES = (GRADUS_VIEWLAYER_PT_filter, GRADUS_VIEWLAYER_PT_override)
