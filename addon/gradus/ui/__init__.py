"""Panels of the engine, and Blender's own where they apply."""

from __future__ import annotations

import bpy

from . import pass_panels, presets, render_panels, shading_panels, stock


def classes() -> tuple[type, ...]:
    return (*presets.CLASSES, *render_panels.CLASSES, *pass_panels.CLASSES, *shading_panels.CLASSES)


def register() -> None:
    for kind in classes():
        bpy.utils.register_class(kind)
    stock.join_all()


def unregister() -> None:
    stock.leave_all()
    for kind in reversed(classes()):
        bpy.utils.unregister_class(kind)
