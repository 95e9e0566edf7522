"""Colour ramps and curves, sampled as Cycles does."""

from __future__ import annotations

from typing import Any

from .node import NodeView
from .ops import Curves, Op
from .program import COLOR, FLOAT, VECTOR, Value
from .registry import translator

_SAMPLES = 256


@translator("ShaderNodeValToRGB")
def color_ramp(view: NodeView) -> Value:
    ramp = view.node.color_ramp
    floats = tuple(float(c) for i in range(_SAMPLES) for c in ramp.evaluate(i / (_SAMPLES - 1)))
    alpha = view.output == "Alpha"
    mode = 1 if ramp.interpolation == "CONSTANT" else 0
    return view.add(Op.RAMP, (view.value("Fac"),), mode, floats, kind=FLOAT if alpha else COLOR, output=1 if alpha else 0)


def _range(curves: list[Any]) -> tuple[float, float]:
    """Where any of the curves has points."""
    lows = [curve.points[0].location[0] for curve in curves]
    highs = [curve.points[len(curve.points) - 1].location[0] for curve in curves]
    low, high = min(lows), max(highs)
    return (low, high) if high > low else (low, low + 1.0)


def _header(mapping: Any, curves: list[Any]) -> tuple[list[float], list[float]]:
    """Range and extrapolation, and the places to sample."""
    low, high = _range(curves)
    places = [low + (high - low) * i / (_SAMPLES - 1) for i in range(_SAMPLES)]
    return [low, high, 1.0 if mapping.extend == "EXTRAPOLATED" else 0.0], places


@translator("ShaderNodeRGBCurve")
def rgb_curves(view: NodeView) -> Value:
    mapping = view.node.mapping
    mapping.initialize()
    red, green, blue, combined = mapping.curves
    floats, places = _header(mapping, [red, green, blue, combined])
    for place in places:
        base = mapping.evaluate(combined, place)
        floats.extend(mapping.evaluate(curve, base) for curve in (red, green, blue))
    return view.add(Op.CURVES, (view.value("Fac"), view.value("Color")), Curves.RGB, tuple(floats))


@translator("ShaderNodeVectorCurve")
def vector_curves(view: NodeView) -> Value:
    mapping = view.node.mapping
    mapping.initialize()
    curves = list(mapping.curves)[:3]
    floats, places = _header(mapping, curves)
    for place in places:
        floats.extend(mapping.evaluate(curve, place) for curve in curves)
    return view.add(Op.CURVES, (view.value("Fac"), view.value("Vector")), Curves.VECTOR, tuple(floats), kind=VECTOR)


@translator("ShaderNodeFloatCurve")
def float_curve(view: NodeView) -> Value:
    mapping = view.node.mapping
    mapping.initialize()
    curve = mapping.curves[0]
    floats, places = _header(mapping, [curve])
    floats.extend(mapping.evaluate(curve, place) for place in places)
    return view.add(Op.CURVES, (view.value("Factor", "Fac"), view.value("Value")), Curves.FLOAT, tuple(floats), kind=FLOAT)
