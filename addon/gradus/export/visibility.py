"""The flags of an instance: kinds of rays that see it, holdout, and whether it may move."""

from __future__ import annotations

from typing import Any

from ..abi import Visibility

CAMERA = int(Visibility.VISIBLE_CAMERA)
DIFFUSE = int(Visibility.VISIBLE_DIFFUSE)
GLOSSY = int(Visibility.VISIBLE_GLOSSY)
TRANSMISSION = int(Visibility.VISIBLE_TRANSMISSION)
VOLUME = int(Visibility.VISIBLE_VOLUME)
SHADOW = int(Visibility.VISIBLE_SHADOW)
ALL_RAYS = int(Visibility.VISIBLE_ALL)
HOLDOUT = int(Visibility.HOLDOUT)
SHADOW_CATCHER = int(Visibility.SHADOW_CATCHER)
MAY_MOVE = int(Visibility.MAY_MOVE)

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
    if owner.holdout_get(view_layer=view_layer):
        bits |= HOLDOUT
    elif owner.indirect_only_get(view_layer=view_layer):
        bits &= ~CAMERA
    if owner.is_shadow_catcher or obj.is_shadow_catcher:
        bits |= SHADOW_CATCHER
    return bits
