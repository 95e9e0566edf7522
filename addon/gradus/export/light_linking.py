"""Light and shadow linking: which objects a light or an emissive object lights, and which objects block its light.

A collection of an emitter names objects that it includes, and objects that it excludes. As in Cycles, objects that the
same collections name in the same way form a set. An emitter has a mask with a bit for each set. Blender has these
settings from 4.0 on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

MAX_SETS = 63
"""The library has one more set. Nothing belongs to it, so that its bit alone is the mask of no object."""

NO_OBJECT = 1 << MAX_SETS
ALL_OBJECTS = 0

_Membership = frozenset[tuple[int, bool]]
"""Collections that name an object, by address, and whether they include it."""


@dataclass(slots=True)
class Links:
    """The links of one object; LightLinking.resolve() sets them."""

    receiver_set: int = 0
    receiver_mask: int = ALL_OBJECTS
    blocker_set: int = 0
    blocker_mask: int = ALL_OBJECTS


NO_LINKS = Links()


def _named_objects(collection: Any) -> Iterator[tuple[Any, bool]]:
    """Yields the objects of a collection, and whether it includes them.

    An object that several children hold has the state of the last one, and that of its own entry if it has one.
    """
    for child, entry in zip(collection.children, collection.collection_children, strict=True):
        for obj in child.all_objects:
            yield obj, entry.light_linking.link_state == "INCLUDE"
    for obj, entry in zip(collection.objects, collection.collection_objects, strict=True):
        yield obj, entry.light_linking.link_state == "INCLUDE"


class _Sets:
    """The sets of objects by one kind of collection: of receivers or of blockers."""

    def __init__(self, collections: list[Any]) -> None:
        self._membership: dict[int, dict[int, bool]] = {}  # by object, then by collection
        self._including: set[int] = set()
        for collection in {collection.as_pointer(): collection for collection in collections}.values():
            for obj, is_included in _named_objects(collection):
                self._membership.setdefault(obj.as_pointer(), {})[collection.as_pointer()] = is_included
                if is_included:
                    self._including.add(collection.as_pointer())
        self._numbers: dict[_Membership, int] = {frozenset(): 0}
        self.exceeds_limit = False

    def number(self, obj: Any, parent: Any) -> int:
        """Returns the set of an instance: that of its instancer, if a collection names it, or else its own."""
        of_parent = self._number(parent) if parent is not None else 0
        return of_parent or self._number(obj)

    def _number(self, obj: Any) -> int:
        membership = frozenset(self._membership.get(obj.as_pointer(), {}).items())
        number = self._numbers.setdefault(membership, len(self._numbers))
        self.exceeds_limit |= number >= MAX_SETS
        return number if number < MAX_SETS else 0

    def mask(self, collection: Any) -> int:
        """Returns the bits of the sets that a collection of an emitter stands for."""
        if collection is None:
            return ALL_OBJECTS
        address = collection.as_pointer()
        includes = address in self._including
        numbers = [
            number for membership, number in self._numbers.items() if dict(membership).get(address, not includes)
        ]
        if len(numbers) == len(self._numbers):
            return ALL_OBJECTS
        return NO_OBJECT | sum(1 << number for number in numbers if number < MAX_SETS)


class LightLinking:
    """Takes the objects of a depsgraph, and then finds the links of all of them."""

    def __init__(self) -> None:
        self._objects: list[tuple[Links, Any, Any]] = []
        self._is_used = False

    def links_of(self, obj: Any, parent: Any) -> Links:
        """Returns the links of an evaluated object that `parent` instances, or None. resolve() sets them."""
        links = Links()
        settings = getattr(obj.original, "light_linking", None)
        if settings is not None:
            self._is_used |= settings.receiver_collection is not None or settings.blocker_collection is not None
            self._objects.append((links, obj.original, parent.original if parent is not None else None))
        return links

    def resolve(self, warn: Callable[[str], None]) -> None:
        """Sets the links of all objects that links_of() was called for."""
        if not self._is_used:
            return
        for kind in ("receiver", "blocker"):
            collections = [getattr(obj.light_linking, f"{kind}_collection") for _, obj, _ in self._objects]
            sets = _Sets([collection for collection in collections if collection is not None])
            for links, obj, parent in self._objects:
                setattr(links, f"{kind}_set", sets.number(obj, parent))
            for (links, _, _), collection in zip(self._objects, collections, strict=True):
                setattr(links, f"{kind}_mask", sets.mask(collection))
            if sets.exceeds_limit:
                warn(f"Light linking: more than {MAX_SETS} different sets of {kind}s; further ones count as not linked")
