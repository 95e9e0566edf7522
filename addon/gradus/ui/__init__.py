"""Panels of the engine, and Blender's own where they apply."""

from __future__ import annotations

import bpy

from . import decomposition_panels, layer_panels, motion_panels, object_panels, pass_panels, presets, render_panels, shading_panels, stock


def classes() -> tuple[type, ...]:
    modules = (presets, render_panels, decomposition_panels, motion_panels, pass_panels, layer_panels, object_panels, shading_panels)
    return tuple(kind for module in modules for kind in module.CLASSES)


def register() -> None:
    for kind in classes():
        bpy.utils.register_class(kind)
    stock.join_all()


def unregister() -> None:
    stock.leave_all()
    for kind in reversed(classes()):
        bpy.utils.unregister_class(kind)
