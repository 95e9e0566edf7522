"""Principled BSDF, and the default surface.

Before Blender 4.0, the node is a native operation to which emission and alpha are added. From 4.0 on, only alpha is
added.
"""

from __future__ import annotations

from . import faults
from .node import NodeView, translator
from .ops import Distribution, Op, VectorMath
from .program import NO_NORMAL, Program, Value, constant_color, constant_float
from .shaders import distribution_mode, subsurface_anisotropy, subsurface_mode, thin_film

_WHITE = constant_color((1.0, 1.0, 1.0))
_NONE = constant_float(0.0)
_LEGACY_FILM, _SINGLE_COAT = 32, 64


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


def _before_4(view: NodeView) -> Value:
    base, subsurface = view.value("Base Color"), view.value("Subsurface")
    diffuse, mode, below = base, distribution_mode(view), ()
    if not subsurface.is_zero():
        diffuse = view.add(Op.MIX, (view.clamped(subsurface), base, view.value("Subsurface Color")))
        mode |= subsurface_mode(view, view.node.subsurface_method)
        below = (
            subsurface,
            view.value("Subsurface Radius"),
            view.value("Subsurface IOR"),
            subsurface_anisotropy(view, "Subsurface Anisotropy"),
        )
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
    if not view.value("Transmission").is_zero():
        faults.warn_of_refraction(view, view.value("Roughness"), view.value("Transmission Roughness"))
    if not view.value("Clearcoat").is_zero():
        view.warn_replaced("has a clearcoat with the highlight of GGX, whose tail is shorter than that of Cycles")
    surface = view.add_closure(Op.PRINCIPLED_3, inputs + below, mode)
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
    subsurface, mode, below = view.value("Subsurface Weight"), distribution_mode(view), ()
    if not subsurface.is_zero():
        mode |= subsurface_mode(view, view.node.subsurface_method)
        below = (
            subsurface,
            view.value("Subsurface Radius"),
            view.value("Subsurface Scale"),
            view.value("Subsurface IOR"),
            subsurface_anisotropy(view, "Subsurface Anisotropy"),
        )
        if not view.value("Thin Wall").is_zero():
            view.warn_replaced("has a thin wall with subsurface scattering, which is rendered as that of a solid")
    if not view.value("Transmission Weight").is_zero():
        faults.warn_of_refraction(view, view.value("Roughness"))
    if view.version < (4, 5, 0):
        mode |= _SINGLE_COAT
    if film := thin_film(view):
        mode |= 0 if view.version >= (5, 0, 0) else _LEGACY_FILM
        below = (below or (_NONE,) * 5) + film
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
    return view.add_closure(Op.PRINCIPLED, inputs + below, mode)


_DEFAULT_INPUTS = (
    constant_color((0.8, 0.8, 0.8)),  # base colour
    _NONE,  # metallic
    constant_float(0.5),  # roughness
    constant_float(1.5),  # IOR
    _NONE,  # diffuse roughness
    constant_float(0.5),  # specular IOR level
    _WHITE,  # specular tint
    _NONE,  # anisotropic
    _NONE,  # anisotropic rotation
    _NONE,  # transmission
    _NONE,  # coat
    constant_float(0.03),  # coat roughness
    constant_float(1.5),  # coat IOR
    _WHITE,  # coat tint
    _NONE,  # sheen
    constant_float(0.5),  # sheen roughness
    _WHITE,  # sheen tint
    _NONE,  # emission
    NO_NORMAL,
    NO_NORMAL,  # coat normal
    NO_NORMAL,  # tangent
)


def default_surface() -> Program:
    """Returns the program of surfaces without a material from Blender 5.0 on: an unchanged Principled BSDF.

    Before 5.0, such surfaces are grey and diffuse, which is the library's own default material (key 0).
    """
    program = Program(name="default_surface")
    program.surface = program.add(Op.PRINCIPLED, _DEFAULT_INPUTS, Distribution.MULTIPLE)
    return program
