"""Rows of the types of cameras and of their properties: balls and checks that emit, without noise unless blurred."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import bpy
from support import images

from .. import rna, stages
from ..row import EXACT, NOISY, Family, Row

SKIPPED = ("show_*", "display_*", "passepartout*", "composition*", "background*", "type", "panorama_type", "fstop")
"""Properties of the viewport, and the types, which have rows of their own."""

OF_PANORAMAS = ("fisheye_*", "latitude_*", "longitude_*", "central_*", "custom_*")
OF_LENSES = ("angle*", "lens", "sensor_*", "ortho_scale", "lens_unit", "custom_*")
"""Properties that only one kind of camera has."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    camera = bpy.data.cameras.new("Probe")
    for kind in rna.enum_values(camera, "type"):
        panoramas = rna.enum_values(panorama_owner(camera), "panorama_type") if kind == "PANO" else [""]
        for panorama in panoramas:
            yield from rows_of(camera, kind, panorama)
    yield from rows_of_render()


def panorama_owner(camera: Any) -> Any:
    """Returns what has the properties of panoramas: before 5.0 the settings of Cycles, then the camera."""
    return camera if hasattr(camera, "panorama_type") else camera.cycles


def rows_of(camera: Any, kind: str, panorama: str) -> Iterator[Row]:
    camera.type = kind
    family = Family("Camera", f"Camera {kind} {panorama}".rstrip(), partial(stage, kind, panorama))
    yield family.row("", shift)
    if kind == "CUSTOM":
        return
    skipped = (*SKIPPED, *(OF_LENSES if panorama else OF_PANORAMAS))
    yield from family.rows(rna.of_part("data", rna.changes(camera, skipped)))
    if hasattr(camera, "cycles"):
        yield from family.rows(rna.of_part("data.cycles", rna.changes(camera.cycles, skipped)))
    blurred = Family("Camera", f"{family.name} with depth of field", partial(stage_blurred, kind, panorama), NOISY)
    yield blurred.row("", shift)
    if panorama:
        return
    yield from blurred.rows(rna.of_part("data.dof", rna.changes(camera.dof, ("use_dof",))))
    yield blurred.row(".data.dof.focus_object", focus_on_object)


def stage(kind: str, panorama: str) -> Any:
    stages.mesh("PLANE", stages.checks(1.7), "Floor", scale=(6.0, 6.0, 1.0), location=(0.13, 0.07, -0.6))
    for index in range(3):
        place = (1.2 * index - 1.1, 0.7 * index, 0.2 + 0.3 * index)
        stages.mesh("SPHERE", stages.checks(2.3), "Ball", scale=(0.6,) * 3, location=place)
    stages.gradient_world()
    camera = stages.camera((0.4, -4.5, 1.6))
    camera.data.type = kind
    camera.data.ortho_scale = 5.0
    if panorama:
        panorama_owner(camera.data).panorama_type = panorama
    return camera


def stage_blurred(kind: str, panorama: str) -> Any:
    camera = stage(kind, panorama)
    dof = camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 4.0, 0.5
    dof.aperture_blades = 5
    bpy.context.scene.cycles.filter_width = 1.5
    return camera


def shift(camera: Any) -> None:
    camera.location.z += 0.5


def focus_on_object(camera: Any) -> None:
    camera.data.dof.focus_object = bpy.data.objects["Ball"]


RENDER = ("pixel_aspect_*", "use_border", "border_*", "use_crop*", "resolution_percentage", "use_multiview", "views_*")
"""Properties of the render that belong to the camera's picture."""


def rows_of_render() -> Iterator[Row]:
    family = Family("Camera", "Render", stage_of_render, EXACT)
    render = bpy.context.scene.render
    others = [name for name in rna.names(render) if not rna.matches(name, RENDER)]
    yield from family.rows(rna.changes(render, others))


def stage_of_render() -> Any:
    stage("PERSP", "")
    render = bpy.context.scene.render
    images.use_exr(bpy.context.scene, Path("all views of a frame in one file"))
    render.image_settings.views_format = "MULTIVIEW"
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.2, 0.8, 0.3, 0.9
    return render
