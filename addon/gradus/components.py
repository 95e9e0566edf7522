"""Components by light path expressions: names, an early check, and descriptions by the library. No Blender here."""

from __future__ import annotations

import ctypes
import re
from ctypes import byref
from dataclasses import dataclass
from functools import lru_cache

from .native import Library

DEFAULT = ("Emission", "Diffuse", "Reflection", "Transmission")
RESIDUAL = "Residual"
"""The component of all paths that no expression matches. It is the last of every set."""

_NAME = re.compile("[A-Za-z][A-Za-z0-9_]{0,23}")
_EVENTS = frozenset("EDRTL.")
_REPEATS = frozenset("*+?")


@dataclass(frozen=True)
class Component:
    name: str
    expression: str  # empty for Residual
    examples: str  # the shortest paths, separated by commas; empty where the component has no path


def names(text: str) -> list[str]:
    """Returns the names of a set, without the library.

    Entries of a malformed set that have no valid name are left out.
    """
    if not text:
        return [*DEFAULT, RESIDUAL]
    found: dict[str, str] = {}
    for entry in text.split(";"):
        name = entry.partition("=")[0].strip(" ")
        if _NAME.fullmatch(name) and name.lower() != RESIDUAL.lower():
            found.setdefault(name.lower(), name)
    return [*found.values(), RESIDUAL]


def syntax_error(text: str) -> str:
    """Returns the first mistake in the spelling of a set, or "" if there is none.

    This is an early check for callers that have no library yet. It looks at names, characters and parentheses only:
    whether expressions overlap or match no path is decided by the library alone.
    """
    entries = [entry for entry in text.split(";") if entry.strip(" ")]
    if text and not entries:
        return "the set of components is empty: expected Name=EXPRESSION;Name=EXPRESSION"
    for entry in entries:
        name, equals, expression = (part.strip(" ") for part in entry.partition("="))
        if not equals:
            return f"component '{entry.strip(' ')}': expected Name=EXPRESSION, as in Reflection=ER(D.*)?L"
        if not _NAME.fullmatch(name):
            return f"component '{name}': a name is a letter and then up to 23 letters, digits or '_'"
        if not expression:
            return f"component {name} has no expression"
        problem = _expression_error(expression)
        if problem:
            return f"component {name}: {problem}"
    return ""


def _expression_error(expression: str) -> str:
    depth = 0
    previous = "("
    for position, character in enumerate(expression, 1):
        if character == " ":
            continue
        if character in _REPEATS and previous in "(|":
            return f"character {position} of '{expression}': '{character}' has nothing to repeat"
        if character not in _EVENTS | _REPEATS | frozenset("(|)"):
            return f"character {position} of '{expression}': '{character}' is none of E D R T L . * + ? | ( )"
        depth += (character == "(") - (character == ")")
        if depth < 0:
            return f"character {position} of '{expression}': there is no '(' for this ')'"
        previous = character
    return f"a ')' is missing at the end of '{expression}'" if depth else ""


@lru_cache(maxsize=8)
def describe(library: Library, text: bytes) -> tuple[Component, ...]:
    """Returns all components of a set. Raises GradusError, with a text for users, if the set is malformed."""
    count = ctypes.c_uint32()
    library.components_check(text, byref(count))
    return tuple(_item(library, text, index) for index in range(count.value))


def _item(library: Library, text: bytes, index: int) -> Component:
    texts = [ctypes.c_char_p() for _ in range(3)]
    library.components_item(text, index, *map(byref, texts))
    return Component(*((value.value or b"").decode() for value in texts))


def component_of(library: Library, text: bytes, path: str) -> Component:
    """Returns the component to which a path such as "ETTDL" belongs. Raises GradusError if the text is not a path."""
    index = ctypes.c_uint32()
    library.components_classify(text, path.encode(), byref(index))
    return describe(library, text)[index.value]


def to_text(components: tuple[Component, ...]) -> str:
    """Returns a set as users write it."""
    return ";".join(f"{component.name}={component.expression}" for component in components if component.expression)
