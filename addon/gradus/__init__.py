"""Gradus, a render engine for Blender 3.4 to 5.2.

This module imports without Blender; register() needs it.
"""

from __future__ import annotations

bl_info = {
    "name": "Gradus",
    "author": "The Gradus authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine > Gradus",
    "description": "Path tracing with reconstruction from measured noise, on the CPU",
    "doc_url": "",
    "category": "Render",
}


def register() -> None:
    """Registers the add-on. May be called repeatedly.

    A missing or wrong native library does not prevent registration: it is reported when a render starts.
    """
    from . import registration

    registration.register()


def unregister() -> None:
    """Unregisters the add-on, stops all renders and releases all native objects. May be called repeatedly."""
    from . import registration

    registration.unregister()
