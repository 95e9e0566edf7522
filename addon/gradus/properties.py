"""scene.gradus and view_layer.gradus, made from the table of settings.py."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from . import native, settings
from .settings import Setting


def _property(setting: Setting) -> Any:
    """The bpy property of a setting."""
    common = {"name": setting.label, "description": setting.doc, "default": setting.default}
    if setting.kind == settings.BOOL:
        return BoolProperty(**common)
    if setting.kind == settings.ENUM:
        # The library's own numbers, so that files keep their meaning when choices are added between.
        items = [(identifier, label, doc, number) for identifier, label, doc, number in setting.choices]
        return EnumProperty(**common, items=items)
    if setting.kind == settings.TEXT:
        return StringProperty(**common)
    if setting.kind == settings.FOLDER:
        return StringProperty(**common, subtype="DIR_PATH")
    limits = {"min": setting.minimum, "max": setting.maximum, "soft_max": setting.soft_maximum or setting.maximum}
    if setting.kind == settings.INT:
        return IntProperty(**common, **{name: int(value) for name, value in limits.items()})
    return FloatProperty(**common, **limits, precision=setting.precision, unit=setting.unit)


class GradusSceneSettings(bpy.types.PropertyGroup):
    """Settings of the engine in a scene."""

    __annotations__ = {setting.name: _property(setting) for setting in settings.SETTINGS}  # noqa: RUF012


class GradusViewLayerSettings(bpy.types.PropertyGroup):
    """Passes of the engine that Blender has no switch for."""

    use_pass_gradients: BoolProperty(
        name="Gradients",
        description="Sampled differences to the right and the upper neighbour: Gradient X, Gradient Y; in animations to the next frame, "
        "Gradient T, and where the surface is there: Gradient T Link",
        default=False,
    )
    use_pass_variance: BoolProperty(name="Variance", description="Estimated variance of the mean of Noisy Image", default=False)
    use_pass_error: BoolProperty(
        name="Error", description="Estimated squared error of Combined, mean over red, green and blue", default=False
    )
    use_pass_sample_count: BoolProperty(name="Sample Count", description="Samples that each pixel took", default=False)
    use_pass_denoising: BoolProperty(
        name="Denoising Data", description="Denoising Normal, Albedo and Depth, as the compositor's Denoise node takes them", default=False
    )


def _set_library(preferences: Any, _context: Any) -> None:
    native.preferred_path = bpy.path.abspath(preferences.library_path) if preferences.library_path else ""


class GradusPreferences(bpy.types.AddonPreferences):
    """Preferences of the add-on: where the native library is."""

    bl_idname = __package__

    library_path: StringProperty(
        name="Library",
        description="Path of libgradus.so; empty = the one that came with the add-on. The environment variable GRADUS_LIBRARY wins over it",
        subtype="FILE_PATH",
        update=_set_library,
    )

    def draw(self, _context: Any) -> None:
        layout = self.layout
        layout.prop(self, "library_path")
        try:
            library = native.load()
            layout.label(text=f"Gradus {library.version_text().decode()}", icon="CHECKMARK")
        except native.GradusError as error:
            layout.label(text=error.text, icon="ERROR")


CLASSES = (GradusSceneSettings, GradusViewLayerSettings, GradusPreferences)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.gradus = PointerProperty(type=GradusSceneSettings)
    bpy.types.ViewLayer.gradus = PointerProperty(type=GradusViewLayerSettings)
    addon = bpy.context.preferences.addons.get(__package__)
    if addon is not None and addon.preferences is not None:
        _set_library(addon.preferences, None)


def unregister() -> None:
    for owner in (bpy.types.Scene, bpy.types.ViewLayer):
        if hasattr(owner, "gradus"):
            del owner.gradus
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
