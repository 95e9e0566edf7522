"""Surfaces, worlds and lights: the values that Blender's stock panels leave to the engine."""

from __future__ import annotations

from typing import Any

import bpy

from .base import EnginePanel


def draw_output(layout: Any, tree: Any, name: str) -> None:
    """The socket `name` of the active output node, with what is linked to it."""
    output = tree.get_output_node("CYCLES")
    if output is None:
        layout.label(text="No output node")
    else:
        layout.template_node_view(tree, output, output.inputs[name])


class GRADUS_MATERIAL_PT_surface(EnginePanel, bpy.types.Panel):
    bl_label = "Surface"
    bl_context = "material"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.material is not None

    def draw(self, context: Any) -> None:
        material = context.material
        if material.node_tree is not None:
            self.columns()
            draw_output(self.layout, material.node_tree, "Surface")
        else:
            self.layout.prop(material, "use_nodes", icon="NODETREE")


class GRADUS_WORLD_PT_surface(EnginePanel, bpy.types.Panel):
    bl_label = "Surface"
    bl_context = "world"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.world is not None

    def draw(self, context: Any) -> None:
        world = context.world
        if world.node_tree is not None:
            self.columns()
            draw_output(self.layout, world.node_tree, "Surface")
        else:
            self.layout.prop(world, "use_nodes", icon="NODETREE")
            self.layout.prop(world, "color")


class GRADUS_WORLD_PT_mist(EnginePanel, bpy.types.Panel):
    bl_label = "Mist Pass"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.world is not None

    def draw(self, context: Any) -> None:
        layout, mist = self.columns(), context.world.mist_settings
        for name in ("start", "depth", "falloff"):
            layout.prop(mist, name)


class GRADUS_DATA_PT_light(EnginePanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"

    VALUES = {  # noqa: RUF012
        "POINT": ("shadow_soft_size",),
        "SPOT": ("shadow_soft_size", "spot_size", "spot_blend"),
        "SUN": ("angle",),
        "AREA": ("shape", "size"),
    }

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.light is not None

    def draw(self, context: Any) -> None:
        light = context.light
        self.layout.row().prop(light, "type", expand=True)
        layout = self.columns()
        for name in ("color", "energy", "exposure", "normalize", *self.VALUES[light.type]):
            if hasattr(light, name):  # exposure and normalize came with 4.5
                layout.prop(light, name)
        if light.type == "AREA" and light.shape in ("RECTANGLE", "ELLIPSE"):
            layout.prop(light, "size_y")
        if light.type == "AREA" and hasattr(light, "spread"):
            layout.prop(light, "spread")


CLASSES = (GRADUS_MATERIAL_PT_surface, GRADUS_WORLD_PT_surface, GRADUS_WORLD_PT_mist, GRADUS_DATA_PT_light)
