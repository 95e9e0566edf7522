"""Colour ramps and curves as tables, sampled as in Cycles."""

from __future__ import annotations

from typing import Any

from .node import NodeView, translator
from .ops import Curves, Op
from .program import COLOR, FLOAT, VECTOR, Value

_SAMPLES = 257
# The number of samples of a colour ramp before Blender 4.0. It shows in the places where constant ramps step.
_OLD_RAMP_SAMPLES = 256


@translator("ShaderNodeValToRGB")
def color_ramp(view: NodeView) -> Value:
    ramp = view.node.color_ramp
    samples = _SAMPLES if view.version >= (4, 0, 0) else _OLD_RAMP_SAMPLES
    floats = tuple(float(c) for i in range(samples) for c in ramp.evaluate(i / (samples - 1)))
    mode = 1 if ramp.interpolation == "CONSTANT" else 0
    kind, output = (FLOAT, 1) if view.output == "Alpha" else (COLOR, 0)
    return view.add(Op.RAMP, (view.value("Fac"),), mode, floats, kind=kind, output=output)


def _range(curves: list[Any]) -> tuple[float, float]:
    """Returns the range in which the curves have points."""
    lows = [curve.points[0].location[0] for curve in curves]
    highs = [curve.points[len(curve.points) - 1].location[0] for curve in curves]
    low, high = min(lows), max(highs)
    return (low, high) if high > low else (low, low + 1.0)


def _header(mapping: Any, curves: list[Any]) -> tuple[list[float], list[float]]:
    """Returns range and extrapolation, and the positions to sample. It updates the mapping, which clips its points.

    As in Cycles, the range is that of the points before.
    """
    low, high = _range(curves)
    mapping.update()
    positions = [low + (high - low) * i / (_SAMPLES - 1) for i in range(_SAMPLES)]
    return [low, high, 1.0 if mapping.extend == "EXTRAPOLATED" else 0.0], positions


@translator("ShaderNodeRGBCurve")
def rgb_curves(view: NodeView) -> Value:
    mapping = view.node.mapping
    red, green, blue, combined = mapping.curves
    floats, positions = _header(mapping, [red, green, blue, combined])
    for position in positions:
        base = mapping.evaluate(combined, position)
        floats.extend(mapping.evaluate(curve, base) for curve in (red, green, blue))
    return view.add(Op.CURVES, (view.value("Fac"), view.value("Color")), Curves.RGB, tuple(floats))


@translator("ShaderNodeVectorCurve")
def vector_curves(view: NodeView) -> Value:
    mapping = view.node.mapping
    curves = list(mapping.curves)[:3]
    floats, positions = _header(mapping, curves)
    for position in positions:
        floats.extend(mapping.evaluate(curve, position) for curve in curves)
    return view.add(Op.CURVES, (view.value("Fac"), view.value("Vector")), Curves.VECTOR, tuple(floats), kind=VECTOR)


@translator("ShaderNodeFloatCurve")
def float_curve(view: NodeView) -> Value:
    mapping = view.node.mapping
    curve = mapping.curves[0]
    floats, positions = _header(mapping, [curve])
    floats.extend(mapping.evaluate(curve, position) for position in positions)
    inputs = (view.value("Factor", "Fac"), view.value("Value"))
    return view.add(Op.CURVES, inputs, Curves.FLOAT, tuple(floats), kind=FLOAT)
