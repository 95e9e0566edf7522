"""Shader nodes except the Principled BSDF."""

from __future__ import annotations

from . import faults, working_space
from .node import NodeView, translator
from .ops import Distribution, Op, Subsurface
from .program import BLACK_CLOSURE, NO_NORMAL, Value, constant_float

_DISTRIBUTIONS = {
    "GGX": Distribution.SINGLE,
    "MULTI_GGX": Distribution.MULTIPLE,
    "BECKMANN": Distribution.BECKMANN,
    "ASHIKHMIN_SHIRLEY": Distribution.ASHIKHMIN_SHIRLEY,
    "SHARP": Distribution.SINGLE,
}
_LEGACY = 4
_CONDUCTOR = 4
_APPROXIMATE = 8


def distribution_mode(view: NodeView) -> int:
    return _DISTRIBUTIONS[getattr(view.node, "distribution", "GGX")]


def _versioned_distribution_mode(view: NodeView) -> int:
    """Returns the distribution, and whether microfacets are those of Blender before 4.0."""
    return distribution_mode(view) | (_LEGACY if view.version < (4, 0, 0) else 0)


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


def thin_film(view: NodeView) -> tuple[Value, ...]:
    """Returns thickness and IOR of the thin film, or nothing if the node has none."""
    thickness = view.value("Thin Film Thickness")
    if thickness.is_zero():
        return ()
    if working_space.current() is not None:
        view.warn_replaced("has a thin film of the colours of Rec. 709, while the working space is another")
    return thickness, view.value("Thin Film IOR")


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
    faults.warn_of_glossy(view, *inputs[1:3])
    if view.node.distribution == "MULTI_GGX" and view.version < (4, 0, 0):
        faults.warn_of_walk(view, *inputs[1:3])
    return view.add_closure(Op.GLOSSY, inputs, _versioned_distribution_mode(view))


@translator("ShaderNodeBsdfGlass")
def glass(view: NodeView) -> Value:
    inputs = (view.value("Color"), roughness(view), view.value("IOR"), view.direction("Normal"))
    faults.warn_of_refraction(view, inputs[1])
    return view.add_closure(Op.GLASS, inputs + thin_film(view), _versioned_distribution_mode(view))


@translator("ShaderNodeBsdfRefraction")
def refraction(view: NodeView) -> Value:
    inputs = (view.value("Color"), roughness(view), view.value("IOR"), view.direction("Normal"))
    faults.warn_of_refraction(view, inputs[1])
    return view.add_closure(Op.REFRACTION, inputs, _versioned_distribution_mode(view))


@translator("ShaderNodeBsdfMetallic")
def metallic(view: NodeView) -> Value:
    conductor = getattr(view.node, "fresnel_type", "F82") == "PHYSICAL_CONDUCTOR"
    inputs = (
        view.value("IOR" if conductor else "Base Color"),
        view.value("Extinction" if conductor else "Edge Tint"),
        view.value("Roughness"),
        view.value("Anisotropy"),
        view.value("Rotation"),
        view.direction("Normal"),
        view.direction("Tangent"),
    )
    mode = distribution_mode(view)
    if conductor:
        mode |= _CONDUCTOR | (_APPROXIMATE if view.version < (5, 0, 0) else 0)
    return view.add_closure(Op.METALLIC, inputs + thin_film(view), mode)


@translator("ShaderNodeBsdfSheen", "ShaderNodeBsdfVelvet")
def sheen(view: NodeView) -> Value:
    is_velvet = getattr(view.node, "distribution", "ASHIKHMIN") == "ASHIKHMIN"
    inputs = (view.value("Color"), view.value("Roughness", "Sigma"), view.direction("Normal"))
    if is_velvet:
        faults.warn_of_velvet(view)
    return view.add_closure(Op.SHEEN, inputs, int(is_velvet))


@translator("ShaderNodeBsdfToon")
def toon(view: NodeView) -> Value:
    if view.version < (4, 2, 0) and not view.value("Smooth").is_zero():
        view.warn_replaced("has the smooth edge of Blender 4.2, whose brightness in the light of the world differs")
    inputs = (view.value("Color"), view.value("Size"), view.value("Smooth"), view.direction("Normal"))
    return view.add_closure(Op.TOON, inputs, int(view.node.component == "GLOSSY"))


@translator("ShaderNodeBsdfTransparent")
def transparent(view: NodeView) -> Value:
    return view.add_closure(Op.TRANSPARENT, (view.value("Color"),))


@translator("ShaderNodeBsdfRayPortal")
def ray_portal(view: NodeView) -> Value:
    position = view.linked("Position")
    inputs = (view.value("Color"), position or NO_NORMAL, view.value("Direction"))
    faults.warn_of_portal(view, inputs[2])
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
