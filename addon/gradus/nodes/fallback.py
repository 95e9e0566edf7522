"""Replacements of nodes without a translator. They are not black, raise no exceptions, and add one warning.

Nodes that Cycles does not have have no replacement: as in Cycles, their links count as missing.
"""

from __future__ import annotations

from typing import Any

from . import convert
from .ops import Op
from .program import COLOR, FLOAT, NO_NORMAL, SHADER, Value, constant_color, constant_float
from .tree import find_socket

_GREY = (0.8, 0.8, 0.8)
_NOT_IN_CYCLES = frozenset(
    ("ShaderNodeEeveeSpecular", "ShaderNodeShaderToRGB", "ShaderNodeSqueeze", "ShaderNodeUVAlongStroke")
)


def replace(view: Any) -> Value | None:
    """Returns the value of an output of a node without a translator."""
    name = view.node.bl_idname
    kind = convert.kind_of(view.socket)
    if name in _NOT_IN_CYCLES:
        view.warn_replaced("is not for Cycles and its links are left out, as in Cycles")
        return None
    if kind == SHADER:
        view.warn_replaced("is not supported and is replaced by its shader input or by a diffuse surface")
        return _closure(view)
    if name.startswith("ShaderNodeTex"):
        view.warn_replaced("is not supported and is replaced by grey")
        return constant_float(0.5) if kind == FLOAT else Value(kind, (0.5, 0.5, 0.5, 1.0))
    view.warn_replaced("is not supported and its input is passed through")
    return _pass_through(view)


def _closure(view: Any) -> Value | None:
    """Returns the first shader input, or a diffuse surface with the node's colour."""
    for socket in view.node.inputs:
        if convert.kind_of(socket) == SHADER:
            value = view.walker.linked(socket, view.path)
            if value is not None and value.kind == SHADER:
                return value
    socket = find_socket(view.node.inputs, "Base Color", "Color")
    color = view.walker.input(socket, view.path) if socket is not None else constant_color(_GREY)
    normal = view.direction("Normal") if view.has("Normal") else NO_NORMAL
    return view.add_closure(Op.DIFFUSE, (color, constant_float(0.0), normal))


def _pass_through(view: Any) -> Value | None:
    for link in view.node.internal_links:
        if link.to_socket.identifier == view.socket.identifier:
            return view.walker.linked_or_default(link.from_socket, view.socket, view.path)
    kind = convert.kind_of(view.socket)
    default = getattr(view.socket, "default_value", None)
    if default is None:
        return None
    if kind == FLOAT:
        return constant_float(default) if isinstance(default, (int, float)) else None
    return constant_color(default) if kind == COLOR else Value(kind, (*tuple(default)[:3], 1.0))
