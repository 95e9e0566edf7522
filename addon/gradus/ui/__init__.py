"""The panels of Gradus, and the panels of Blender that are shown for Gradus."""

from __future__ import annotations

import bpy

from . import (
    decomposition_panels,
    motion_panels,
    object_panels,
    presets,
    render_panels,
    shading_panels,
    stock,
    view_layer_panels,
)

MODULES = (
    presets,
    render_panels,
    decomposition_panels,
    motion_panels,
    view_layer_panels,
    object_panels,
    shading_panels,
)


def classes() -> tuple[type, ...]:
    return tuple(kind for module in MODULES for kind in module.CLASSES)


def register() -> None:
    for kind in classes():
        bpy.utils.register_class(kind)
    stock.join_all()


def unregister() -> None:
    stock.leave_all()
    for kind in reversed(classes()):
        bpy.utils.unregister_class(kind)
