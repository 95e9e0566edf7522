"""Instances as parallel arrays: meshes, matrices, material slots and values of Object Info."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from typing import Any

from .. import native
from .collect import Collected, Entry
from .keys import InstanceIds
from .light_linking import NO_LINKS
from .motion import InstanceBlur
from .properties import MISSING, Color


def _pick(values: array, entries: list[Entry]) -> array:
    """Returns the matrices of `entries` from those of all instances."""
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
    blur: InstanceBlur | None = None
    attribute_names: list[str] = field(default_factory=list)


def instance_arrays(collected: Collected, mesh_keys: list[int], ids: InstanceIds) -> InstanceArrays:
    """Returns arrays of the surfaces that have a mesh. mesh_keys: the key of each surface's mesh, or 0."""
    entries = [entry for entry, key in zip(collected.surfaces, mesh_keys, strict=True) if key]
    arrays = InstanceArrays(
        entries=entries,
        matrices=_pick(collected.matrices, entries),
        mesh_keys=array("Q", filter(None, mesh_keys)),
        ids=array("Q", ids.of([(entry.key, entry.full_names) for entry in entries])),
        materials=array("Q"),
        material_first=array("I"),
        material_count=array("I"),
    )
    first_of_slots: dict[tuple[int, ...], int] = {}
    for entry in entries:
        slots = entry.material_keys
        first = first_of_slots.get(slots)
        if first is None:
            first = first_of_slots[slots] = len(arrays.materials)
            arrays.materials.extend(slots)
        arrays.material_first.append(first)
        arrays.material_count.append(len(slots))
    return arrays


def fill_instances(arrays: InstanceArrays, groups: dict[str, int]) -> tuple[native.Instances, list[Any]]:
    """Returns a native Instances, and the objects that must stay alive until the library has copied it.

    groups: the numbers of light groups by name.
    """
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
        "shadow_terminator_offsets": array("f", [entry.shadow_terminator[0] for entry in entries]),
        "shadow_terminator_shading_offsets": array("f", [entry.shadow_terminator[1] for entry in entries]),
        "name_index": array("I", [names.setdefault(entry.name, len(names)) for entry in entries]),
        "asset_name_index": array("I", [names.setdefault(entry.asset_name, len(names)) for entry in entries]),
        "meshes": arrays.mesh_keys,
        "ids": arrays.ids,
        "matrices": arrays.matrices,
        "matrices_previous": arrays.previous,
        "matrices_next": arrays.following,
        "material_first": arrays.material_first,
        "material_count": arrays.material_count,
        "materials": arrays.materials,
        "attributes": _attributes(arrays),
    }
    if any(entry.links != NO_LINKS for entry in entries):
        for name, code in (("receiver_set", "I"), ("receiver_mask", "Q"), ("blocker_set", "I"), ("blocker_mask", "Q")):
            columns[f"{name}s"] = array(code, [getattr(entry.links, name) for entry in entries])
    if groups:
        columns["light_groups"] = array("I", [groups.get(entry.light_group, 0) for entry in entries])
    if arrays.blur is not None:
        columns["shutter_first"], columns["shutter_count"] = arrays.blur.first, arrays.blur.count
        columns["shutter_matrices"] = arrays.blur.matrices
        struct.shutter_size = len(arrays.blur.matrices) // 16
    for name, values in columns.items():
        setattr(struct, name, native.pointer(values))
    struct.materials_size = len(arrays.materials)
    texts = native.name_array(list(names))
    struct.names = texts
    struct.name_count = len(names)
    attribute_names = native.name_array(arrays.attribute_names)
    struct.attribute_names = attribute_names
    struct.attribute_count = len(arrays.attribute_names)
    return struct, [columns, texts, attribute_names, arrays]


def _attributes(arrays: InstanceArrays) -> array:
    """Returns 4 values an instance for each attribute. Instances whose materials do not read it have MISSING."""
    values = array("f")
    for name in arrays.attribute_names:
        for entry in arrays.entries:
            values.extend(_attribute(entry, name))
    return values


def attributes_by_entry(entries: list[Entry], names: list[str]) -> list[array]:
    """Returns 4 values for each attribute of an entry, for each entry."""
    return [array("f", [value for name in names for value in _attribute(entry, name)]) for entry in entries]


def _attribute(entry: Entry, name: str) -> Color:
    return (entry.attributes or {}).get(name, MISSING)


def _flat(entries: list[Entry], attribute: str, width: int) -> array:
    values = array("f")
    for entry in entries:
        values.extend(getattr(entry, attribute))
    assert len(values) == width * len(entries)
    return values
