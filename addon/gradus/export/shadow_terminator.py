"""The shadow terminator settings of objects, which reduce artifacts of smooth normals on coarse meshes."""

from __future__ import annotations

from typing import Any

GEOMETRY_OFFSET = "shadow_terminator_geometry_offset"
SHADING_OFFSETS = ("shadow_terminator_offset", "shadow_terminator_shading_offset")
DEFAULT = 0.1
"""The geometry offset where neither Blender nor Cycles has the setting."""


def owner(obj: Any) -> Any:
    """Returns the owner of the settings: the object in newer versions of Blender, else its Cycles settings, or None."""
    if hasattr(obj, GEOMETRY_OFFSET):
        return obj
    cycles = getattr(obj, "cycles", None)
    return cycles if hasattr(cycles, GEOMETRY_OFFSET) else None


def geometry_offset(obj: Any) -> float:
    """Returns the cosine to a light below which shadow rays start above the facet."""
    return getattr(owner(obj), GEOMETRY_OFFSET, DEFAULT)


def shading_offset_name(found: Any) -> str:
    """Returns the name of the shading offset in an owner of the settings."""
    return next(name for name in reversed(SHADING_OFFSETS) if hasattr(found, name))


def shading_offset(obj: Any) -> float:
    """Returns the share of the angle to a light by which reflection ends early."""
    found = owner(obj)
    return getattr(found, shading_offset_name(found)) if found is not None else 0.0
