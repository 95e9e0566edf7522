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
        self._nested: dict[int, _Level | None] = {}
        self._index_of: dict[int, int] | None = None

    @property
    def is_empty(self) -> bool:
        return self._points is None

    def index(self, number: int) -> int | None:
        """Returns the index of the instance that a persistent id names: its attribute "id" if it has one."""
        if self._index_of is None:
            ids = self._points.attributes.get("id")
            numbers = read_values(ids)[1] if ids is not None else range(len(self._points.points))
            self._index_of = {}
            for index, value in enumerate(numbers):
                self._index_of.setdefault(int(value), index)
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

    def nested(self, index: int) -> _Level | None:
        """Returns the instances in what an instance refers to, or None if that is a collection."""
        handle = int(self._references_of_instances()[index])
        if handle not in self._nested:
            self._nested[handle] = _level_of(self._references[handle])
        return self._nested[handle]

    def _references_of_instances(self) -> array:
        if ".reference_index" not in self._columns:
            self._columns[".reference_index"] = read_values(self._points.attributes[".reference_index"])
        return self._columns[".reference_index"][1]


def _level_of(reference: Any) -> _Level | None:
    """Returns the instances in an evaluated object or geometry, or None if it is neither."""
    if hasattr(reference, "instances_pointcloud"):
        return _Level(reference, "")
    if hasattr(reference, "evaluated_geometry"):
        return _level_of_object(reference)
    return None


def _level_of_object(obj: Any) -> _Level | None:
    own = _OWN_COMPONENTS.get(obj.type)
    return _Level(obj.evaluated_geometry(), own) if own is not None else None


def _may_instance(parent: Any) -> tuple[Any, ...]:
    """Returns an instancer and the objects in it, whose instances are also those of the instancer."""
    collection = parent.instance_collection
    return (parent, *parent.children, *(collection.all_objects if collection is not None else ()))


def _has_nodes(obj: Any) -> bool:
    return any(modifier.type == "NODES" for modifier in obj.modifiers)


class NodeInstances:
    """Finds attributes of the instances of one evaluation."""

    def __init__(self) -> None:
        self._levels: dict[int, _Level | None] = {}

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
        if not any(_has_nodes(obj) for obj in _may_instance(instance.parent)):
            return ""
        if not hasattr(instance.parent, "evaluated_geometry"):
            return "attributes of instances can be read from Blender 4.5 on"
        _, is_complete = self._places(instance)
        return "" if is_complete else "attributes of instances in a collection, or of another instancer, are not read"

    def _places(self, instance: Any) -> tuple[list[tuple[_Level, int]], bool]:
        """Returns the levels of an instance with its index in each, from the outermost on, and whether these are all.

        What collections and other instancers contain is not followed. Where a geometry shows components of its own,
        those have the first numbers, and its instances are below the next one.
        """
        numbers = [number for number in instance.persistent_id if number != _NO_LEVEL]
        places: list[tuple[_Level, int]] = []
        level = self._top(instance.parent)
        while numbers and level is not None and not level.is_empty:
            if level.component_count and numbers.pop() < level.component_count:
                break
            index = level.index(numbers.pop()) if numbers else None
            if index is None:
                break
            places.append((level, index))
            level = level.nested(index)
        is_complete = not numbers or (level is not None and (bool(places) or len(numbers) == 1))
        return places, is_complete

    def _top(self, parent: Any) -> _Level | None:
        if not hasattr(parent, "evaluated_geometry"):
            return None
        key = parent.as_pointer()
        if key not in self._levels:
            self._levels[key] = _level_of_object(parent)
        return self._levels[key]
