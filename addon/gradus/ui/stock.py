"""Which of Blender's own panels show for our engine: a pure predicate of a panel's name and engines.

Excluded is what would promise something that we do not do, or what we draw ourselves; in doubt a panel is included. Nothing is
remembered: joining and leaving compute the list again, so both may be called any number of times. Checked on 3.4, 4.5 and 5.0.
"""

from __future__ import annotations

from collections.abc import Iterator, MutableSet
from typing import Any

ENGINE = "GRADUS"
MEMBER_OF = "BLENDER_RENDER"
"""Panels that every engine may join list this one."""

EXCLUDED = {
    "VIEWLAYER_PT_layer_passes": "an empty shell; ours lists the passes that we have",
    "VIEWLAYER_PT_eevee_next_layer_passes_data": "EEVEE's passes",
    "VIEWLAYER_PT_filter": "hair and volumes are not rendered yet; ours has the rest",
    "VIEWLAYER_PT_override": "ours has the samples of the layer, too",
    "RENDER_PT_freestyle": "needs bl_use_custom_freestyle",
    "VIEWLAYER_PT_freestyle": "needs bl_use_custom_freestyle",
    "VIEWLAYER_PT_freestyle_lineset": "needs bl_use_custom_freestyle",
    "MATERIAL_PT_freestyle_line": "needs bl_use_custom_freestyle",
    "DATA_PT_light": "chooses the type only; ours has the values, too",
    "NODE_DATA_PT_light": "chooses the type only; ours has the values, too",
    "DATA_PT_area": "ours has the shape",
    "DATA_PT_falloff_curve": "a falloff of Blender Internal",
    "RENDER_PT_gpencil": "grease pencil is Blender's own",
    "RENDER_PT_motion_blur_curve": "ours is below our panel of motion blur",
    "RENDER_PT_hair": "hair is not rendered yet",
    "DATA_PT_volume_render": "volumes are not rendered yet",
    "DATA_PT_lightprobe": "light probes are EEVEE's",
    "RENDER_PT_eevee_performance": "EEVEE's",
    "OBJECT_PT_shadow_terminator": "has a shading offset, too; ours has what we render",
}
"""Panel -> why it does not show."""

INCLUDED = {
    "MATERIAL_PT_preview": "material previews are rendered by us",
    "WORLD_PT_context_world": "the world's datablock",
    "EEVEE_MATERIAL_PT_context_material": "list of material slots (the stock panel of all engines but Cycles)",
    "DATA_PT_camera_dof": "depth of field",
    "DATA_PT_camera_dof_aperture": "aperture and blades",
}
"""Panel that does not list MEMBER_OF -> why it shows."""


def joins(name: str, engines: frozenset[str] | set[str]) -> bool:
    """Whether the stock panel `name`, which shows for `engines`, is to show for ours."""
    if name in EXCLUDED:
        return False
    return name in INCLUDED or MEMBER_OF in engines


def stock_panels() -> Iterator[tuple[str, MutableSet[str]]]:
    """(name, COMPAT_ENGINES) of all panels that choose by engine, ours aside."""
    import bpy

    pending: list[Any] = list(bpy.types.Panel.__subclasses__())
    while pending:
        panel = pending.pop()
        pending.extend(panel.__subclasses__())
        engines = panel.__dict__.get("COMPAT_ENGINES") or getattr(panel, "COMPAT_ENGINES", None)
        if engines is not None and not panel.__name__.startswith("GRADUS_"):
            yield panel.__name__, engines


def join_all() -> None:
    for name, engines in stock_panels():
        if joins(name, engines - {ENGINE}):
            engines.add(ENGINE)


def leave_all() -> None:
    for _, engines in stock_panels():
        engines.discard(ENGINE)
