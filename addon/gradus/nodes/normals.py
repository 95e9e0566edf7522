"""Nodes that change normals."""

from __future__ import annotations

from .node import NodeView, translator
from .ops import BumpMode, Geometry, NormalSpace, Op, VectorMath
from .program import FLOAT, VECTOR, Value, constant_float, constant_vector

_SPACES = {
    "TANGENT": NormalSpace.TANGENT,
    "OBJECT": NormalSpace.OBJECT,
    "WORLD": NormalSpace.WORLD,
    "BLENDER_OBJECT": NormalSpace.BLENDER_OBJECT,
    "BLENDER_WORLD": NormalSpace.BLENDER_WORLD,
}

# The version from which the strength of a normal map scales the colour. Before, it blended the normals.
_SCALED_MAPS_SINCE = (4, 0, 0)
# The version from which closures, and not bumps, keep mirror directions above the surface.
_UNTILTED_BUMPS_SINCE = (3, 6, 0)
# The version from which Cycles scales the interpolated normal to length 1 before it builds the tangent space.
_UNIT_NORMALS_SINCE = (5, 2, 0)


@translator("ShaderNodeNormalMap")
def normal_map(view: NodeView) -> Value:
    in_tangent_space = view.node.space == "TANGENT"
    name = view.node.uv_map if in_tangent_space else ""
    resource = view.name_resource(name) if name else 0
    space = _SPACES[view.node.space]
    if in_tangent_space and view.version >= _UNIT_NORMALS_SINCE:
        space = NormalSpace.UNIT_TANGENT
    elif in_tangent_space and view.version < _SCALED_MAPS_SINCE:
        space = NormalSpace.BLENDED_TANGENT
    color = view.value("Color")
    if getattr(view.node, "convention", "OPENGL") == "DIRECTX":  # since Blender 5.2
        terms = (color, constant_vector((1.0, -1.0, 1.0)), constant_vector((0.0, 1.0, 0.0)), constant_float(1.0))
        color = view.add_vector(Op.VECTOR_MATH, terms, VectorMath.MULTIPLY_ADD)
    return view.add_vector(Op.NORMAL_MAP, (view.value("Strength"), color), space, resource=resource)


@translator("ShaderNodeBump")
def bump(view: NodeView) -> Value | None:
    normal = view.direction("Normal")
    if not view.is_linked("Height"):
        return normal if view.is_linked("Normal") else view.add_vector(Op.GEOMETRY, (), Geometry.NORMAL)
    # The step of the finite differences: a pixel before 4.2, an input from then on.
    width = view.value("Filter Width") if view.has("Filter Width") else constant_float(1.0)
    inputs = (view.value("Strength"), view.value("Distance"), view.value("Height"), normal, width)
    mode = BumpMode.INVERTED if view.node.invert else BumpMode.UPWARD
    if view.version < _UNTILTED_BUMPS_SINCE:
        mode |= BumpMode.TILTED
    return view.add_vector(Op.BUMP, inputs, mode)


@translator("ShaderNodeNormal")
def normal(view: NodeView) -> Value:
    direction = tuple(view.node.outputs["Normal"].default_value)
    dot = view.output == "Dot"
    kind, output = (FLOAT, 1) if dot else (VECTOR, 0)
    return view.add(Op.NORMAL_DOT, (view.value("Normal"),), floats=direction, kind=kind, output=output)
