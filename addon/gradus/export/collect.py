"""Everything that the depsgraph shows, collected in one pass: one loop for objects, matrices in one bulk read.

Blender's wrappers die after the loop step, so each entry copies what it needs. Evaluated objects and data stay valid until the next
evaluation; what is needed after that (addresses, names, keys of materials) is copied, too.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from . import left_out, shadow_terminator
from .arrays import read
from .may_move import MayMove
from .object_random import name_hash
from .shutter import SHARP, Blur, blur_of
from .visibility import ALL_RAYS, MAY_MOVE, visibility

InstanceKey = tuple[int, ...]


@dataclass(slots=True)
class Entry:
    """One instance of a geometry, or a lamp."""

    index: int  # in depsgraph.object_instances
    key: InstanceKey  # stable over frames
    object: Any  # evaluated object that owns what is shown
    data: Any  # evaluated mesh or light
    place: int  # what is shown, by address: equal for instances that share it, within one evaluation
    name: str
    visibility: int
    random_id: int
    pass_index: int
    color: tuple[float, ...]
    shadow_terminator_offset: float
    blur: Blur = SHARP
    generated: tuple[float, ...] = (0.0, 0.0, 0.0)
    uv: tuple[float, ...] = (0.0, 0.0)
    materials: tuple[Any, ...] = ()
    material_keys: tuple[int, ...] = ()


@dataclass
class Collected:
    """What object_instances held, in its order."""

    matrices: array  # 16 per item of object_instances, column-major
    surfaces: list[Entry] = field(default_factory=list)
    lights: list[Entry] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)  # warnings about what cannot be shown yet


def slot_materials(obj: Any, data: Any, override: Any) -> tuple[Any, ...]:
    """Materials by slot. Slots linked to the object win; geometry nodes set theirs on the evaluated mesh only."""
    slots = obj.material_slots
    stored = getattr(data, "materials", ())
    count = max(len(slots), len(stored))
    if override is not None:
        return (override,) * max(count, 1)
    materials = []
    for index in range(count):
        if index < len(slots) and (slots[index].link == "OBJECT" or index >= len(stored)):
            materials.append(slots[index].material)
        else:
            materials.append(stored[index])
    return tuple(materials)


@dataclass(slots=True)
class _Facts:
    """What all instances that one instancer makes of one object share."""

    key: InstanceKey
    visibility: int
    name: str
    pass_index: int
    color: tuple[float, ...]
    shadow_terminator_offset: float
    blur: Blur


class _Parts:
    """Facts of objects, each looked up once: most of an export of many instances is this loop."""

    def __init__(self, view_layer: Any, warnings: list[str], may_move: MayMove | None) -> None:
        self._view_layer = view_layer
        self._may_move = may_move
        self._warnings = warnings
        self._override = view_layer.material_override
        self._facts: dict[tuple[int, int], _Facts] = {}
        self._materials: dict[tuple[int, int], tuple[Any, ...]] = {}
        self.has_node_instances = False

    def facts(self, obj: Any, owner: Any, parent: Any) -> _Facts:
        place = (owner.as_pointer(), parent.as_pointer() if parent is not None else 0)
        found = self._facts.get(place)
        if found is None:
            # Originals: a new depsgraph, as each frame of an animation may have, has other evaluated addresses.
            key = (owner.original.as_pointer(), parent.original.as_pointer() if parent is not None else 0)
            bits = visibility(obj, parent, self._view_layer)
            if self._may_move is not None and obj.type == "MESH" and self._may_move(owner, parent):
                bits |= MAY_MOVE
            terminator = shadow_terminator.geometry_offset(obj)
            found = self._facts[place] = _Facts(key, bits, owner.name, obj.pass_index, tuple(obj.color), terminator, blur_of(owner, parent))
            self._warnings.extend(left_out.of_object(owner, self._view_layer))
            if parent is not None:
                self.has_node_instances |= any(modifier.type == "NODES" for modifier in parent.modifiers)
        return found

    def materials(self, obj: Any, data: Any, place: tuple[int, int]) -> tuple[Any, ...]:
        found = self._materials.get(place)
        if found is None:
            found = self._materials[place] = slot_materials(obj, data, self._override)
        return found


def collect(depsgraph: Any, poll: Callable[[], None], may_move: MayMove | None = None) -> Collected:
    """All visible surfaces and lamps of the depsgraph at its frame. may_move: hints for the surfaces; None: without any.

    Curves, text, surfaces and metaballs come twice: as themselves, and as an instance that shows the mesh which Blender made of
    them (3.4 to 5.0). Only the latter has a surface.
    """
    instances = depsgraph.object_instances
    collected = Collected(array("f"))
    parts = _Parts(depsgraph.view_layer_eval, collected.left_out, may_move)
    surfaces = depsgraph.view_layer_eval.use_solid
    for index, instance in enumerate(instances):
        if index & 255 == 0:
            poll()
        obj = instance.object
        if not instance.show_self:
            continue
        kind = obj.type
        is_light = kind == "LIGHT"
        if is_light or (kind == "MESH" and surfaces):
            entry = _entry(index, instance, obj, is_light, parts)
            if entry is not None:
                (collected.lights if is_light else collected.surfaces).append(entry)
        elif kind in left_out.KINDS:
            collected.left_out.append(left_out.of_kind(obj.name, kind))
    collected.matrices = _matrices(instances, parts.has_node_instances)
    return collected


def _matrices(instances: Any, one_by_one: bool) -> array:
    """The matrices of all instances, column-major.

    foreach_get never frees 244 bytes for each instance that geometry nodes made (Blender 3.4 and 4.5). That is too much over an
    animation, so such scenes are read one by one, five times slower.
    """
    if not one_by_one:
        return read(instances, "matrix_world", "f", 16)
    values = array("f")
    for instance in instances:
        for column in instance.matrix_world.transposed():
            values.extend(column)
    return values


def _entry(index: int, instance: Any, obj: Any, is_light: bool, parts: _Parts) -> Entry | None:
    copies = instance.is_instance
    owner = instance.instance_object if copies else obj
    facts = parts.facts(obj, owner, instance.parent if copies else None)
    data = obj.data
    if facts.visibility & ALL_RAYS == 0 or data is None or (is_light and _is_portal(data)):
        return None
    place = data.as_pointer()
    if copies:
        key = facts.key + tuple(instance.persistent_id)
        random_id = instance.random_id & 0xFFFFFFFF
    else:
        key, random_id = facts.key, name_hash(facts.name)
    entry = Entry(
        index,
        key,
        owner,
        data,
        place,
        facts.name,
        facts.visibility,
        random_id,
        facts.pass_index,
        facts.color,
        facts.shadow_terminator_offset,
        facts.blur,
    )
    if copies:
        entry.generated = tuple(instance.orco)
        entry.uv = tuple(instance.uv)
    if not is_light:
        entry.materials = parts.materials(obj, data, (facts.key[0], place))
    return entry


def _is_portal(data: Any) -> bool:
    """Portals of Cycles guide its sampling and shine on nothing."""
    return bool(getattr(getattr(data, "cycles", None), "is_portal", False))
