"""Panels of materials, worlds and lights, whose values Blender leaves to the engine."""

from __future__ import annotations

from typing import Any

import bpy

from .base import LightPanel, MaterialPanel, WorldPanel, draw_light_group


def draw_output(layout: Any, tree: Any, name: str) -> None:
    """Draws the socket `name` of the active output node, with the node that is linked to it."""
    output = tree.get_output_node("CYCLES")
    if output is None:
        layout.label(text="No output node")
    else:
        layout.template_node_view(tree, output, output.inputs[name])


class GRADUS_MATERIAL_PT_surface(MaterialPanel, bpy.types.Panel):
    bl_label = "Surface"

    def draw(self, context: Any) -> None:
        material = context.material
        if material.node_tree is not None:
            self.columns()
            draw_output(self.layout, material.node_tree, "Surface")
        else:
            self.layout.prop(material, "use_nodes", icon="NODETREE")


class GRADUS_MATERIAL_PT_settings(MaterialPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, material = self.columns(), context.material
        layout.prop(material, "pass_index")
        # Before 4.2, transparent shadows are a property of Cycles. Sampling is one in all versions.
        for owner in (material, getattr(material, "cycles", None)):
            for name in ("use_transparent_shadow", "emission_sampling", "sample_as_light"):
                if hasattr(owner, name):
                    layout.prop(owner, name)


class GRADUS_WORLD_PT_surface(WorldPanel, bpy.types.Panel):
    bl_label = "Surface"

    def draw(self, context: Any) -> None:
        world = context.world
        if world.node_tree is not None:
            self.columns()
            draw_output(self.layout, world.node_tree, "Surface")
        else:
            self.layout.prop(world, "use_nodes", icon="NODETREE")
            self.layout.prop(world, "color")


class GRADUS_WORLD_PT_mist(WorldPanel, bpy.types.Panel):
    bl_label = "Mist Pass"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, mist = self.columns(), context.world.mist_settings
        for name in ("start", "depth", "falloff"):
            layout.prop(mist, name)


class GRADUS_WORLD_PT_settings(WorldPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, world = self.columns(), context.world
        layout.prop(world.light_settings, "distance", text="Ambient Occlusion Distance")
        visibility, sampling = (getattr(world, name, None) for name in ("cycles_visibility", "cycles"))
        if sampling is not None:  # a property of the Cycles add-on
            layout.prop(sampling, "sampling_method", text="Sampling")
            if sampling.sampling_method == "MANUAL":
                layout.prop(sampling, "sample_map_resolution")
        if visibility is not None:
            column = layout.column(heading="Ray Visibility")
            for name in ("camera", "diffuse", "glossy", "transmission"):
                column.prop(visibility, name)
        draw_light_group(layout, world, context.view_layer)


class GRADUS_DATA_PT_light(LightPanel, bpy.types.Panel):
    bl_label = "Light"

    VALUES = {  # noqa: RUF012
        "POINT": ("shadow_soft_size", "use_soft_falloff"),
        "SPOT": ("shadow_soft_size", "use_soft_falloff", "spot_size", "spot_blend"),
        "SUN": ("angle",),
        "AREA": ("shape", "size"),
    }

    def draw(self, context: Any) -> None:
        light = context.light
        self.layout.row().prop(light, "type", expand=True)
        layout = self.columns()
        names = ("use_temperature", "temperature", "color", "energy", "exposure", "normalize")
        for name in (*names, *self.VALUES[light.type]):
            if hasattr(light, name):  # temperature, exposure and normalize exist from 4.5 on
                layout.prop(light, name)
        if light.type == "AREA" and light.shape in ("RECTANGLE", "ELLIPSE"):
            layout.prop(light, "size_y")
        if light.type == "AREA" and hasattr(light, "spread"):
            layout.prop(light, "spread")
        cycles = getattr(light, "cycles", None)
        if hasattr(cycles, "cast_shadow"):  # before 4.2
            layout.prop(cycles, "cast_shadow")
        else:
            layout.prop(light, "use_shadow")
        if hasattr(cycles, "max_bounces"):
            layout.prop(cycles, "max_bounces")
            layout.prop(cycles, "use_multiple_importance_sampling")


class GRADUS_DATA_PT_light_nodes(LightPanel, bpy.types.Panel):
    bl_label = "Nodes"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        light = context.light
        self.layout.prop(light, "use_nodes", icon="NODETREE")
        if light.use_nodes and light.node_tree is not None:
            self.columns()
            draw_output(self.layout, light.node_tree, "Surface")


CLASSES = (
    GRADUS_MATERIAL_PT_surface,
    GRADUS_MATERIAL_PT_settings,
    GRADUS_WORLD_PT_surface,
    GRADUS_WORLD_PT_mist,
    GRADUS_WORLD_PT_settings,
    GRADUS_DATA_PT_light,
    GRADUS_DATA_PT_light_nodes,
)
