"""Kinds of values, conversions between them, and default values of sockets."""

from __future__ import annotations

from typing import Any

from . import working_space
from .ops import Op
from .program import (
    BLACK_CLOSURE,
    COLOR,
    FLOAT,
    SHADER,
    VECTOR,
    Program,
    Value,
    constant_color,
    constant_float,
    constant_vector,
)

_KINDS = {
    "VALUE": FLOAT,
    "INT": FLOAT,
    "BOOLEAN": FLOAT,
    "VECTOR": VECTOR,
    "ROTATION": VECTOR,
    "RGBA": COLOR,
    "SHADER": SHADER,
}


def kind_of(socket: Any) -> str:
    return _KINDS.get(socket.type, FLOAT)


def default_value(socket: Any) -> Value:
    """Returns the value of an input without a link."""
    kind = kind_of(socket)
    if kind == SHADER:
        return BLACK_CLOSURE
    value = getattr(socket, "default_value", 0.0)
    if kind == FLOAT:
        return constant_float(value) if isinstance(value, (int, float)) else constant_float(0.0)
    return constant_color(value) if kind == COLOR else constant_vector((*value, 0.0)[:3])  # some have two components


def _to_float(program: Program, value: Value) -> Value:
    c = value.constant
    if value.kind == COLOR:
        return working_space.luminance(program, value)
    if value.is_constant:
        return constant_float((c[0] + c[1] + c[2]) / 3.0)
    return Value(FLOAT, node=program.add(Op.AVERAGE, (value,)))


def convert(program: Program, value: Value, kind: str) -> Value | None:
    """Returns `value` as another kind, or None if there is no conversion, as from a closure to a number."""
    if value.kind == kind:
        return value
    if value.kind == SHADER:
        return None
    if kind == SHADER:
        # A colour becomes emission, as in Cycles.
        return Value(SHADER, node=program.add(Op.EMISSION, (value, constant_float(1.0))))
    if kind == FLOAT:
        return _to_float(program, value)
    return Value(kind, value.constant, value.node, value.output)
