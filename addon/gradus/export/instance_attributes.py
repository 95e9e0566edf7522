"""Attributes of which every instance has a value: of its object, of its particle, or stored by geometry nodes.

Materials name them with a prefix (attribute_names.py). The values are those that Cycles finds, in its order. They are
read in a loop of their own over the instances, because only few scenes need them.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable
from typing import Any

from .. import compat
from ..attribute_names import INSTANCER, OBJECT, PARTICLE
from .arrays import read
from .collect import Entry
from .light import is_object
from .node_instances import NodeInstances
from .object_random import unit_hash
from .properties import MISSING, Color, find_color

# Output of Particle Info: property of particles, number of values.
_PARTICLE_PROPERTIES = {
    "Age": ("birth_time", 1),
    "Lifetime": ("lifetime", 1),
    "Location": ("location", 3),
    "Size": ("size", 1),
    "Velocity": ("velocity", 3),
    "Angular Velocity": ("angular_velocity", 3),
}

_OPAQUE: Color = (0.0, 0.0, 0.0, 1.0)
"""The value of an attribute of what is no object. It has another alpha than that of an object, MISSING."""


def read_instance_attributes(
    depsgraph: Any,
    entries: Iterable[Entry],
    names_of: Callable[[tuple[int, ...]], list[str]],
    poll: Callable[[], None],
    warn: Callable[[str], None],
) -> None:
    """Sets the attributes of entries. names_of: returns the names that the materials of some keys read."""
    wanted = {entry.index: entry for entry in entries if names_of(entry.material_keys)}
    if not wanted:
        return
    reader = _Reader(depsgraph, warn)
    for index, instance in enumerate(depsgraph.object_instances):
        if index & 255 == 0:
            poll()
        entry = wanted.get(index)
        if entry is not None:
            entry.attributes = {name: reader.value(entry, instance, name) for name in names_of(entry.material_keys)}


class _Reader:
    """Reads attributes of the instances of one evaluation."""

    def __init__(self, depsgraph: Any, warn: Callable[[str], None]) -> None:
        self._particles = _Particles(depsgraph.scene_eval.frame_current_final)
        self._nodes = NodeInstances(depsgraph.mode == "RENDER")
        self._warn = warn

    def value(self, entry: Entry, instance: Any, name: str) -> Color:
        if entry.object.type == "LIGHT" and not is_object(compat.VERSION):
            return self._particles.missing(name.removeprefix(PARTICLE)) if name.startswith(PARTICLE) else _OPAQUE
        if name.startswith(PARTICLE):
            return self._particles.value(instance, name.removeprefix(PARTICLE))
        if name.startswith(INSTANCER) and instance.is_instance:
            return self._of_instancer(entry, instance, name.removeprefix(INSTANCER))
        return self._of_object(entry, name.removeprefix(OBJECT).removeprefix(INSTANCER)) or MISSING

    def _of_object(self, entry: Entry, name: str) -> Color | None:
        """Returns a property of the object. Its colour is that of its instancer."""
        if name == "color" and name not in entry.object:
            return entry.color
        return find_color((entry.object, entry.data), name)

    def _of_instancer(self, entry: Entry, instance: Any, name: str) -> Color:
        """Returns a property of the particle settings, what geometry nodes store, or a property of the objects."""
        system = instance.particle_system
        found = find_color((system.settings if system is not None else None,), name)
        if found is None:
            found = self._nodes.value(instance, name)
        if found is None:
            found = find_color((instance.parent,), name)
        if found is None:
            found = self._of_object(entry, name)
        if found is None and (reason := self._nodes.unread(instance)):
            self._warn(f"Object '{instance.parent.name}': the attribute '{name}' is black, because {reason}")
        return found or MISSING


class _Particles:
    """Properties of particles whose instances are rendered. Children have none, as in Cycles."""

    def __init__(self, frame: float) -> None:
        self._frame = frame
        self._columns: dict[tuple[int, str], array] = {}

    def value(self, instance: Any, output: str) -> Color:
        system = instance.particle_system if instance.is_instance else None
        index = instance.persistent_id[0] if system is not None else 0
        if system is None or index >= len(system.particles):
            return self.missing(output)
        if output == "Index":
            return (float(index),) * 3 + (1.0,)
        if output == "Random":
            return (unit_hash(index),) * 3 + (1.0,)
        return self._property(system, index, output)

    def missing(self, output: str) -> Color:
        """Returns the value of what is no particle."""
        return (unit_hash(0),) * 3 + (1.0,) if output == "Random" else MISSING

    def _property(self, system: Any, index: int, output: str) -> Color:
        name, width = _PARTICLE_PROPERTIES[output]
        key = (system.as_pointer(), name)
        if key not in self._columns:
            self._columns[key] = read(system.particles, name, "f", width)
        values = self._columns[key][width * index : width * index + width]
        if output == "Age":
            values[0] = self._frame - values[0]
        return (*values, 1.0) if width == 3 else (values[0],) * 3 + (1.0,)
