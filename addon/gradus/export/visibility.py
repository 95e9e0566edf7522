"""The flags of an instance: kinds of rays that see it, holdout, and whether it may move."""

from __future__ import annotations

from typing import Any

CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, VOLUME, SHADOW = 1, 2, 4, 8, 16, 32
ALL_RAYS = 63
HOLDOUT = 64
MAY_MOVE = 256

RAY_SWITCHES = (
    ("visible_camera", CAMERA),
    ("visible_diffuse", DIFFUSE),
    ("visible_glossy", GLOSSY),
    ("visible_transmission", TRANSMISSION),
    ("visible_volume_scatter", VOLUME),
    ("visible_shadow", SHADOW),
)
"""Properties of an object and the kinds of rays that they enable."""


def ray_visibility(obj: Any) -> int:
    """Returns the flags of the kinds of rays that see an object."""
    bits = 0
    for name, bit in RAY_SWITCHES:
        if getattr(obj, name, True):
            bits |= bit
    return bits


def visibility(obj: Any, parent: Any, view_layer: Any) -> int:
    """Returns the flags of an instance, from those of the object and of its instancer.

    Holdout and indirect-only of a view layer belong to the instancer, because the object itself may be in no view
    layer.
    """
    bits = ray_visibility(obj)
    owner = obj
    if parent is not None:
        bits &= ray_visibility(parent)
        owner = parent
    if bits == 0:
        return 0
    if owner.indirect_only_get(view_layer=view_layer):
        bits &= ~CAMERA
    if obj.is_holdout or owner.holdout_get(view_layer=view_layer):
        bits |= HOLDOUT
    return bits
