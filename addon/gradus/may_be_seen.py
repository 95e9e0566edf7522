"""Finds out whether an object may affect the rendered image, directly or through other objects.

In doubt the answer is yes: a wrong yes costs time, while a wrong no would leave a simulation static in the image.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Any

import bpy

from . import compat

_CONTAINERS = (bpy.types.Collection, bpy.types.Scene)
"""Types of users that only list objects. Whether they show an object follows from the view layers."""


class MayBeSeen:
    """Answers for a list of scenes. layer: a view layer of the first scene that is rendered even if it is disabled."""

    def __init__(self, scenes: Iterable[Any], layer: str = "") -> None:
        self._scenes = list(scenes)
        self._layer = layer

    def __call__(self, obj: Any) -> bool:
        return obj in self._shown or is_keyed(obj, "hide_render") or _affects_simulations(obj) or self._is_used(obj)

    @cached_property
    def _shown(self) -> set[Any]:
        layers = [layer for scene in self._scenes for layer in _rendered_layers(scene, self._layer)]
        return {obj for layer in layers for obj in _shown_by(layer)}

    @cached_property
    def _users(self) -> dict[Any, set[Any]]:
        return bpy.data.user_map(key_types={"OBJECT", "COLLECTION"})

    def _is_used(self, obj: Any) -> bool:
        """Returns whether children, modifiers, nodes, drivers or instanced collections use the object."""
        waiting, seen = [obj], {obj}
        while waiting:
            users = self._users.get(waiting.pop(), set()) - seen
            if any(not isinstance(user, _CONTAINERS) for user in users):
                return True
            seen |= users
            waiting += [user for user in users if isinstance(user, bpy.types.Collection)]
        return False


def is_keyed(owner: Any, switch: str) -> bool:
    """Returns whether a switch of an object, of its modifiers or of a scene's view layers may change between frames."""
    animation = owner.animation_data
    if animation is None:
        return False
    curves = [*animation.drivers, *compat.action_curves(animation.action)]
    return len(animation.nla_tracks) > 0 or any(curve.data_path.endswith(switch) for curve in curves)


def _rendered_layers(scene: Any, layer: str) -> list[Any]:
    layers = list(scene.view_layers)
    if is_keyed(scene, '"].use'):
        return layers
    return [each for each in layers if each.use or each.name == layer] or layers


def _shown_by(layer: Any) -> Iterator[Any]:
    """Yields the objects that a view layer renders at this frame.

    A hidden collection hides its child collections, while an excluded one does not exclude them.
    """
    # In Blender 5.2 a layer that was never shown has no collections of its own yet, and excludes none of the scene's.
    waiting = [(layer.layer_collection or layer.id_data.collection, False)]
    while waiting:
        place, hidden = waiting.pop()
        collection = getattr(place, "collection", place)
        hidden = hidden or collection.hide_render
        if not hidden and not getattr(place, "exclude", False):
            yield from (obj for obj in collection.objects if not obj.hide_render)
        waiting += [(child, hidden) for child in place.children]


def _affects_simulations(obj: Any) -> bool:
    """Returns whether the object affects simulations of other objects that do not refer to it.

    Rigid bodies are not considered, because they affect their own rigid body world only.
    """
    return _is_force(obj.field) or any(_modifier_affects_simulations(modifier) for modifier in obj.modifiers)


def _is_force(field: Any) -> bool:
    return field is not None and field.type != "NONE"


def _modifier_affects_simulations(modifier: Any) -> bool:
    if modifier.type == "PARTICLE_SYSTEM":
        settings = modifier.particle_system.settings
        return _is_force(settings.force_field_1) or _is_force(settings.force_field_2)
    if modifier.type == "FLUID":
        return modifier.fluid_type != "DOMAIN"
    return modifier.type == "COLLISION" or (modifier.type == "DYNAMIC_PAINT" and modifier.brush_settings is not None)
