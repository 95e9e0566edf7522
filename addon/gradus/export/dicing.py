"""Adaptive subdivision: into how small triangles the library divides a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Dicing:
    """The dicing fields of a GradusMesh. A length is in the mesh's space, a rate a share of the picture's width.

    A viewport keeps its triangles until a camera makes edges longer or shorter by the tolerance.
    """

    levels: int = 0
    rate: float = 0.0
    length: float = 0.0
    offscreen_scale: float = 1.0
    tolerance: float = 1.0


NO_DICING = Dicing()

PREVIEW_TOLERANCE = 2.0
"""Factor by which edges may be too long or too short in a viewport. Cycles never dices again for another camera."""

DICING_SETTINGS = ("dicing_rate", "preview_dicing_rate", "max_subdivisions", "offscreen_dicing_scale", "feature_set")
"""Settings of scene.cycles that dicing_of() reads."""


def dicing_of(obj: Any, scene: Any, width: int, is_preview: bool) -> Dicing:
    """Returns how an object is diced. width: that of the picture, in pixels.

    The mesh that is diced has the levels of its modifier. Cycles divides the mesh before the modifier instead, so its
    number of subdivisions is an upper bound.
    """
    settings = getattr(scene, "cycles", None)
    modifier = obj.modifiers[-1] if obj.modifiers else None
    if settings is None or modifier is None or modifier.type != "SUBSURF":
        return NO_DICING
    if not (modifier.show_viewport if is_preview else modifier.show_render):
        return NO_DICING
    found = _rate_and_length(obj, modifier, settings)
    if found is None:
        return NO_DICING
    rate, length = found
    pixels = settings.preview_dicing_rate if is_preview else settings.dicing_rate
    tolerance = PREVIEW_TOLERANCE if is_preview else 1.0
    return Dicing(settings.max_subdivisions, rate * pixels / width, length, settings.offscreen_dicing_scale, tolerance)


def dicing_camera(scene: Any) -> Any | None:
    """Returns the camera that is chosen for dicing, or None for the one that renders."""
    settings = getattr(scene, "cycles", None)
    return getattr(settings, "dicing_camera", None)


def _rate_and_length(obj: Any, modifier: Any, settings: Any) -> tuple[float, float] | None:
    """Returns the object's own rate, or a length and the rate 0, or None if the object is not diced."""
    if hasattr(modifier, "use_adaptive_subdivision"):  # from 5.0 on
        if not modifier.use_adaptive_subdivision:
            return None
        if modifier.adaptive_space == "OBJECT":
            return 0.0, modifier.adaptive_object_edge_length
        return modifier.adaptive_pixel_size, 0.0
    own = getattr(obj, "cycles", None)
    if settings.feature_set != "EXPERIMENTAL" or not getattr(own, "use_adaptive_subdivision", False):
        return None
    return own.dicing_rate, 0.0
