"""Whether a rendered picture may show an object, itself or by what it does to others.

In doubt it may: what is taken for seen costs time, and what is taken for unseen would stand still in the picture.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Any

import bpy

from . import compat

_HOLDERS = (bpy.types.Collection, bpy.types.Scene)
"""They list objects, and show nothing that the view layers do not tell. Editors are not among Blender's users."""


class MayBeSeen:
    """Of some scenes. layer: of the first one, which is rendered, too, where it is switched off."""

    def __init__(self, scenes: Iterable[Any], layer: str = "") -> None:
        self._scenes = list(scenes)
        self._layer = layer

    def __call__(self, obj: Any) -> bool:
        return obj in self._shown or is_keyed(obj, "hide_render") or _acts_unasked(obj) or self._is_used(obj)

    @cached_property
    def _shown(self) -> set[Any]:
        return {obj for scene in self._scenes for each in _rendered_layers(scene, self._layer) for obj in _shown_by(each)}

    @cached_property
    def _users(self) -> dict[Any, set[Any]]:
        return bpy.data.user_map(key_types={"OBJECT", "COLLECTION"})

    def _is_used(self, obj: Any) -> bool:
        """By what makes something of it: children, modifiers, nodes, drivers, instances of the collections that it is in."""
        waiting, seen = [obj], {obj}
        while waiting:
            users = self._users.get(waiting.pop(), set()) - seen
            if any(not isinstance(user, _HOLDERS) for user in users):
                return True
            seen |= users
            waiting += [user for user in users if isinstance(user, bpy.types.Collection)]
        return False


def is_keyed(owner: Any, switch: str) -> bool:
    """Whether a switch of an object, of one of its modifiers or of a scene's layers may change from frame to frame."""
    animation = owner.animation_data
    if animation is None:
        return False
    curves = [*animation.drivers, *compat.action_curves(animation.action)]
    return len(animation.nla_tracks) > 0 or any(curve.data_path.endswith(switch) for curve in curves)


def _rendered_layers(scene: Any, layer: str) -> list[Any]:
    layers = list(scene.view_layers)
    return layers if is_keyed(scene, '"].use') else [each for each in layers if each.use or each.name == layer] or layers


def _shown_by(layer: Any) -> Iterator[Any]:
    """Objects that a view layer renders now. What hides a collection hides those inside, what excludes it does not."""
    # In Blender 5.2 a layer that was never shown has no collections of its own yet, and excludes none of the scene's.
    waiting = [(layer.layer_collection or layer.id_data.collection, False)]
    while waiting:
        place, hidden = waiting.pop()
        collection = getattr(place, "collection", place)
        hidden = hidden or collection.hide_render
        if not hidden and not getattr(place, "exclude", False):
            yield from (obj for obj in collection.objects if not obj.hide_render)
        waiting += [(child, hidden) for child in place.children]


def _acts_unasked(obj: Any) -> bool:
    """On simulations of others, which do not name it. Rigid bodies act on their own world alone."""
    return _is_force(obj.field) or any(_modifier_acts(modifier) for modifier in obj.modifiers)


def _is_force(field: Any) -> bool:
    return field is not None and field.type != "NONE"


def _modifier_acts(modifier: Any) -> bool:
    if modifier.type == "PARTICLE_SYSTEM":
        settings = modifier.particle_system.settings
        return _is_force(settings.force_field_1) or _is_force(settings.force_field_2)
    if modifier.type == "FLUID":
        return modifier.fluid_type != "DOMAIN"
    return modifier.type == "COLLISION" or (modifier.type == "DYNAMIC_PAINT" and modifier.brush_settings is not None)
