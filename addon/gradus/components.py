"""Components of the picture by path expressions (contract 3): their names, and what the library says of a set. No Blender here."""

from __future__ import annotations

import ctypes
import re
from ctypes import byref
from dataclasses import dataclass
from functools import lru_cache

from .native import Library

DEFAULT = ("Emission", "Diffuse", "Reflection", "Transmission")
RESIDUAL = "Residual"
"""What no expression matches; the last of every set."""

_NAME = re.compile("[A-Za-z][A-Za-z0-9_]{0,23}")


@dataclass(frozen=True)
class Component:
    name: str
    expression: str  # empty: Residual
    examples: str  # shortest paths, with commas; empty: no path is left for it


def names(text: str) -> list[str]:
    """Of a set as the user writes it, without the library; of a set that it would refuse those that are names."""
    if not text:
        return [*DEFAULT, RESIDUAL]
    found: dict[str, str] = {}
    for entry in text.split(";"):
        name = entry.partition("=")[0].strip(" ")
        if _NAME.fullmatch(name) and name.lower() != RESIDUAL.lower():
            found.setdefault(name.lower(), name)
    return [*found.values(), RESIDUAL]


@lru_cache(maxsize=8)
def describe(library: Library, text: bytes) -> tuple[Component, ...]:
    """All components of a set. Raises GradusError, with a text for users, where it is none."""
    count = ctypes.c_uint32()
    library.components_check(text, byref(count))
    return tuple(_item(library, text, index) for index in range(count.value))


def _item(library: Library, text: bytes, index: int) -> Component:
    parts = [ctypes.c_char_p() for _ in range(3)]
    library.components_item(text, index, *map(byref, parts))
    return Component(*((part.value or b"").decode() for part in parts))


def component_of(library: Library, text: bytes, path: str) -> Component:
    """The one to which a path belongs, such as "ETTDL". Raises GradusError where it is no path."""
    index = ctypes.c_uint32()
    library.components_classify(text, path.encode(), byref(index))
    return describe(library, text)[index.value]


def written(components: tuple[Component, ...]) -> str:
    """The set as users write it."""
    return ";".join(f"{component.name}={component.expression}" for component in components if component.expression)
