"""What a scene holds and the picture does not show yet. Each is named in a warning, so that nobody looks for its cause elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from . import shadow_terminator

_KINDS = {"CURVES": "hair curves", "POINTCLOUD": "point clouds", "VOLUME": "volumes"}
KINDS = frozenset(_KINDS)
"""Types of objects that are not rendered."""


def of_kind(name: str, kind: str) -> str:
    return f"Object '{name}' is left out: {_KINDS[kind]} are not rendered yet"


def of_object(obj: Any, view_layer: Any) -> Iterator[str]:
    """What an evaluated object has besides its surface."""
    if view_layer.use_strand and any(_is_hair(modifier) for modifier in obj.modifiers):
        yield f"Object '{obj.name}': hair particles are not rendered yet"
    if obj.is_shadow_catcher and obj.type != "LIGHT":  # lamps are by default: they light the shadows that are caught
        yield f"Object '{obj.name}' is a shadow catcher and is rendered as an ordinary surface"
    if obj.type != "LIGHT" and shadow_terminator.has_shading_offset(obj):
        yield f"Object '{obj.name}': the shading offset of its shadow terminator is left out"
    linking = getattr(obj, "light_linking", None)  # from 4.0 on
    if linking is not None and (linking.receiver_collection is not None or linking.blocker_collection is not None):
        yield f"Object '{obj.name}': light linking is left out, it shines on everything"


def _is_hair(modifier: Any) -> bool:
    """Particles that are shown as objects arrive as instances, those that are halos or points show nothing."""
    if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
        return False
    settings = modifier.particle_system.settings
    return settings.type == "HAIR" and settings.render_type == "PATH"


def of_scene(scene: Any, view_layer: Any) -> Iterator[str]:
    camera = scene.camera
    if camera is not None and any(column.to_3d().length_squared == 0.0 for column in camera.matrix_world.col[:3]):
        yield f"Camera '{camera.name}' has scale 0: it has no direction to look to"
    if any(getattr(view_layer, f"use_pass_cryptomatte_{kind}") for kind in ("object", "material", "asset")):
        yield f"View layer '{view_layer.name}': Cryptomatte passes are not rendered yet"
