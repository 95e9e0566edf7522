"""Colours of the working space, in which Blender renders: linear Rec. 709 unless the file or the configuration differ.

Operations that make colours from physics make those of Rec. 709, so that a matrix follows them.
"""

from __future__ import annotations

from functools import lru_cache

from .. import color, compat
from .ops import ColorModel, Op, VectorMath
from .program import COLOR, FLOAT, Program, Value, constant_float, constant_vector

REC709_LUMINANCE = (0.2126, 0.7152, 0.0722)


@lru_cache(maxsize=1)
def _of_name(_name: str) -> color.WorkingSpace | None:
    colors = color.host_colors(compat.bundled_python_packages())
    return colors.working_space() if colors is not None else None


def current() -> color.WorkingSpace | None:
    """Returns the working space, or None if it is linear Rec. 709 as far as Python can tell."""
    return _of_name(compat.working_space())


def _dot(program: Program, value: Value, weights: tuple[float, float, float]) -> Value:
    inputs = (value, constant_vector(weights), constant_vector((0.0, 0.0, 0.0)), constant_float(1.0))
    return Value(FLOAT, node=program.add(Op.VECTOR_MATH, inputs, VectorMath.DOT_PRODUCT), output=1)


def luminance(program: Program, value: Value) -> Value:
    """Returns the luminance of a colour."""
    space = current()
    weights = space.luminance if space is not None else REC709_LUMINANCE
    if value.is_constant:
        return constant_float(sum(weight * x for weight, x in zip(weights, value.constant, strict=False)))
    if space is None:
        return Value(FLOAT, node=program.add(Op.RGB_TO_BW, (value,)))
    return _dot(program, value, space.luminance)


def from_rec709(program: Program, value: Value) -> Value:
    """Returns a colour of linear Rec. 709 in the working space, with components of at least 0."""
    space = current()
    if space is None:
        return value
    rows = tuple(_dot(program, value, row) for row in space.from_rec709)
    mixed = Value(COLOR, node=program.add(Op.COMBINE, rows, ColorModel.RGB))
    black = (constant_vector((0.0, 0.0, 0.0)), constant_vector((0.0, 0.0, 0.0)), constant_float(1.0))
    return Value(COLOR, node=program.add(Op.VECTOR_MATH, (mixed, *black), VectorMath.MAXIMUM))
