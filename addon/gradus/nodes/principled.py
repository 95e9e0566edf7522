"""Principled BSDF: before 4.0 by its own operation, with emission and alpha around it; from 4.0 on with alpha around it."""

from __future__ import annotations

from .node import NodeView
from .ops import Op, VectorMath
from .program import Value, constant_color, constant_float
from .registry import translator
from .shaders import distribution_mode

_WHITE = constant_color((1.0, 1.0, 1.0))


@translator("ShaderNodeBsdfPrincipled")
def principled(view: NodeView) -> Value:
    legacy = not view.has("Specular IOR Level")
    surface = _before_4(view) if legacy else _since_4(view)
    return _with_alpha(view, surface)


def _with_alpha(view: NodeView, surface: Value) -> Value:
    alpha = view.value("Alpha", default=1.0)
    if alpha.is_constant and alpha.constant[0] >= 1.0:
        return surface
    clear = view.add_closure(Op.TRANSPARENT, (_WHITE,))
    return view.add_closure(Op.MIX_SHADER, (alpha, clear, surface))


def _note_subsurface(view: NodeView, weight: Value) -> None:
    if not weight.is_zero():
        view.warn_replaced("has subsurface scattering, which is rendered as diffuse")


def _before_4(view: NodeView) -> Value:
    base, subsurface = view.value("Base Color"), view.value("Subsurface")
    _note_subsurface(view, subsurface)
    diffuse = base if subsurface.is_zero() else view.add(Op.MIX, (view.clamped(subsurface), base, view.value("Subsurface Color")))
    inputs = (
        base,
        diffuse,
        view.value("Metallic"),
        view.value("Specular"),
        view.value("Specular Tint"),
        view.value("Roughness"),
        view.value("Anisotropic"),
        view.value("Anisotropic Rotation"),
        view.value("Sheen"),
        view.value("Sheen Tint"),
        view.value("Clearcoat"),
        view.value("Clearcoat Roughness"),
        view.value("IOR"),
        view.value("Transmission"),
        view.value("Transmission Roughness"),
        view.direction("Normal"),
        view.direction("Clearcoat Normal"),
        view.direction("Tangent"),
    )
    surface = view.add_closure(Op.PRINCIPLED_3, inputs, distribution_mode(view))
    color, strength = view.value("Emission"), view.value("Emission Strength", default=1.0)
    if color.is_zero() or strength.is_zero():
        return surface
    return view.add_closure(Op.ADD_SHADER, (surface, view.add_closure(Op.EMISSION, (color, strength))))


def _emission(view: NodeView) -> Value:
    color, strength = view.value("Emission Color"), view.value("Emission Strength")
    if color.is_zero() or strength.is_zero():
        return constant_float(0.0)
    if color.is_constant and strength.is_constant:
        return constant_color(tuple(channel * strength.constant[0] for channel in color.constant[:3]))
    return view.add(Op.VECTOR_MATH, (color, strength), VectorMath.MULTIPLY)


def _since_4(view: NodeView) -> Value:
    _note_subsurface(view, view.value("Subsurface Weight"))
    thickness = view.value("Thin Film Thickness")
    if not thickness.is_zero():
        view.warn_replaced("has a thin film, which is left out")
    inputs = (
        view.value("Base Color"),
        view.value("Metallic"),
        view.value("Roughness"),
        view.value("IOR"),
        view.value("Diffuse Roughness"),
        view.value("Specular IOR Level"),
        view.value("Specular Tint"),
        view.value("Anisotropic"),
        view.value("Anisotropic Rotation"),
        view.value("Transmission Weight"),
        view.value("Coat Weight"),
        view.value("Coat Roughness"),
        view.value("Coat IOR"),
        view.value("Coat Tint"),
        view.value("Sheen Weight"),
        view.value("Sheen Roughness"),
        view.value("Sheen Tint"),
        _emission(view),
        view.direction("Normal"),
        view.direction("Coat Normal"),
        view.direction("Tangent"),
    )
    return view.add_closure(Op.PRINCIPLED, inputs, distribution_mode(view))
