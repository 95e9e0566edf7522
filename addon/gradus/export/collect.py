"""Collects everything that the depsgraph shows: one loop over the instances, and one bulk read of their matrices.

Blender's wrapper of an instance is valid only during its step of the loop, so each entry copies what it needs.
Evaluated objects and data stay valid until the next evaluation. Addresses, names and material keys are copied, because
they are needed after that.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .. import compat
from . import shadow_terminator, unsupported
from .arrays import read
from .light_linking import LightLinking, Links
from .may_move import MayMove
from .object_random import name_hash
from .properties import Color
from .shutter import NO_BLUR, Blur, blur_of
from .visibility import ALL_RAYS, MAY_MOVE, visibility

InstanceKey = tuple[int, ...]

# From this version on, Cycles does not replace empty slots of objects by those of their data.
_EMPTY_SLOTS_SINCE = (5, 2, 0)


@dataclass(slots=True)
class Entry:
    """One instance of a geometry, or one light."""

    index: int  # in depsgraph.object_instances
    key: InstanceKey  # the same in all frames
    object: Any  # the evaluated object that owns the data
    data: Any  # evaluated mesh or light
    data_address: int  # equal for instances that share their data, within one evaluation
    name: str
    visibility: int
    random_id: int
    pass_index: int
    color: tuple[float, ...]
    shadow_terminator: tuple[float, float]  # offsets of geometry and shading
    links: Links
    blur: Blur = NO_BLUR
    light_group: str = ""
    asset_name: str = ""  # of the topmost parent
    full_names: tuple[str, str] = ("", "")  # of the object and of its instancer, with their libraries
    generated: tuple[float, ...] = (0.0, 0.0, 0.0)
    uv: tuple[float, ...] = (0.0, 0.0)
    materials: tuple[Any, ...] = ()
    material_keys: tuple[int, ...] = ()
    attributes: Mapping[str, Color] | None = None  # those that the materials read


@dataclass
class Collected:
    """The instances of a depsgraph, in its order."""

    matrices: array  # 16 per item of object_instances, column-major
    surfaces: list[Entry] = field(default_factory=list)
    lights: list[Entry] = field(default_factory=list)
    unsupported: list[str] = field(default_factory=list)  # warnings about objects that are not rendered


def slot_materials(obj: Any, data: Any, override: Any) -> tuple[Any, ...]:
    """Returns materials by slot. Slots linked to the object override those of the data.

    Geometry nodes set materials on the evaluated mesh only, so slots without an object link are read from there. An
    empty slot that is linked to the object has the material of the data before Blender 5.2.
    """
    slots = obj.material_slots
    stored = getattr(data, "materials", ())
    count = max(len(slots), len(stored))
    if override is not None:
        return (override,) * max(count, 1)
    materials = []
    for index in range(count):
        is_of_object = index < len(slots) and (slots[index].link == "OBJECT" or index >= len(stored))
        if is_of_object:
            materials.append(None if _is_empty(obj, index) else slots[index].material)
        else:
            materials.append(stored[index])
    return tuple(materials)


def _is_empty(obj: Any, index: int) -> bool:
    """Returns whether a slot that is linked to the object has no material in Cycles.

    Blender evaluates such a slot to the material of the data in all versions.
    """
    slots = obj.original.material_slots
    return compat.VERSION >= _EMPTY_SLOTS_SINCE and index < len(slots) and slots[index].material is None


@dataclass(slots=True)
class _ObjectProperties:
    """Properties that all instances of one object by one instancer share."""

    key: InstanceKey
    visibility: int
    name: str
    pass_index: int
    color: tuple[float, ...]
    shadow_terminator: tuple[float, float]
    links: Links
    blur: Blur
    light_group: str
    asset_name: str
    full_names: tuple[str, str]
    is_edited: bool = False  # whether the object's mesh is in Edit Mode


class _ObjectCache:
    """Properties and materials of objects, each read once, because scenes may have many instances of few objects."""

    def __init__(self, view_layer: Any, warnings: list[str], may_move: MayMove | None) -> None:
        self._view_layer = view_layer
        self._may_move = may_move
        self._warnings = warnings
        self._override = view_layer.material_override
        self._properties: dict[tuple[int, int], _ObjectProperties] = {}
        self._materials: dict[tuple[int, int], tuple[Any, ...]] = {}
        self.linking = LightLinking()
        self._edited: dict[int, Any] = {}  # meshes of Edit Mode by address
        self.has_node_instances = False

    def properties(self, obj: Any, owner: Any, parent: Any) -> _ObjectProperties:
        evaluated = (owner.as_pointer(), parent.as_pointer() if parent is not None else 0)
        found = self._properties.get(evaluated)
        if found is None:
            # The key has addresses of original objects, because those of evaluated objects differ between depsgraphs.
            key = (owner.original.as_pointer(), parent.original.as_pointer() if parent is not None else 0)
            # The mesh of a gas domain only bounds a volume.
            bits = 0 if unsupported.is_gas_domain(owner) else visibility(obj, parent, self._view_layer)
            if self._may_move is not None and obj.type == "MESH" and self._may_move(owner, parent):
                bits |= MAY_MOVE
            offsets = shadow_terminator.geometry_offset(obj), shadow_terminator.shading_offset(obj)
            blur = blur_of(owner, parent)
            # Instances have the colour of their instancer.
            color = tuple((obj if parent is None else parent).color)
            group, asset = getattr(owner, "lightgroup", ""), _topmost(owner).name
            links = self.linking.links_of(owner, parent)
            names = (owner.original.name_full, parent.original.name_full if parent is not None else "")
            found = _ObjectProperties(
                key, bits, owner.name, obj.pass_index, color, offsets, links, blur, group, asset, names
            )
            found.is_edited = owner.type == "MESH" and owner.data.is_editmode
            self._properties[evaluated] = found
            self._warnings.extend(unsupported.of_object(owner, self._view_layer))
            if parent is not None:
                self.has_node_instances |= any(modifier.type == "NODES" for modifier in parent.modifiers)
        return found

    def edited_mesh(self, owner: Any, data: Any) -> Any:
        """Returns a mesh that shows what Edit Mode shows, as in Cycles. The evaluated mesh itself has no faces then."""
        address = data.as_pointer()
        if address not in self._edited:
            self._edited[address] = owner.to_mesh()
        return self._edited[address]

    def materials(self, obj: Any, data: Any, key: tuple[int, int]) -> tuple[Any, ...]:
        found = self._materials.get(key)
        if found is None:
            found = self._materials[key] = slot_materials(obj, data, self._override)
        return found


def collect(depsgraph: Any, poll: Callable[[], None], may_move: MayMove | None = None, space: Any = None) -> Collected:
    """Returns all visible surfaces and lights of the depsgraph at its frame.

    may_move: predicts which surfaces move, or None. space: a 3D viewport that hides objects, or None.

    Blender 3.4 to 5.0 lists curves, text, surfaces and metaballs twice: as themselves, and as an instance of the mesh
    that it made of them. Only the latter is exported.
    """
    instances = depsgraph.object_instances
    collected = Collected(array("f"))
    cache = _ObjectCache(depsgraph.view_layer_eval, collected.unsupported, may_move)
    surfaces = depsgraph.view_layer_eval.use_solid
    for index, instance in enumerate(instances):
        if index & 255 == 0:
            poll()
        obj = instance.object
        if not instance.show_self or (space is not None and not obj.visible_in_viewport_get(space)):
            continue
        kind = obj.type
        is_light = kind == "LIGHT"
        if is_light or (kind == "MESH" and surfaces):
            entry = _entry(index, instance, obj, is_light, cache)
            if entry is not None:
                (collected.lights if is_light else collected.surfaces).append(entry)
        elif kind in unsupported.KINDS:
            collected.unsupported.append(unsupported.of_kind(obj.name, kind))
    cache.linking.resolve(collected.unsupported.append)
    collected.matrices = _matrices(instances, cache.has_node_instances)
    return collected


def _matrices(instances: Any, one_by_one: bool) -> array:
    """Returns the matrices of all instances in column-major order.

    In Blender 3.4 and 4.5, foreach_get leaks 244 bytes for each instance of geometry nodes, which is too much in an
    animation. Such scenes are read one by one, which takes five times as long.
    """
    if not one_by_one:
        return read(instances, "matrix_world", "f", 16)
    values = array("f")
    for instance in instances:
        for column in instance.matrix_world.transposed():
            values.extend(column)
    return values


def _entry(index: int, instance: Any, obj: Any, is_light: bool, cache: _ObjectCache) -> Entry | None:
    copies = instance.is_instance
    owner = instance.instance_object if copies else obj
    properties = cache.properties(obj, owner, instance.parent if copies else None)
    data = obj.data
    if properties.visibility & ALL_RAYS == 0 or data is None or (is_light and is_portal(data)):
        return None
    address = data.as_pointer()
    if properties.is_edited and owner.data.as_pointer() == address:
        data = cache.edited_mesh(owner, data)
    if copies:
        key = properties.key + tuple(instance.persistent_id)
        random_id = instance.random_id & 0xFFFFFFFF
    else:
        key, random_id = properties.key, name_hash(properties.name)
    entry = Entry(
        index,
        key,
        owner,
        data,
        address,
        properties.name,
        properties.visibility,
        random_id,
        properties.pass_index,
        properties.color,
        properties.shadow_terminator,
        properties.links,
        properties.blur,
        properties.light_group,
        properties.asset_name,
        properties.full_names,
    )
    if copies:
        entry.generated = tuple(0.5 * value - 0.5 for value in instance.orco)  # as in Cycles
        entry.uv = tuple(instance.uv)
    if not is_light:
        entry.materials = cache.materials(obj, data, (properties.key[0], address))
    return entry


def _topmost(obj: Any) -> Any:
    """Returns the topmost parent of an object, or the object."""
    while obj.parent is not None:
        obj = obj.parent
    return obj


def is_portal(data: Any) -> bool:
    """Returns whether a light is a portal of Cycles, which guides sampling and emits nothing."""
    return data.type == "AREA" and bool(getattr(getattr(data, "cycles", None), "is_portal", False))
