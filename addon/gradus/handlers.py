"""Finds Python handlers of scripts and add-ons that may change what a frame shows.

Facts about Blender 3.4, 4.5 and 5.2 on which this module relies:

- `engine.frame_set` runs the handlers frame_change_pre and frame_change_post. Those of renders run only when Blender
  itself comes to a frame: render_pre before the frame is evaluated, all others after it, before the next one.
- Blender and its add-ons that are enabled by default have no handlers in these lists.
"""

from __future__ import annotations

import os
from typing import Any

import bpy

# Handlers of a render that run only before its first frame or after its last one do not tell frames apart.
_KINDS = ("render_", "composite_", "frame_change_", "depsgraph_update_")
_ONCE = frozenset({"render_init", "render_complete", "render_cancel", "composite_cancel"})


def that_may_change_frames() -> list[str]:
    """Returns the kind and name of all handlers that run while an animation is rendered.

    Handlers of renders come first, because frames ahead never see what they do.
    """
    kinds = [name for name in dir(bpy.app.handlers) if name.startswith(_KINDS) and name not in _ONCE]
    kinds.sort(key=lambda kind: not kind.startswith("render_"))
    return [f"{kind}: {_name(handler)}" for kind in kinds for handler in getattr(bpy.app.handlers, kind)]


def _name(handler: Any) -> str:
    name = getattr(handler, "__qualname__", type(handler).__qualname__)
    code = getattr(handler, "__code__", None)
    return f"{name} in {os.path.basename(code.co_filename)}" if code is not None else name
