"""Finds properties in Blender's descriptions of its types (RNA), and values of them other than the present ones."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Collection, Iterator
from fnmatch import fnmatch
from operator import attrgetter
from typing import Any

import bpy

Change = Callable[[Any], None]

WIDE = 10.0
"""A range of values that is wider than this is treated as unlimited."""

_GENERAL = frozenset(bpy.types.ID.bl_rna.properties.keys()) | {"rna_type", "name", "use_nodes", "cycles"}


def changes(owner: Any, skip: Collection[str] = (), inner: Collection[str] = ()) -> Iterator[tuple[str, Change]]:
    """Yields a suffix of a row's name and a change for each other value of each property of `owner`.

    skip: patterns of names that are left out; inner: names of structures within `owner` whose properties count as well.
    """
    for prop in owner.bl_rna.properties:
        name = prop.identifier
        if matches(name, skip) or (name in _GENERAL and name not in inner):
            continue
        if name in inner and prop.type == "POINTER":
            part = getattr(owner, name, None)
            if part is not None:
                for suffix, change in changes(part, skip, inner):
                    yield f".{name}{suffix}", _of_part(name, change)
        elif not prop.is_readonly:
            for value in other_values(owner, prop):
                yield f".{name}{_text(prop, value)}", _assign(name, value)


def names(owner: Any) -> list[str]:
    return list(owner.bl_rna.properties.keys())


def matches(name: str, patterns: Collection[str]) -> bool:
    return any(fnmatch(name, pattern) for pattern in patterns)


def of_part(path: str, parts: Iterator[tuple[str, Change]]) -> Iterator[tuple[str, Change]]:
    """Yields the changes of a structure within an owner as changes of the owner."""
    for suffix, change in parts:
        yield f".{path}{suffix}", _of_part(path, change)


def _of_part(path: str, change: Change) -> Change:
    return lambda owner: change(attrgetter(path)(owner))


def _assign(name: str, value: Any) -> Change:
    return lambda owner: setattr(owner, name, value)


def _text(prop: Any, value: Any) -> str:
    """Returns what tells a value from others of the property. A number is not named, because it is the only one."""
    if prop.type == "ENUM":
        return f"={value}"
    if prop.type == "BOOLEAN" and not prop.is_array:
        return f"={'on' if value else 'off'}"
    return ""


def enum_values(owner: Any, name: str) -> list[str]:
    """Returns the values that an enumeration accepts, which may depend on its owner.

    Blender tells these only where it refuses a value.
    """
    try:
        setattr(owner, name, "there is no such value")
    except TypeError as error:
        found = re.search(r"not found in (\(.*\))", str(error), re.DOTALL)
        if found:
            values = ast.literal_eval(found[1])
            return [values] if isinstance(values, str) else list(values)
    except AttributeError:  # a property that is only read
        pass
    return [item.identifier for item in owner.bl_rna.properties[name].enum_items if item.identifier]


def other_values(owner: Any, prop: Any) -> list[Any]:
    """Returns each other value of an enumeration or a switch, and one other value of a number."""
    name = prop.identifier
    try:
        present = getattr(owner, name)
    except (AttributeError, ValueError, TypeError):
        return []
    if prop.type == "ENUM":
        if prop.is_enum_flag:
            return []
        return [value for value in enum_values(owner, name) if value != present]
    if prop.type == "BOOLEAN":
        return [[not item for item in present]] if prop.is_array else [not present]
    if prop.type in {"INT", "FLOAT"}:
        values = _flat(present) if prop.is_array else [present]
        if prop.is_array and any(length == 0 for length in prop.array_dimensions[:1]):
            return []
        if len(values) > 4:
            return []
        others = [other_number(value, prop, index) for index, value in enumerate(values)]
        return [others] if prop.is_array else others
    return []


def _flat(values: Any) -> list[Any]:
    try:
        return [item for row in values for item in row]
    except TypeError:
        return list(values)


def other_number(value: float, prop: Any, index: int = 0) -> float:
    """Returns a number that is clearly another one and within the range that sliders have."""
    low, high = prop.soft_min, prop.soft_max
    if high - low <= WIDE:
        fraction = (0.35, 0.6, 0.45, 0.7)[index % 4]
        found = low + fraction * (high - low)
        if abs(found - value) < 0.1 * (high - low):
            found = low + (fraction + 0.25) * (high - low)
    else:
        found = value * (1.6 + 0.2 * index) if abs(value) > 1e-6 else 0.5 + 0.2 * index
        if prop.subtype == "ANGLE":
            found = value + math.radians(25.0 + 10.0 * index)
        found = min(max(found, low), high)
    if prop.type == "INT":
        found = round(found)
        if found == value:
            found = value + 1 if value < high else value - 1
    return found
