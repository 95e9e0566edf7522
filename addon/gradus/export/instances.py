"""Everything that the depsgraph shows, collected in one pass: one loop for objects, matrices in one bulk read.

Blender's wrappers die after the loop step, so each entry copies what it needs; evaluated objects and data stay valid
until the next evaluation, and what is needed after that (addresses, names, keys of materials) is copied, too.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from .. import native
from .arrays import read

CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, VOLUME, SHADOW = 1, 2, 4, 8, 16, 32
ALL_RAYS = 63
HOLDOUT, SHADOW_CATCHER = 64, 128

_RAY_SWITCHES = (
    ("visible_camera", CAMERA),
    ("visible_diffuse", DIFFUSE),
    ("visible_glossy", GLOSSY),
    ("visible_transmission", TRANSMISSION),
    ("visible_volume_scatter", VOLUME),
    ("visible_shadow", SHADOW),
)

InstanceKey = tuple[int, ...]


@dataclass
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
    skipped: list[tuple[str, str]] = field(default_factory=list)  # names and types of objects that cannot be shown yet


def ray_visibility(obj: Any) -> int:
    """Bits of the kinds of ray that see an object."""
    bits = 0
    for name, bit in _RAY_SWITCHES:
        if getattr(obj, name, True):
            bits |= bit
    return bits


def visibility(obj: Any, parent: Any, view_layer: Any) -> int:
    """Bits of an instance: object and instancer together. Holdout and indirect-only are of the view layer, so of the instancer."""
    bits = ray_visibility(obj)
    owner = obj
    if parent is not None:
        bits &= ray_visibility(parent)
        owner = parent
    if bits == 0:
        return 0
    if owner.indirect_only_get(view_layer=view_layer):
        bits &= ~CAMERA
    if obj.is_holdout or owner.holdout_get(view_layer=view_layer):
        bits |= HOLDOUT
    if obj.is_shadow_catcher or owner.is_shadow_catcher:
        bits |= SHADOW_CATCHER
    return bits


def name_hash(name: str) -> int:
    """The number behind Object Info > Random of an object that is no instance, as in Cycles: a multiplicative hash of the name, mixed once.

    Source of the mixing step: Bob Jenkins, lookup3 (public domain), final() with a second word of 0.
    """
    value = 0
    for byte in name.encode("utf-8", "surrogateescape"):
        value = (value * 37 + byte) & 0xFFFFFFFF
    return _mix(value)


def _rotate(value: int, bits: int) -> int:
    return ((value << bits) | (value >> (32 - bits))) & 0xFFFFFFFF


def _mix(value: int) -> int:
    start = (0xDEADBEEF + (2 << 2) + 13) & 0xFFFFFFFF
    a, b, c = (start + value) & 0xFFFFFFFF, start, start
    for bits in ((14, 11, 25), (16, 4, 14, 24)):
        for step, count in enumerate(bits):
            target = step % 3
            if target == 0:
                c = ((c ^ b) - _rotate(b, count)) & 0xFFFFFFFF
            elif target == 1:
                a = ((a ^ c) - _rotate(c, count)) & 0xFFFFFFFF
            else:
                b = ((b ^ a) - _rotate(a, count)) & 0xFFFFFFFF
    return c


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


class _Parts:
    """Facts of an object that hold for all of its instances."""

    def __init__(self, view_layer: Any) -> None:
        self._view_layer = view_layer
        self._override = view_layer.material_override
        self._visibility: dict[tuple[int, int], int] = {}
        self._materials: dict[tuple[int, int], tuple[Any, ...]] = {}
        self._random: dict[int, int] = {}

    def visibility(self, obj: Any, parent: Any, key: InstanceKey) -> int:
        bits = self._visibility.get(key[:2])
        if bits is None:
            bits = self._visibility[key[:2]] = visibility(obj, parent, self._view_layer)
        return bits

    def materials(self, obj: Any, data: Any, key: InstanceKey) -> tuple[Any, ...]:
        place = (key[0], data.as_pointer())
        found = self._materials.get(place)
        if found is None:
            found = self._materials[place] = slot_materials(obj, data, self._override)
        return found

    def random_id(self, obj: Any, key: InstanceKey) -> int:
        value = self._random.get(key[0])
        if value is None:
            value = self._random[key[0]] = name_hash(obj.name)
        return value


def collect(depsgraph: Any, poll: Callable[[], None]) -> Collected:
    """All visible surfaces and lamps of the depsgraph at its frame.

    Curves, text, surfaces and metaballs come twice: as themselves, and as an instance that shows the mesh which Blender made of
    them (3.4 to 5.0). Only the latter has a surface.
    """
    instances = depsgraph.object_instances
    collected = Collected(read(instances, "matrix_world", "f", 16))
    ids = read(instances, "persistent_id", "i", 8)
    parts = _Parts(depsgraph.view_layer_eval)
    for index, instance in enumerate(instances):
        if index & 255 == 0:
            poll()
        obj = instance.object
        if not instance.show_self:
            continue
        kind = obj.type
        if kind in {"MESH", "LIGHT"}:
            entry = _entry(index, instance, obj, ids, parts)
            if entry is not None:
                (collected.lights if kind == "LIGHT" else collected.surfaces).append(entry)
        elif kind in {"CURVES", "POINTCLOUD", "VOLUME"}:
            collected.skipped.append((obj.name, kind))
    return collected


def _entry(index: int, instance: Any, obj: Any, ids: array, parts: _Parts) -> Entry | None:
    copies = instance.is_instance
    parent = instance.parent if copies else None
    owner = instance.instance_object if copies else obj
    # Originals: a new depsgraph, as each frame of an animation may have, has other evaluated addresses.
    key = (owner.original.as_pointer(), parent.original.as_pointer() if parent is not None else 0)
    if copies:
        key += tuple(ids[8 * index : 8 * index + 8])
    bits = parts.visibility(obj, parent, key)
    data = obj.data
    if bits & ALL_RAYS == 0 or data is None:
        return None
    entry = Entry(
        index,
        key,
        owner,
        data,
        data.as_pointer(),
        owner.name,
        bits,
        instance.random_id & 0xFFFFFFFF if copies else parts.random_id(obj, key),
        obj.pass_index,
        tuple(obj.color),
    )
    if copies:
        entry.generated = tuple(instance.orco)
        entry.uv = tuple(instance.uv)
    if obj.type != "LIGHT":
        entry.materials = parts.materials(obj, data, key)
    return entry


def _pick(values: array, entries: list[Entry]) -> array:
    """The matrices of `entries` out of those of all instances."""
    if len(entries) * 16 == len(values):
        return values
    picked = array("f")
    for entry in entries:
        picked.extend(values[16 * entry.index : 16 * entry.index + 16])
    return picked


@dataclass
class InstanceArrays:
    """Parallel arrays for GradusInstances."""

    entries: list[Entry]
    matrices: array
    mesh_keys: array
    ids: array
    materials: array
    material_first: array
    material_count: array
    previous: array | None = None
    following: array | None = None


def instance_arrays(collected: Collected, mesh_of: dict[int, int], instance_id: Callable[[InstanceKey], int]) -> InstanceArrays:
    """Arrays of the surfaces whose mesh exists. mesh_of: mesh keys by place, 0 = no mesh."""
    entries = [entry for entry in collected.surfaces if mesh_of[entry.place]]
    arrays = InstanceArrays(
        entries=entries,
        matrices=_pick(collected.matrices, entries),
        mesh_keys=array("Q", [mesh_of[entry.place] for entry in entries]),
        ids=array("Q", [instance_id(entry.key) for entry in entries]),
        materials=array("Q"),
        material_first=array("I"),
        material_count=array("I"),
    )
    places: dict[tuple[int, ...], int] = {}
    for entry in entries:
        slots = entry.material_keys
        first = places.get(slots)
        if first is None:
            first = places[slots] = len(arrays.materials)
            arrays.materials.extend(slots)
        arrays.material_first.append(first)
        arrays.material_count.append(len(slots))
    return arrays


def fill_instances(arrays: InstanceArrays) -> tuple[native.Instances, list[Any]]:
    """A native Instances, and what must stay alive until it has been copied."""
    entries = arrays.entries
    struct = native.Instances()
    struct.count = len(entries)
    names: dict[str, int] = {}
    columns = {
        "visibility": array("I", [entry.visibility for entry in entries]),
        "random_ids": array("I", [entry.random_id for entry in entries]),
        "pass_indices": array("i", [entry.pass_index for entry in entries]),
        "colors": _flat(entries, "color", 4),
        "generated": _flat(entries, "generated", 3),
        "uvs": _flat(entries, "uv", 2),
        "name_index": array("I", [names.setdefault(entry.name, len(names)) for entry in entries]),
        "meshes": arrays.mesh_keys,
        "ids": arrays.ids,
        "matrices": arrays.matrices,
        "matrices_previous": arrays.previous,
        "matrices_next": arrays.following,
        "material_first": arrays.material_first,
        "material_count": arrays.material_count,
        "materials": arrays.materials,
    }
    for name, values in columns.items():
        setattr(struct, name, native.pointer(values))
    struct.materials_size = len(arrays.materials)
    texts = native.text_array(list(names))
    struct.names = texts
    struct.name_count = len(names)
    return struct, [columns, texts, arrays]


def _flat(entries: list[Entry], attribute: str, width: int) -> array:
    values = array("f")
    for entry in entries:
        values.extend(getattr(entry, attribute))
    assert len(values) == width * len(entries)
    return values
