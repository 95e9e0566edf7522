"""Shader nodes except the Principled BSDF."""

from __future__ import annotations

from .node import NodeView, translator
from .ops import Distribution, Op, Subsurface
from .program import BLACK_CLOSURE, NO_NORMAL, Value, constant_float

_RENDERED = frozenset({"GGX", "MULTI_GGX", "SHARP"})


MULTIPLE_SCATTERING = 1
"""The mode GRADUS_DISTRIBUTION_MULTIPLE of closures."""


def distribution_mode(view: NodeView) -> int:
    """Returns MULTIPLE_SCATTERING or 0.

    Other distributions (Beckmann, Ashikhmin-Shirley) are rendered as GGX with a warning.

    A smooth surface gets no warning, because its distribution has no effect: Blender 3.4 creates glass with Beckmann
    and a roughness of 0.
    """
    distribution = getattr(view.node, "distribution", "GGX")
    if distribution not in _RENDERED and not roughness(view).is_zero():
        view.warn_replaced("is rendered with the distribution GGX")
    return MULTIPLE_SCATTERING if distribution == "MULTI_GGX" else 0


def filtered_mode(view: NodeView) -> int:
    """Returns distribution_mode(), and whether multiple scattering conserves energy under Filter Glossy."""
    mode = distribution_mode(view)
    return mode + Distribution.CONSERVED if mode == MULTIPLE_SCATTERING and view.version < (4, 0, 0) else mode


def roughness(view: NodeView) -> Value:
    """Returns the roughness input. Before Blender 4.0 the distribution SHARP stood for a roughness of 0."""
    if getattr(view.node, "distribution", "") == "SHARP":
        return constant_float(0.0)
    return view.value("Roughness")


def subsurface_mode(view: NodeView, method: str) -> int:
    """Returns the mode of subsurface scattering for a method of the node in its version of Blender."""
    if view.version < (4, 0, 0):
        walk = Subsurface.DIFFUSE_SKIN
    elif method_names(view) >= {"RANDOM_WALK_LEGACY"}:
        walk = Subsurface.DE_HULST
    else:
        walk = Subsurface.WALK
    methods = {
        "BURLEY": Subsurface.BURLEY,
        "RANDOM_WALK": walk,
        "RANDOM_WALK_SKIN": Subsurface.SKIN,
        "RANDOM_WALK_LEGACY": Subsurface.WALK,
        "RANDOM_WALK_FIXED_RADIUS": Subsurface.DIFFUSE,
    }
    return methods[method] + (Subsurface.ONCE if view.version < (5, 0, 0) else 0)


def method_names(view: NodeView) -> set[str]:
    """Returns the methods of subsurface scattering that the node has."""
    for name in ("subsurface_method", "falloff"):
        if (found := view.node.bl_rna.properties.get(name)) is not None:
            return {item.identifier for item in found.enum_items}
    return set()


def subsurface_anisotropy(view: NodeView, name: str) -> Value:
    """Returns the anisotropy below a surface. Light scatters backward from Blender 5.2 on."""
    anisotropy = view.value(name)
    return anisotropy if view.version >= (5, 2, 0) else view.clamped(anisotropy)


@translator("ShaderNodeSubsurfaceScattering")
def subsurface_scattering(view: NodeView) -> Value:
    inputs = (
        view.value("Color"),
        view.value("Scale"),
        view.value("Radius"),
        view.value("IOR"),
        view.value("Roughness", default=1.0),
        subsurface_anisotropy(view, "Anisotropy"),
        view.direction("Normal"),
    )
    return view.add_closure(Op.SUBSURFACE, inputs, subsurface_mode(view, view.node.falloff))


@translator("ShaderNodeBsdfDiffuse")
def diffuse(view: NodeView) -> Value:
    # The Oren-Nayar model conserves energy from 4.2 on.
    mode = 1 if view.version >= (4, 2, 0) else 0
    return view.add_closure(Op.DIFFUSE, (view.value("Color"), view.value("Roughness"), view.direction("Normal")), mode)


