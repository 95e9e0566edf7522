"""Warnings about objects and properties of a scene that Gradus does not render."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from . import shadow_terminator

_KINDS = {"CURVES": "hair curves", "POINTCLOUD": "point clouds", "VOLUME": "volumes"}
KINDS = frozenset(_KINDS)
"""Types of objects that are not rendered."""


def of_kind(name: str, kind: str) -> str:
    return f"Object '{name}' is left out: {_KINDS[kind]} are not supported"


def of_object(obj: Any, view_layer: Any) -> Iterator[str]:
    """Yields warnings about an evaluated object."""
    if view_layer.use_strand and any(_is_hair(modifier) for modifier in obj.modifiers):
        yield f"Object '{obj.name}': hair particles are not supported"
    if obj.is_shadow_catcher and obj.type != "LIGHT":  # it is the default of lights and has no effect on them
        yield f"Object '{obj.name}' is a shadow catcher and is rendered as an ordinary surface"
    if obj.type != "LIGHT" and shadow_terminator.has_shading_offset(obj):
        yield f"Object '{obj.name}': the shading offset of its shadow terminator is ignored"
    linking = getattr(obj, "light_linking", None)  # from 4.0 on
    if linking is not None and (linking.receiver_collection is not None or linking.blocker_collection is not None):
        yield f"Object '{obj.name}': light linking is ignored"


def _is_hair(modifier: Any) -> bool:
    """Returns whether a modifier renders hair. Particles that are rendered as objects are instances."""
    if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
        return False
    settings = modifier.particle_system.settings
    return settings.type == "HAIR" and settings.render_type == "PATH"


def of_scene(scene: Any, view_layer: Any) -> Iterator[str]:
    """Yields warnings about a scene and a view layer."""
    camera = scene.camera
    if camera is not None and any(column.to_3d().length_squared == 0.0 for column in camera.matrix_world.col[:3]):
        yield f"Camera '{camera.name}' has scale 0, so that its direction is undefined"
    if any(getattr(view_layer, f"use_pass_cryptomatte_{kind}") for kind in ("object", "material", "asset")):
        yield f"View layer '{view_layer.name}': Cryptomatte passes are not supported"
