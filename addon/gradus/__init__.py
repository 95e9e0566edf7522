"""Gradus, a gradient-domain path tracer for Blender 3.4 to 5.2. This module imports without Blender; register() needs it."""

from __future__ import annotations

bl_info = {
    "name": "Gradus",
    "author": "The Gradus authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine > Gradus",
    "description": "Gradient-domain path tracing",
    "doc_url": "",
    "category": "Render",
}


def register() -> None:
    """Idempotent; a missing or wrong native library does not keep it from registering (it is reported when a render starts)."""
    from . import registration

    registration.register()


def unregister() -> None:
    """Idempotent; stops all renders and frees what the library holds."""
    from . import registration

    registration.unregister()
