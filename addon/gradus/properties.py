"""The properties scene.gradus and view_layer.gradus, created from the table of settings.py."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from . import native, settings
from .settings import Setting

CHANGE_PASSES = frozenset(("integrator", "reconstruction", "denoiser", "use_decomposition", "components"))
"""Settings that add or remove passes."""


def _show_passes(group: Any, _context: Any) -> None:
    """Updates the sockets of the compositor's Render Layers nodes. One view layer updates all of the scene."""
    group.id_data.view_layers[0].update_render_passes()


def _property(setting: Setting) -> Any:
    """Returns the bpy property of a setting."""
    common = {"name": setting.label, "description": setting.doc, "default": setting.default}
    if setting.name in CHANGE_PASSES:
        common["update"] = _show_passes
    if setting.kind == settings.BOOL:
        return BoolProperty(**common)
    if setting.kind == settings.ENUM:
        # The numbers of the library, so that files keep their meaning when choices are inserted.
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


def _switch(name: str, description: str, default: bool = False) -> Any:
    return BoolProperty(name=name, description=description, default=default, update=_show_passes)


class GradusViewLayerSettings(bpy.types.PropertyGroup):
    """Switches of passes for which Blender has none."""

    use_pass_gradients: _switch(
        "Gradients",
        "Adds the passes Gradient X and Gradient Y, the sampled differences to the right and upper neighbour. In "
        "animations, adds Gradient T, the difference to the next frame, and Gradient T Link, the position of the "
        "surface there",
    )
    use_pass_variance: _switch("Variance", "Adds the estimated variance of Noisy Image")
    use_pass_error: _switch("Error", "Adds the estimated squared error of Combined, averaged over red, green and blue")
    use_pass_sample_count: _switch("Sample Count", "Adds the number of samples of each pixel")
    use_pass_denoising: _switch(
        "Denoising Data", "Adds the passes Denoising Normal, Albedo and Depth, which the compositor's Denoise node uses"
    )
    use_pass_components: _switch(
        "Color",
        "Adds one pass for each component: Path Diffuse, Path Reflection … Each is reconstructed separately, and their "
        "sum is Combined",
        True,
    )
    use_pass_component_reflectance: _switch(
        "Reflectance", "Adds the albedo of the first non-specular surface on the paths of each component"
    )
    use_pass_component_irradiance: _switch(
        "Irradiance", "Adds each component divided by its reflectance: the light without textures"
    )
    use_pass_component_normal: _switch(
        "Normal", "Adds the normal of the first non-specular surface on the paths of each component"
    )
    use_pass_component_depth: _switch(
        "Depth",
        "Adds the length of the paths of each component to their first non-specular surface. For reflections, this "
        "includes the distance to the mirror",
    )
    use_pass_component_uv: _switch(
        "UV", "Adds the texture coordinates of the first non-specular surface on the paths of each component"
    )
    use_pass_component_index: _switch(
        "Object and Face Index",
        "Adds the pass index of the object and the index of the face of the first non-specular surface on the paths of "
        "each component",
    )
    use_pass_component_emit: _switch(
        "Emit",
        "Adds the emission of the first non-specular surface on the paths of each component, without the tint of "
        "mirrors and glass",
    )
    use_pass_component_motion: _switch(
        "Motion",
        "Adds the motion of each component to the previous and next frame, in the format of pass Vector, and Tracked, "
        "which is 1 where the motion is known",
    )
    use_pass_component_irradiance_motion: _switch(
        "Irradiance Motion",
        "Adds the motion of the light on the surfaces of each component, such as shadows. It is found by optical "
        "flow, in animations only",
    )


class GradusWindowState(bpy.types.PropertyGroup):
    """State of the interface that is not saved in files."""

    path: StringProperty(
        name="Try a Path",
        description="A light path: E, then D (diffuse or rough), R (specular reflection) or T (specular "
        "transmission) for each scattering event, then L. The component to which it belongs is shown below",
        default="ETTDL",
    )


def _set_library(preferences: Any, _context: Any) -> None:
    native.preferred_path = bpy.path.abspath(preferences.library_path) if preferences.library_path else ""


class GradusPreferences(bpy.types.AddonPreferences):
    """Preferences of the add-on: where the native library is."""

    bl_idname = __package__

    library_path: StringProperty(
        name="Library",
        description="Path of libgradus.so. If empty, the library of the add-on is used. The environment variable "
        "GRADUS_LIBRARY overrides this setting",
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


CLASSES = (GradusSceneSettings, GradusViewLayerSettings, GradusWindowState, GradusPreferences)
OWNERS = {
    bpy.types.Scene: GradusSceneSettings,
    bpy.types.ViewLayer: GradusViewLayerSettings,
    bpy.types.WindowManager: GradusWindowState,
}


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    for owner, kind in OWNERS.items():
        owner.gradus = PointerProperty(type=kind)
    addon = bpy.context.preferences.addons.get(__package__)
    if addon is not None and addon.preferences is not None:
        _set_library(addon.preferences, None)


def unregister() -> None:
    for owner in OWNERS:
        if hasattr(owner, "gradus"):
            del owner.gradus
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
