"""Panels of the render properties."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import bpy

from .. import automatic, cycles_settings, store
from .. import settings as setting_rows
from .base import RenderPanel
from .presets import GRADUS_PT_presets

BOUNCE_LIMITS = (
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "transparent_max_bounces",
)
CLAMPS = ("clamp_direct", "clamp_indirect")


class GRADUS_RENDER_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_header_preset(self, _context: Any) -> None:
        GRADUS_PT_presets.draw_panel_header(self.layout)

    def draw(self, context: Any) -> None:
        layout, settings = self.columns(), context.scene.gradus
        column = layout.column(align=True)
        column.prop(settings, "samples")
        column.prop(settings, "noise_threshold")
        column.prop(settings, "time_limit")
        layout.prop(settings, "preview_samples")


def has_clamps(scene: Any) -> bool:
    """Returns whether light is clamped, by settings of Gradus or those of Cycles that it follows."""
    owners = (cycles_settings.owner(scene, name, scene.gradus.use_cycles_settings) for name in CLAMPS)
    return any(getattr(owner, key) > 0.0 for owner, key in owners)


def bias(settings: Any, samples: int, is_clamped: bool) -> tuple[str, str]:
    """Returns a text about the bias of the settings, and its icon.

    Only the render finds out whether there is a denoiser.
    """
    method = automatic.method_of(settings.integrator, settings.reconstruction, settings.denoiser)
    if method.is_refused:
        return "Path tracing has no gradients for this reconstruction", "ERROR"
    if settings.denoiser == "OIDN":
        return "Biased by the denoiser", "INFO"
    if samples >= method.denoised_from:
        return "Biased if a denoiser is found", "INFO"
    if settings.use_temporal and method.denoised_from < math.inf:
        return "Consistent; biased in animations if a denoiser is found", "INFO"
    if is_clamped:
        return "Biased by clamping", "INFO"
    if method.reconstruction in ("L1", "REGULARIZED"):
        return "Consistent", "INFO"
    if settings.noise_threshold > 0.0:
        return "Unbiased if the noise threshold is 0", "INFO"
    return "Unbiased", "CHECKMARK"


class GRADUS_RENDER_PT_method(RenderPanel, bpy.types.Panel):
    bl_label = "Method"
    bl_parent_id = "GRADUS_RENDER_PT_sampling"

    def draw(self, context: Any) -> None:
        layout, settings = self.columns(), context.scene.gradus
        layout.prop(settings, "integrator")
        layout.prop(settings, "use_guiding")
        column = layout.column()
        column.prop(settings, "reconstruction")
        if settings.reconstruction in automatic.FROM_GRADIENTS:
            column.prop(settings, "reconstruction_alpha")
        text, icon = bias(settings, context.view_layer.samples or settings.samples, has_clamps(context.scene))
        layout.label(text=text, icon=icon)


class GRADUS_RENDER_PT_temporal(RenderPanel, bpy.types.Panel):
    bl_label = "Temporal"
    bl_parent_id = "GRADUS_RENDER_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.gradus, "use_temporal", text="")

    def draw(self, context: Any) -> None:
        layout, settings = self.columns(), context.scene.gradus
        column = layout.column(align=True)
        column.active = settings.use_temporal
        column.prop(settings, "window_size")
        column.prop(settings, "window_overlap")


class GRADUS_RENDER_PT_denoise(RenderPanel, bpy.types.Panel):
    bl_label = "Denoise"
    bl_parent_id = "GRADUS_RENDER_PT_sampling"

    def draw(self, context: Any) -> None:
        self.columns().prop(context.scene.gradus, "denoiser")


class GRADUS_RENDER_PT_advanced(RenderPanel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_parent_id = "GRADUS_RENDER_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, settings = self.columns(), context.scene.gradus
        for name in ("seed", "min_samples", "roughness_threshold"):
            layout.prop(settings, name)


def shared_prop(layout: Any, scene: Any, name: str) -> None:
    """Shows a setting that may be that of Cycles, with the label that Gradus has for it."""
    owner, key = cycles_settings.owner(scene, name, scene.gradus.use_cycles_settings)
    layout.prop(owner, key, text=setting_rows.BY_NAME[name].label)


class GRADUS_RENDER_PT_light_paths(RenderPanel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, settings = self.columns(), context.scene.gradus
        column = layout.column(align=True, heading="Max Bounces")
        for name in BOUNCE_LIMITS:
            shared_prop(column, context.scene, name)
        column = layout.column(align=True, heading="Clamping")
        for name in CLAMPS:
            shared_prop(column, context.scene, name)
        shared_prop(layout, context.scene, "blur_glossy")
        column = layout.column(align=True, heading="Caustics")
        for name in ("caustics_reflective", "caustics_refractive"):
            shared_prop(column, context.scene, name)
        if cycles_settings.values(context.scene):
            layout.prop(settings, "use_cycles_settings")
            layout.operator("gradus.copy_from_cycles")


class GRADUS_OT_copy_from_cycles(bpy.types.Operator):
    """Copy bounces, caustics, clamps, Filter Glossy and film settings from the Cycles settings of this scene"""

    bl_idname = "gradus.copy_from_cycles"
    bl_label = "Copy from Cycles"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    def execute(self, context: Any) -> set[str]:
        cycles_settings.copy(context.scene)
        return {"FINISHED"}


class GRADUS_RENDER_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout = self.columns()
        shared_prop(layout, context.scene, "film_exposure")
        layout.prop(context.scene.render, "film_transparent", text="Transparent")
        column = layout.column()
        column.active = context.scene.render.film_transparent
        shared_prop(column, context.scene, "film_transparent_glass")
        shared_prop(column, context.scene, "film_transparent_roughness")
        column = layout.column(align=True)
        shared_prop(column, context.scene, "pixel_filter")
        shared_prop(column, context.scene, "filter_width")


class GRADUS_RENDER_PT_performance(RenderPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, render = self.columns(), context.scene.render
        layout.prop(render, "threads_mode")
        column = layout.column()
        column.enabled = render.threads_mode == "FIXED"
        column.prop(render, "threads")
        layout.prop(render, "use_persistent_data", text="Persistent Data")
        layout.prop(context.scene.gradus, "frame_store")
        layout.prop(context.scene.gradus, "strict")


class GRADUS_RENDER_PT_plan(RenderPanel, bpy.types.Panel):
    bl_label = "Last Render"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout = self.layout
        summary = store.summaries.get((context.scene.name, context.view_layer.name))
        if summary is None:
            layout.label(text="No render yet")
            return
        column, width = layout.column(align=True), characters(context)
        for line in plan_lines(summary):
            for wrapped in textwrap.wrap(line, width, subsequent_indent="    "):
                column.label(text=wrapped)
        for text in summary.get("warnings", []):
            for index, wrapped in enumerate(textwrap.wrap(text, width)):
                column.label(text=wrapped, icon="BLANK1" if index else "ERROR")


def characters(context: Any) -> int:
    """Returns how many characters fit into a line of a panel, because Blender does not wrap labels."""
    per_character = 6.5 * context.preferences.system.ui_scale  # pixels, on average
    return max(20, int(context.region.width / per_character) - 6)


PHASES = (
    "export",
    "build",
    "correspondence",
    "sample",
    "preview",
    "store",
    "reconstruct",
    "denoise",
    "upload",
)
"""Phases of a stats object in the order of the render."""


def plan_lines(summary: dict[str, Any]) -> list[str]:
    """Returns the stats and the plan of a render as lines of text."""
    seconds = summary.get("seconds", {})
    samples, total = summary.get("samples", 0), seconds.get("total", 0.0)
    lines = [f"Frame {summary.get('frame')}: {samples:g} samples per pixel in {total:.1f} s"]
    lines += [f"{phase.capitalize()}: {seconds[phase]:.2f} s" for phase in PHASES if seconds.get(phase, 0.0) >= 0.005]
    for name, value in summary.get("plan", {}).items():
        label = name.replace("_", " ").capitalize()
        if isinstance(value, dict):
            lines += [f"{label}: {key.replace('_', ' ')}: {reason}" for key, reason in value.items()]
        elif isinstance(value, list):
            lines += [f"{label}: {item}" for item in value]
        else:
            lines.append(f"{label}: {value}")
    return lines


CLASSES = (
    GRADUS_OT_copy_from_cycles,
    GRADUS_RENDER_PT_sampling,
    GRADUS_RENDER_PT_method,
    GRADUS_RENDER_PT_temporal,
    GRADUS_RENDER_PT_denoise,
    GRADUS_RENDER_PT_advanced,
    GRADUS_RENDER_PT_light_paths,
    GRADUS_RENDER_PT_film,
    GRADUS_RENDER_PT_performance,
    GRADUS_RENDER_PT_plan,
)
