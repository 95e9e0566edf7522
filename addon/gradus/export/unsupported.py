"""Warnings about objects and properties of a scene that Gradus does not render."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .. import compat

_KINDS = {"CURVES": "hair curves", "POINTCLOUD": "point clouds", "VOLUME": "volumes"}
KINDS = frozenset(_KINDS)
"""Types of objects that are not rendered."""

_PASSES = ("use_pass_shadow",) if compat.VERSION < (4, 0, 0) else ()
"""Switches of view layers for passes that Cycles makes and Gradus does not."""

_CYCLES_PASSES = ("pass_render_time",)
"""Switches of view_layer.cycles for such passes. It exists while Cycles' add-on is on, and versions differ in it."""


_DENOISING_PASSES = ("Denoising Roughness", "Denoising Specular Albedo") if compat.VERSION >= (5, 2, 0) else ()
"""Passes that Cycles' denoising data have beside those that Gradus makes."""


def is_gas_domain(obj: Any) -> bool:
    """Returns whether an object is the domain of a smoke or fire simulation, which has a volume and no surface."""
    return any(
        modifier.type == "FLUID"
        and modifier.fluid_type == "DOMAIN"
        and modifier.domain_settings is not None
        and modifier.domain_settings.domain_type == "GAS"
        for modifier in obj.modifiers
    )


def _has_volume(material: Any) -> bool:
    """Returns whether a material's output has a volume."""
    tree = material.node_tree if material is not None else None
    output = tree.get_output_node("CYCLES") if tree is not None else None
    return output is not None and output.inputs["Volume"].is_linked


def of_kind(name: str, kind: str) -> str:
    return f"Object '{name}' is left out: {_KINDS[kind]} are not supported"


def of_object(obj: Any, view_layer: Any) -> Iterator[str]:
    """Yields warnings about an evaluated object."""
    if view_layer.use_strand and any(_is_hair(modifier) for modifier in obj.modifiers):
        yield f"Object '{obj.name}': hair particles are not supported"
    if is_gas_domain(obj) and any(_has_volume(slot.material) for slot in obj.material_slots):
        yield of_kind(obj.name, "VOLUME")


def _is_hair(modifier: Any) -> bool:
    """Returns whether a modifier renders hair. Particles that are rendered as objects are instances."""
    if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
        return False
    settings = modifier.particle_system.settings
    return settings.type == "HAIR" and settings.render_type == "PATH"


def of_scene(scene: Any, view_layer: Any) -> Iterator[str]:
    """Yields warnings about a scene and a view layer."""
    camera = scene.camera
    if camera is not None and any(column.to_3d().length_squared == 0.0 for column in camera.matrix_world.col[:3]):
        yield f"Camera '{camera.name}' has scale 0, so that its direction is undefined"
    world = scene.world
    of_cycles = getattr(world.original, "cycles", None) if world is not None else None
    if not getattr(of_cycles, "use_shadows", True):  # from 5.2 on
        yield f"World '{world.name}': its light is shadowed, although its setting Shadows is off"
    if getattr(getattr(view_layer, "cycles", None), "denoising_store_passes", False):
        yield (
            f"View layer '{view_layer.name}': Denoising Normal, Albedo and Depth serve the reconstruction, too, so "
            "that they differ from those of Cycles where lights and mirrors show"
        )
    passes = list(missing_passes(view_layer))
    if passes:
        yield f"View layer '{view_layer.name}': not supported are the passes {', '.join(passes)}"


def missing_passes(view_layer: Any) -> Iterator[str]:
    """Yields the names of the passes that a view layer asks for and Gradus does not make."""
    for owner, switches in ((view_layer, _PASSES), (getattr(view_layer, "cycles", None), _CYCLES_PASSES)):
        for switch in switches:
            if getattr(owner, switch, False):
                yield owner.bl_rna.properties[switch].name
    if getattr(getattr(view_layer, "cycles", None), "denoising_store_passes", False):
        yield from _DENOISING_PASSES
