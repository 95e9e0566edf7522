"""Attributes that geometry nodes store on their instances.

An instance is found in the evaluated geometry by its persistent id, which has a number for each level of instancing,
the innermost level first. Blender's Python has this geometry from 4.5 on.
"""

from __future__ import annotations

from array import array
from typing import Any

from .attributes import read_values
from .properties import Color

_NO_LEVEL = 0x7FFFFFFF
_COMPONENTS = ("mesh", "volume", "curves", "pointcloud", "grease_pencil")
# The component of an object's geometry that the object itself shows.
_OWN_COMPONENTS = {
    "MESH": "mesh",
    "VOLUME": "volume",
    "CURVE": "curves",
    "FONT": "curves",
    "CURVES": "curves",
    "POINTCLOUD": "pointcloud",
    "GREASEPENCIL": "grease_pencil",
}


class _Level:
    """The instances in a geometry, which an object or another instance owns."""

    def __init__(self, geometry: Any, own_component: str) -> None:
        self._geometry = geometry  # keeps what follows alive
        shown = [getattr(geometry, name) for name in _COMPONENTS if name != own_component]
        self.component_count = sum(component is not None for component in shown)
        self._points = geometry.instances_pointcloud()
        self._references = geometry.instance_references()
        self._columns: dict[str, tuple[int, array] | None] = {}
        self.nested: dict[int, _Source] = {}  # by the number of a reference
        self._index_of: dict[int, int | None] | None = None

    @property
    def is_empty(self) -> bool:
        return self._points is None

    def index(self, number: int) -> int | None:
        """Returns the index of the instance that a persistent id names: its attribute "id" if it has one.

        It is None where several instances have that id, as those of several children on one vertex.
        """
        if self._index_of is None:
            ids = self._points.attributes.get("id")
            numbers = read_values(ids)[1] if ids is not None else range(len(self._points.points))
            self._index_of = {}
            for index, value in enumerate(numbers):
                self._index_of[int(value)] = index if int(value) not in self._index_of else None
        return self._index_of.get(number)

    def color(self, name: str, index: int) -> Color | None:
        if name not in self._columns:
            stored = self._points.attributes.get(name)
            self._columns[name] = read_values(stored) if stored is not None else None
        column = self._columns[name]
        if column is None:
            return None
        channels, values = column
        value = tuple(values[channels * index : channels * index + channels])
        return (value * 3 if channels == 1 else value + (0.0,) * (3 - channels)) + (1.0,) * (channels < 4)

    def reference(self, index: int) -> tuple[int, Any]:
        """Returns the number of what an instance refers to, and the object, geometry or collection itself."""
        handle = int(self._references_of_instances()[index])
        return handle, self._references[handle]

    def _references_of_instances(self) -> array:
        if ".reference_index" not in self._columns:
            self._columns[".reference_index"] = read_values(self._points.attributes[".reference_index"])
        return self._columns[".reference_index"][1]


class _Collection:
    """Objects by the number that an instance of their collection has in its persistent id."""

    def __init__(self, objects: list[Any]) -> None:
        self._objects = objects

    def object(self, number: int) -> Any | None:
        return self._objects[number] if 0 <= number < len(self._objects) else None


_Source = _Level | _Collection | None
"""What instances come from; None: nothing that is followed."""


def _shown_objects(collection: Any, hidden: str) -> list[Any]:
    """Returns the objects that a collection shows, in Blender's order. hidden: the switch that hides an object."""
    shown: set[Any] = set()
    waiting = [collection]
    while waiting:
        place = waiting.pop()
        if not getattr(place, hidden):
            shown.update(place.objects)
            waiting += place.children
    return [obj for obj in collection.all_objects if obj in shown and not getattr(obj, hidden)]


