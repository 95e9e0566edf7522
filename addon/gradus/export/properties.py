"""Properties of data-blocks as colours, as Attribute nodes read them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

Color = tuple[float, float, float, float]
_ENDS_WITH_INDEX = re.compile(r"\[\d+\]$")
MISSING: Color = (0.0, 0.0, 0.0, 0.0)
"""The value of a property that no data-block has."""


def find_color(owners: Iterable[Any], name: str) -> Color | None:
    """Returns a property of the first of several data-blocks that has it, or None. Some may be None."""
    for owner in owners:
        found = property_color(owner, name) if owner is not None else None
        if found is not None:
            return found
    return None


def property_color(owner: Any, name: str) -> Color | None:
    """Returns a custom property, or else the property at a path such as "pass_index", or None if it is no colour.

    As in Cycles, a path to an element of an array names nothing.
    """
    try:
        value = owner[name]
    except (KeyError, TypeError):
        if _ENDS_WITH_INDEX.search(name):
            return None
        try:
            value = owner.path_resolve(name)
        except ValueError:
            return None
    return _as_color(value)


def _as_color(value: Any) -> Color | None:
    """Converts numbers, and arrays of up to four of them, whose alpha is 1 if they have none."""
    if isinstance(value, (bool, int, float)):
        return (float(value),) * 3 + (1.0,)
    if isinstance(value, str) or not hasattr(value, "__len__") or len(value) > 4:
        return None
    values = list(value) if not hasattr(value, "keys") else [None]
    if not all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in values):
        return None
    return tuple(map(float, values)) + MISSING[len(values) : 3] + (1.0,) * (len(values) < 4)
