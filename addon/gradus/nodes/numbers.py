"""Nodes of numbers: Math, Clamp, Map Range and Mix."""

from __future__ import annotations

from .colors import mix_colors
from .node import NodeView, translator
from .ops import MapRange, Math, Op
from .program import FLOAT, VECTOR, Value

_CLAMP_RESULT = 64
_CLAMP_RANGE, _OF_VECTORS = 8, 16


@translator("ShaderNodeMath")
def math(view: NodeView) -> Value:
    inputs = (view.value("Value"), view.value("Value_001"), view.value("Value_002"))
    return view.add_float(Op.MATH, inputs, Math[view.node.operation] | (_CLAMP_RESULT if view.node.use_clamp else 0))


@translator("ShaderNodeClamp")
def clamp(view: NodeView) -> Value:
    inputs = (view.value("Value"), view.value("Min"), view.value("Max"))
    return view.add_float(Op.CLAMP, inputs, 1 if view.node.clamp_type == "RANGE" else 0)


@translator("ShaderNodeMapRange")
def map_range(view: NodeView) -> Value:
    node = view.node
    mode = MapRange[node.interpolation_type] | (_CLAMP_RANGE if node.clamp else 0)
    if getattr(node, "data_type", "FLOAT") == "FLOAT_VECTOR":
        names = ("Vector", "From_Min_FLOAT3", "From_Max_FLOAT3", "To_Min_FLOAT3", "To_Max_FLOAT3", "Steps_FLOAT3")
        return view.add_vector(Op.MAP_RANGE, tuple(view.value(name) for name in names), mode | _OF_VECTORS)
    names = ("Value", "From Min", "From Max", "To Min", "To Max", "Steps")
    return view.add_float(Op.MAP_RANGE, tuple(view.value(name) for name in names), mode)


@translator("ShaderNodeMix")
def mix(view: NodeView) -> Value | None:
    node = view.node
    is_vector_factor = node.data_type == "VECTOR" and node.factor_mode == "NON_UNIFORM"
    factor = view.value("Factor_Vector" if is_vector_factor else "Factor_Float")
    if node.clamp_factor:
        factor = view.clamped(factor)
    if node.data_type == "RGBA":
        a, b = view.value("A_Color"), view.value("B_Color")
        return mix_colors(view, factor, a, b, node.blend_type, node.clamp_result)
    if node.data_type == "ROTATION":
        view.warn_replaced("mixes rotations, which is not supported: its first input is used")
        return view.value("A_Rotation")
    suffix, kind = ("Vector", VECTOR) if node.data_type == "VECTOR" else ("Float", FLOAT)
    return view.add(Op.MIX, (factor, view.value(f"A_{suffix}"), view.value(f"B_{suffix}")), kind=kind)