def _may_show_nodes(instancer: Any) -> bool:
    """Returns whether an instancer, or an object whose instances are also those of the instancer, has nodes.

    instancer: an original object, since evaluated ones do not list their children.
    """
    waiting, seen = [instancer], {instancer}
    while waiting:
        obj = waiting.pop()
        if any(modifier.type == "NODES" for modifier in obj.modifiers):
            return True
        collection = obj.instance_collection
        inner = {*obj.children, *(collection.all_objects if collection is not None else ())} - seen
        seen |= inner
        waiting += inner
    return False


class NodeInstances:
    """Finds attributes of the instances of one evaluation. is_render: whether it is that of a render."""

    def __init__(self, is_render: bool) -> None:
        self._hidden = "hide_render" if is_render else "hide_viewport"
        self._sources: dict[int, _Source] = {}
        self._may_show_nodes: dict[int, bool] = {}

    def value(self, instance: Any, name: str) -> Color | None:
        """Returns an attribute from the innermost level that has it, or None."""
        places, _ = self._places(instance)
        for level, index in reversed(places):
            found = level.color(name, index)
            if found is not None:
                return found
        return None

    def unread(self, instance: Any) -> str:
        """Returns why attributes of an instance may be missing, or ""."""
        parent = instance.parent
        key = parent.as_pointer()
        if key not in self._may_show_nodes:
            self._may_show_nodes[key] = _may_show_nodes(parent.original)
        if not self._may_show_nodes[key]:
            return ""
        if not hasattr(parent, "evaluated_geometry"):
            return "attributes of instances can be read from Blender 4.5 on"
        _, is_complete = self._places(instance)
        return "" if is_complete else "attributes of instances are not read where several have one id"

    def _places(self, instance: Any) -> tuple[list[tuple[_Level, int]], bool]:
        """Returns the levels of an instance with its index in each, from the outermost on, and whether these are all.

        Where a geometry shows components of its own, those have the first numbers, and its instances are below the next
        one. Instances on vertices, faces and particles are instances of the geometry, too.
        """
        numbers = [number for number in instance.persistent_id if number != _NO_LEVEL]
        places: list[tuple[_Level, int]] = []
        source = self._of_object(instance.parent)
        while numbers:
            if source is None:
                return places, False
            if isinstance(source, _Collection):
                obj = source.object(numbers.pop())
                source = self._of_object(obj) if obj is not None else None
                continue
            if source.is_empty:
                return places, len(numbers) == 1
            if source.component_count and numbers.pop() < source.component_count:
                return places, True
            if not numbers:
                return places, True
            index = source.index(numbers.pop())
            if index is None:
                return places, False
            places.append((source, index))
            source = self._nested(source, index)
        return places, True

    def _nested(self, level: _Level, index: int) -> _Source:
        """Returns the source of the instances in what an instance refers to."""
        handle, reference = level.reference(index)
        if handle not in level.nested:
            level.nested[handle] = self._of_reference(reference)
        return level.nested[handle]

    def _of_reference(self, reference: Any) -> _Source:
        if hasattr(reference, "instances_pointcloud"):
            return _Level(reference, "")
        if hasattr(reference, "evaluated_geometry"):
            return self._of_object(reference)
        if hasattr(reference, "all_objects"):
            # Each object has two numbers: for itself and for its own instances.
            return _Collection([obj for obj in _shown_objects(reference, self._hidden) for _ in range(2)])
        return None

    def _of_object(self, obj: Any) -> _Source:
        if not hasattr(obj, "evaluated_geometry"):
            return None
        key = obj.as_pointer()
        if key not in self._sources:
            self._sources[key] = _source_of_object(obj)
        return self._sources[key]


def _source_of_object(obj: Any) -> _Source:
    """Returns the source of the instances of an object. Those of geometry go before its collection, as in Blender."""
    own = _OWN_COMPONENTS.get(obj.type)
    level = _Level(obj.evaluated_geometry(), own) if own is not None else None
    if (level is None or level.is_empty) and obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
        return _Collection(list(obj.instance_collection.all_objects))
    return level
