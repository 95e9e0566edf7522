"""The displacement of a material, and the nodes that make it."""

from __future__ import annotations

from typing import Any

from ..abi import Displacement
from . import convert
from .node import NodeView, translator
from .ops import NormalSpace, Op, VectorMath
from .program import VECTOR, Program, Value, constant_float, constant_vector
from .walker import Walker

_METHODS = {
    "BUMP": Displacement.BUMP,
    "DISPLACEMENT": Displacement.VERTICES,
    "BOTH": Displacement.BOTH,
}
_SPACES = {"TANGENT": NormalSpace.TANGENT, "OBJECT": NormalSpace.OBJECT, "WORLD": NormalSpace.WORLD}

# The version from which Cycles has a bump compare heights a tenth of a pixel apart by default.
_FINE_BUMPS_SINCE = (4, 2, 0)
# The version from which the bump of a flat face that is displaced, too, starts from the face as it was before.
_UNDISPLACED_FACES_SINCE = (5, 0, 0)


@translator("ShaderNodeDisplacement")
def displacement(view: NodeView) -> Value:
    inputs = (view.value("Height"), view.value("Midlevel"), view.value("Scale"), view.direction("Normal"))
    return view.add_vector(Op.DISPLACEMENT, inputs, _SPACES[view.node.space])


@translator("ShaderNodeVectorDisplacement")
def vector_displacement(view: NodeView) -> Value:
    inputs = (view.value("Vector"), view.value("Midlevel"), view.value("Scale"))
    return view.add_vector(Op.VECTOR_DISPLACEMENT, inputs, _SPACES[view.node.space])


def set_displacement(program: Program, material: Any, walker: Walker, socket: Any) -> None:
    """Sets what the Displacement input of the output node of a material says."""
    linked = walker.linked(socket, ())
    value = None if linked is None else convert.convert(program, linked, VECTOR)
    if value is None or value.is_zero():
        return
    program.displacement = _as_node(program, value)
    program.displacement_method = _METHODS[method_of(material)]
    if program.displacement_method == Displacement.BOTH and walker.version < _UNDISPLACED_FACES_SINCE:
        program.displacement_method = Displacement.BOTH_OF_FACES
    program.bump_filter_width = 0.1 if walker.version >= _FINE_BUMPS_SINCE else 1.0


def method_of(material: Any) -> str:
    """Returns BUMP, DISPLACEMENT or BOTH."""
    owner = material if hasattr(material, "displacement_method") else material.cycles
    return owner.displacement_method


def _as_node(program: Program, value: Value) -> Value:
    """Returns an output of a node that has the value."""
    if not value.is_constant:
        return value
    terms = (value, constant_vector((0.0, 0.0, 0.0)), constant_vector((0.0, 0.0, 0.0)), constant_float(1.0))
    return Value(VECTOR, node=program.add(Op.VECTOR_MATH, terms, VectorMath.ADD))
