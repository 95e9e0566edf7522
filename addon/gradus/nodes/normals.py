"""Nodes that bend normals."""

from __future__ import annotations

from .node import NodeView
from .ops import NormalSpace, Op
from .program import FLOAT, VECTOR, Value, constant_float
from .registry import translator

_SPACES = {
    "TANGENT": NormalSpace.TANGENT,
    "OBJECT": NormalSpace.OBJECT,
    "WORLD": NormalSpace.WORLD,
    "BLENDER_OBJECT": NormalSpace.BLENDER_OBJECT,
    "BLENDER_WORLD": NormalSpace.BLENDER_WORLD,
}


@translator("ShaderNodeNormalMap")
def normal_map(view: NodeView) -> Value:
    name = view.node.uv_map if view.node.space == "TANGENT" else ""
    resource = view.name_resource(name) if name else 0
    return view.add_vector(Op.NORMAL_MAP, (view.value("Strength"), view.value("Color")), _SPACES[view.node.space], resource=resource)


@translator("ShaderNodeBump")
def bump(view: NodeView) -> Value | None:
    normal = view.direction("Normal")
    if not view.is_linked("Height"):
        return normal
    # Before 4.2 the step was a pixel; later versions have it as an input.
    width = view.value("Filter Width") if view.has("Filter Width") else constant_float(1.0)
    inputs = (view.value("Strength"), view.value("Distance"), view.value("Height"), normal, width)
    return view.add_vector(Op.BUMP, inputs, 1 if view.node.invert else 0)


@translator("ShaderNodeNormal")
def normal(view: NodeView) -> Value:
    direction = tuple(view.node.outputs["Normal"].default_value)
    dot = view.output == "Dot"
    return view.add(Op.NORMAL_DOT, (view.value("Normal"),), floats=direction, kind=FLOAT if dot else VECTOR, output=1 if dot else 0)
