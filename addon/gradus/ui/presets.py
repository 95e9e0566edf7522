"""Presets of the sampling settings: three built-in ones, and those of the user."""

from __future__ import annotations

from typing import Any

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

FOLDER = "gradus/sampling"

BUILT_IN: dict[str, tuple[str, dict[str, Any]]] = {
    "DRAFT": ("Draft", {"samples": 16, "noise_threshold": 0.0, "reconstruction": "AUTO"}),
    "FINAL": ("Final", {"samples": 256, "noise_threshold": 0.01, "reconstruction": "AUTO"}),
    "REFERENCE": (
        "Reference",
        {"samples": 4096, "noise_threshold": 0.0, "integrator": "PATH", "reconstruction": "NONE"},
    ),
}
"""Label and values by identifier. Settings that are not listed are reset to their defaults."""

SAVED = (
    "samples",
    "min_samples",
    "noise_threshold",
    "time_limit",
    "integrator",
    "reconstruction",
    "reconstruction_alpha",
    "denoiser",
)
"""Settings that a preset contains."""


def apply(settings: Any, identifier: str) -> None:
    """Sets all sampling settings of scene.gradus to a built-in preset."""
    values = BUILT_IN[identifier][1]
    for name in SAVED:
        if name in values:
            setattr(settings, name, values[name])
        else:
            settings.property_unset(name)


class GRADUS_OT_preset(bpy.types.Operator):
    """Set the sampling settings to a preset"""

    bl_idname = "gradus.preset"
    bl_label = "Gradus Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}  # noqa: RUF012

    preset: bpy.props.EnumProperty(items=[(key, label, "") for key, (label, _) in BUILT_IN.items()])

    def execute(self, context: Any) -> set[str]:
        apply(context.scene.gradus, self.preset)
        return {"FINISHED"}


class GRADUS_OT_add_preset(AddPresetBase, bpy.types.Operator):
    """Save the sampling settings as a preset, or remove one"""

    bl_idname = "gradus.add_preset"
    bl_label = "Add Sampling Preset"
    preset_menu = "GRADUS_PT_presets"
    preset_subdir = FOLDER
    preset_defines = ["settings = bpy.context.scene.gradus"]  # noqa: RUF012
    preset_values = [f"settings.{name}" for name in SAVED]  # noqa: RUF012


class GRADUS_PT_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Sampling Presets"
    preset_subdir = FOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = "gradus.add_preset"
    COMPAT_ENGINES = {"GRADUS"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        for key, (label, _) in BUILT_IN.items():
            self.layout.operator("gradus.preset", text=label).preset = key
        self.layout.separator()
        super().draw(context)


CLASSES = (GRADUS_OT_preset, GRADUS_OT_add_preset, GRADUS_PT_presets)
