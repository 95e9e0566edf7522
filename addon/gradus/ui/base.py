"""Base classes of all panels."""

from __future__ import annotations

from typing import Any

ENGINE = "GRADUS"


class EnginePanel:
    """Mixin for panels of the properties editor that are shown for Gradus only."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine == ENGINE

    def columns(self) -> Any:
        """Returns the layout with Blender's two columns of labels and values."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout


def draw_light_group(layout: Any, owner: Any, view_layer: Any) -> None:
    """Draws the light group of an object or a world, which need not be one of the view layer."""
    layout.prop_search(owner, "lightgroup", view_layer, "lightgroups", text="Light Group", results_are_suggestions=True)


class RenderPanel(EnginePanel):
    bl_context = "render"


class MaterialPanel(EnginePanel):
    bl_context = "material"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.material is not None


class WorldPanel(EnginePanel):
    bl_context = "world"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.world is not None


class LightPanel(EnginePanel):
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.light is not None
