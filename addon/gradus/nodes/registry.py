"""Translators by bl_idname."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .node import NodeView
    from .program import Value

Translator = Callable[["NodeView"], "Value | None"]

_translators: dict[str, Translator] = {}


def translator(*bl_idnames: str) -> Callable[[Translator], Translator]:
    """Registers a function that gives the value of output `view.output` of a node, or None: as if nothing was linked."""

    def register(function: Translator) -> Translator:
        for name in bl_idnames:
            _translators[name] = function
        return function

    return register


def find(bl_idname: str) -> Translator | None:
    return _translators.get(bl_idname)


def known() -> frozenset[str]:
    """Names of all nodes that are translated."""
    return frozenset(_translators)
