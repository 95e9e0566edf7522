"""Warnings about shaders that Cycles renders by formulas with faults, which Gradus does not repeat."""

from __future__ import annotations

from .node import NodeView
from .ops import Geometry, NormalSpace, Op, VectorMath
from .program import Value

_ROUGH_REFLECTION = 0.35
"""The alpha from which Ashikhmin and Shirley's reflection in Cycles is clearly too bright at grazing views."""

_ROUGH_WALK = 0.4
"""The roughness from which light of several bounces between microfacets shows."""

_ROUGH_GLASS = 0.4
"""The roughness from which refraction in Cycles is clearly too bright: by 2 % at 0.5, and by 4 % at 0.8."""

_UNIT_DIRECTIONS = {
    (int(Op.GEOMETRY), int(kind)) for kind in (Geometry.NORMAL, Geometry.TRUE_NORMAL, Geometry.INCOMING)
}
_UNIT_DIRECTIONS.add((int(Op.VECTOR_MATH), int(VectorMath.NORMALIZE)))
_ABOVE_SURFACE = {
    (int(Op.NORMAL_MAP), int(space))
    for space in (NormalSpace.TANGENT, NormalSpace.UNIT_TANGENT, NormalSpace.BLENDED_TANGENT)
}
_ABOVE_SURFACE |= {(int(Op.GEOMETRY), int(kind)) for kind in (Geometry.NORMAL, Geometry.TRUE_NORMAL)}
_UNIT_OPS = {int(op) for op in (Op.NORMAL_MAP, Op.BUMP, Op.TANGENT)}


def warn_of_glossy(view: NodeView, roughness: Value, anisotropy: Value) -> None:
    """Warns of distributions of microfacets whose light Cycles samples by another density than that it divides by."""
    distribution = view.node.distribution
    if distribution == "BECKMANN" and view.version < (3, 5, 0) and not anisotropy.is_zero():
        view.warn_replaced(
            "is anisotropic with the distribution Beckmann, whose brightness is wrong in Cycles before Blender 3.5"
        )
    if distribution == "ASHIKHMIN_SHIRLEY" and _largest_alpha(roughness, anisotropy) > _ROUGH_REFLECTION:
        view.warn_replaced(
            "is rough with the distribution Ashikhmin-Shirley, which is too bright in Cycles where the surface is seen "
            "at a flat angle"
        )


def warn_of_walk(view: NodeView, roughness: Value, anisotropy: Value) -> None:
    """Warns of rough multiple scattering, whose colour Cycles applies once to rays and twice to lights.

    This is the walk of Blender before 4.0. Gradus spreads that light evenly, in a colour between the two.
    """
    is_rough = not roughness.is_constant or roughness.constant[0] > _ROUGH_WALK
    if is_rough or not anisotropy.is_zero():
        view.warn_replaced(
            "has light of several bounces between its microfacets, which Cycles colours in one way for lights and in "
            "another for rays; Gradus spreads it evenly, in a colour between these"
        )


def _largest_alpha(roughness: Value, anisotropy: Value) -> float:
    """Returns the larger alpha of a glossy shader. Inputs that vary count as 1."""
    if not (roughness.is_constant and anisotropy.is_constant):
        return 1.0
    stretch = min(abs(anisotropy.constant[0]), 0.99)
    return min(max(roughness.constant[0], 0.0), 1.0) ** 2 / (1.0 - stretch)


def warn_of_refraction(view: NodeView, *roughnesses: Value) -> None:
    """Warns of rough refraction, of which any of the roughnesses varies or is large.

    Where Cycles samples lights, it counts directions into which no microfacet refracts. With lights that only rays
    find, its pictures are those of Gradus. Also warns of normals with which Cycles before Blender 4.0 refracts wrongly.
    """
    if view.version < (4, 0, 0) and _may_point_away(view, view.direction("Normal")):
        view.warn_replaced(
            "has a normal that is neither a bump nor a tangent map: where it points away from the surface, Cycles "
            "before Blender 4.0 refracts light from the viewer's side, too"
        )
    if any(not value.is_constant or value.constant[0] > _ROUGH_GLASS for value in roughnesses):
        view.warn_replaced(
            "refracts roughly: lights behind it are up to 7 % brighter in Cycles, which counts directions, too, "
            "into which no light is refracted"
        )


def _may_point_away(view: NodeView, normal: Value) -> bool:
    """Returns whether a normal may point away from the surface, as its own, a bump's and a tangent map's do not."""
    if normal.is_constant:
        return not normal.is_zero()
    op, mode = view.program.nodes[normal.node][:2]
    return op != Op.BUMP and (op, mode) not in _ABOVE_SURFACE


def warn_of_velvet(view: NodeView) -> None:
    """Warns of bumps, which Cycles before Blender 4.0 darkens for one of its two ways to sample light."""
    if view.is_linked("Normal") and view.version < (4, 0, 0):
        view.warn_replaced(
            "has bumps, which Cycles before Blender 4.0 darkens in the light of the world and of large lights, but not "
            "in that of small ones"
        )


def warn_of_portal(view: NodeView, direction: Value) -> None:
    """Warns of directions of another length than 1, with which Cycles before Blender 5.2 renders wrongly."""
    if view.version < (5, 2, 0) and not _is_unit(view, direction):
        view.warn_replaced(
            "may have a direction whose length is not 1, with which Cycles before Blender 5.2 renders what is behind "
            "the portal wrongly; normalize it by a Vector Math node"
        )


def _is_unit(view: NodeView, direction: Value) -> bool:
    """Returns whether a direction is known to have the length 1, or 0, which stands for straight on."""
    if direction.is_constant:
        length = sum(x * x for x in direction.constant[:3]) ** 0.5
        return length == 0.0 or abs(length - 1.0) < 1e-3
    op, mode = view.program.nodes[direction.node][:2]
    return op in _UNIT_OPS or (op, mode) in _UNIT_DIRECTIONS
