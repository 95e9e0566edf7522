"""The order in which the modules of the add-on are registered. Both functions may be called repeatedly."""

from __future__ import annotations

import atexit

import bpy

from . import engine, properties, store, ui

_registered = False


def register() -> None:
    global _registered
    if _registered:
        return
    properties.register()
    bpy.utils.register_class(engine.GradusRenderEngine)
    ui.register()
    store.register_handlers()
    if getattr(bpy.app, "module", False):
        # The 4.5 module hangs at exit while a class is still registered.
        atexit.register(unregister)
    _registered = True


def unregister() -> None:
    global _registered
    if not _registered:
        return
    _registered = False
    atexit.unregister(unregister)
    store.unregister_handlers()
    ui.unregister()
    bpy.utils.unregister_class(engine.GradusRenderEngine)
    properties.unregister()
    store.clear()
