"""Cycles' setting of objects against the steps in which faceted meshes with smooth normals turn away from a light."""

from __future__ import annotations

from typing import Any

GEOMETRY_OFFSET = "shadow_terminator_geometry_offset"
SHADING_OFFSETS = ("shadow_terminator_offset", "shadow_terminator_shading_offset")
DEFAULT = 0.1
"""Where Cycles is switched off, and Blender does not have the setting itself."""


def owner(obj: Any) -> Any:
    """What has the setting: the object in newer Blenders, else Cycles' part of it; None where neither does."""
    if hasattr(obj, GEOMETRY_OFFSET):
        return obj
    cycles = getattr(obj, "cycles", None)
    return cycles if hasattr(cycles, GEOMETRY_OFFSET) else None


def geometry_offset(obj: Any) -> float:
    """Cosine to a light below which its shadow rays begin above the facet."""
    return getattr(owner(obj), GEOMETRY_OFFSET, DEFAULT)


def has_shading_offset(obj: Any) -> bool:
    """The darker shading towards the terminator, which we do not have."""
    return any(getattr(owner(obj), name, 0.0) != 0.0 for name in SHADING_OFFSETS)
