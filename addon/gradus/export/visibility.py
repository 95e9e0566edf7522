"""Which kinds of ray see an object, and what replaces it in the picture."""

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
"""Properties of an object, and the kind of ray that each lets see it."""


def ray_visibility(obj: Any) -> int:
    """Bits of the kinds of ray that see an object."""
    bits = 0
    for name, bit in RAY_SWITCHES:
        if getattr(obj, name, True):
            bits |= bit
    return bits


def visibility(obj: Any, parent: Any, view_layer: Any) -> int:
    """Bits of an instance: object and instancer together. Holdout and indirect-only are of the view layer, so of the instancer."""
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