@translator("ShaderNodeBsdfTranslucent")
def translucent(view: NodeView) -> Value:
    return view.add_closure(Op.TRANSLUCENT, (view.value("Color"), view.direction("Normal")))


@translator("ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic")
def glossy(view: NodeView) -> Value:
    inputs = (
        view.value("Color"),
        roughness(view),
        view.value("Anisotropy"),
        view.value("Rotation"),
        view.direction("Normal"),
        view.direction("Tangent"),
    )
    return view.add_closure(Op.GLOSSY, inputs, filtered_mode(view))


@translator("ShaderNodeBsdfGlass")
def glass(view: NodeView) -> Value:
    inputs = (view.value("Color"), roughness(view), view.value("IOR"), view.direction("Normal"))
    return view.add_closure(Op.GLASS, inputs, filtered_mode(view) | (2 if view.version < (4, 0, 0) else 0))


@translator("ShaderNodeBsdfRefraction")
def refraction(view: NodeView) -> Value:
    distribution_mode(view)
    inputs = (view.value("Color"), roughness(view), view.value("IOR"), view.direction("Normal"))
    return view.add_closure(Op.REFRACTION, inputs)


@translator("ShaderNodeBsdfMetallic")
def metallic(view: NodeView) -> Value:
    if getattr(view.node, "fresnel_type", "F82") != "F82":
        view.warn_replaced("is rendered with base and edge colour instead of the refractive indices of a conductor")
    inputs = (
        view.value("Base Color"),
        view.value("Edge Tint"),
        view.value("Roughness"),
        view.value("Anisotropy"),
        view.value("Rotation"),
        view.direction("Normal"),
        view.direction("Tangent"),
    )
    return view.add_closure(Op.METALLIC, inputs, distribution_mode(view))


@translator("ShaderNodeBsdfSheen", "ShaderNodeBsdfVelvet")
def sheen(view: NodeView) -> Value:
    """Translates to the microfiber sheen of Blender 4.0.

    The Ashikhmin distribution of Velvet and Sheen nodes is replaced by it.
    """
    if getattr(view.node, "distribution", "ASHIKHMIN") == "ASHIKHMIN":
        view.warn_replaced("is rendered with the distribution Microfiber")
    return view.add_closure(Op.SHEEN, (view.value("Color"), view.value("Roughness", "Sigma"), view.direction("Normal")))


@translator("ShaderNodeBsdfTransparent")
def transparent(view: NodeView) -> Value:
    return view.add_closure(Op.TRANSPARENT, (view.value("Color"),))


@translator("ShaderNodeBsdfRayPortal")
def ray_portal(view: NodeView) -> Value:
    position = view.linked("Position")
    inputs = (view.value("Color"), position or NO_NORMAL, view.value("Direction"))
    return view.add_closure(Op.RAY_PORTAL, inputs, 0 if position is None else 1)


@translator("ShaderNodeHoldout")
def holdout(view: NodeView) -> Value:
    return view.add_closure(Op.HOLDOUT)


@translator("ShaderNodeEmission", "ShaderNodeBackground")
def emission(view: NodeView) -> Value:
    return view.add_closure(Op.EMISSION, (view.value("Color"), view.value("Strength")))


@translator("ShaderNodeMixShader")
def mix_shader(view: NodeView) -> Value | None:
    first, second = view.value("Shader"), view.value("Shader_001")
    if first == BLACK_CLOSURE and second == BLACK_CLOSURE:
        return None
    return view.add_closure(Op.MIX_SHADER, (view.value("Fac"), first, second))


@translator("ShaderNodeAddShader")
def add_shader(view: NodeView) -> Value | None:
    first, second = view.value("Shader"), view.value("Shader_001")
    if first == BLACK_CLOSURE and second == BLACK_CLOSURE:
        return None
    return view.add_closure(Op.ADD_SHADER, (first, second))
