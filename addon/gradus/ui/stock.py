"""Blender's own panels that are shown for Gradus, by the name and the engines of a panel.

Panels of unsupported features and panels that Gradus replaces are excluded. All others are included. The list is
computed again in each call, so that the functions may be called repeatedly. It was checked on Blender 3.4, 4.5 and 5.0.
"""

from __future__ import annotations

from collections.abc import Iterator, MutableSet
from typing import Any

ENGINE = "GRADUS"
MEMBER_OF = "BLENDER_RENDER"
"""The engine in COMPAT_ENGINES of all panels that are not specific to an engine."""

EXCLUDED = {
    "VIEWLAYER_PT_eevee_next_layer_passes_data": "passes of EEVEE",
    "VIEWLAYER_PT_filter": "has switches of hair and volumes, which are not supported; replaced",
    "VIEWLAYER_PT_override": "replaced by a panel that also has the samples",
    "RENDER_PT_freestyle": "needs bl_use_custom_freestyle",
    "VIEWLAYER_PT_freestyle": "needs bl_use_custom_freestyle",
    "VIEWLAYER_PT_freestyle_lineset": "needs bl_use_custom_freestyle",
    "MATERIAL_PT_freestyle_line": "needs bl_use_custom_freestyle",
    "DATA_PT_light": "has the type only; replaced",
    "NODE_DATA_PT_light": "has the type only; replaced",
    "DATA_PT_area": "replaced",
    "DATA_PT_falloff_curve": "not supported; belongs to Blender Internal",
    "RENDER_PT_gpencil": "Blender renders grease pencil",
    "RENDER_PT_motion_blur_curve": "replaced by a child of the panel Motion Blur",
    "RENDER_PT_hair": "hair is not supported",
    "DATA_PT_volume_render": "volumes are not supported",
    "DATA_PT_lightprobe": "light probes belong to EEVEE",
    "RENDER_PT_eevee_performance": "belongs to EEVEE",
    "OBJECT_PT_shadow_terminator": "replaced by a panel that Blender 3.4 has, too",
}
"""Panels that are not shown, and why."""

INCLUDED = {
    "VIEWLAYER_PT_layer_passes": "contains the panels with passes",
    "VIEWLAYER_PT_layer_passes_cryptomatte": "Cryptomatte",
    "VIEWLAYER_PT_layer_passes_aov": "AOVs",
    "VIEWLAYER_PT_layer_passes_lightgroups": "light groups",
    "MATERIAL_PT_preview": "material previews are rendered by Gradus",
    "WORLD_PT_context_world": "the world's datablock",
    "EEVEE_MATERIAL_PT_context_material": "list of material slots (the stock panel of all engines but Cycles)",
    "DATA_PT_camera_dof": "depth of field",
    "DATA_PT_camera_dof_aperture": "aperture and blades",
}
"""Panels that do not list MEMBER_OF and are shown, with their purpose."""


def is_shown(name: str, engines: frozenset[str] | set[str]) -> bool:
    """Returns whether the panel `name`, which is shown for `engines`, is shown for Gradus."""
    if name in EXCLUDED:
        return False
    return name in INCLUDED or MEMBER_OF in engines


def stock_panels() -> Iterator[tuple[str, MutableSet[str]]]:
    """Yields (name, COMPAT_ENGINES) of all panels that depend on the engine, except those of Gradus."""
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
        if is_shown(name, engines - {ENGINE}):
            engines.add(ENGINE)


def leave_all() -> None:
    for _, engines in stock_panels():
        engines.discard(ENGINE)
