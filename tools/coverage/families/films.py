"""Rows of the settings of a scene: film, light paths, sampling, simplification and motion blur.

Gradus takes those that it has from Cycles (Copy from Cycles).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from .. import rna, stages
from ..row import NOISY, Family, Row

SKIPPED = (
    "preview_*",
    "use_preview*",
    "debug_*",
    "*denoising*",
    "denoiser",
    "device",
    "samples",
    "seed",
    "adaptive_*",
    "use_adaptive*",
    "time_limit",
    "tile_*",
    "use_auto_tile",
    "shading_system",
    "feature_set",
    "use_animated_seed",
    "bake_type",
    "*_bake_*",
    "texture_limit",
    "rolling_shutter_*",
    "motion_blur_position",
)
"""Settings of the viewport, of devices and of sampling, which Gradus has of its own; what has other rows."""

RENDER = ("film_*", "use_simplify", "simplify_*", "use_motion_blur", "motion_blur_*", "use_persistent_data", "hair_*")
"""Properties of the render that change the picture."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    family = Family("Scene settings", "Scene", stage, NOISY)
    yield from family.rows(rna.of_part("cycles", rna.changes(scene.cycles, SKIPPED)))
    others = [name for name in rna.names(scene.render) if not rna.matches(name, RENDER)]
    moving = Family("Scene settings", "Scene with motion blur", stage_moving, NOISY)
    yield moving.row("", move_further)
    yield from family.rows(rna.of_part("render", rna.changes(scene.render, others)))
    yield from moving.rows(rna.of_part("render", rna.changes(scene.render, others)))
    yield from moving.rows(rna.of_part("cycles", motion_changes(scene.cycles)))
    clear = Family("Scene settings", "Scene with transparent glass", stage_of_clear_glass, NOISY)
    scene.cycles.film_transparent_glass = True
    others = [name for name in rna.names(scene.cycles) if name != "film_transparent_glass"]
    yield from clear.rows(rna.of_part("cycles", rna.changes(scene.cycles, others)))


def motion_changes(cycles: Any) -> Iterator[tuple[str, rna.Change]]:
    names = ("rolling_shutter_*", "motion_blur_position")
    others = [name for name in rna.names(cycles) if not rna.matches(name, names)]
    yield from rna.changes(cycles, others)


def stage() -> Any:
    stages.room()
    clear = stages.material("BsdfTransparent", (0.5, 0.7, 0.6))
    for index in range(3):
        stages.mesh("PLANE", clear, "Pane", scale=(0.3,) * 3, location=(0.2, -1.4, 0.4 + 0.05 * index))
    bpy.context.scene.cycles.filter_width = 1.5
    return bpy.context.scene


def stage_moving() -> Any:
    scene = stage()
    for name, way in {"Ball": (0.8, 0.3, 0.2), "Camera": (0.3, 0.0, 0.1)}.items():
        obj = bpy.data.objects[name]
        start = obj.location.copy()
        for frame, share in ((0, 0.0), (2, 1.0)):
            obj.location = [a + share * b for a, b in zip(start, way, strict=True)]
            obj.keyframe_insert("location", frame=frame)
    scene.render.use_motion_blur = True
    scene.frame_set(1)
    return scene


def stage_of_clear_glass() -> Any:
    """Glass in front of the world. The settings act only above a transparent film."""
    scene = stage()
    bpy.data.objects["Floor"].hide_render = True
    scene.render.film_transparent = scene.cycles.film_transparent_glass = True
    return scene


def move_further(_scene: Any) -> None:
    ball = bpy.data.objects["Ball"]
    ball.location.x += 1.0
    ball.keyframe_insert("location", frame=2)
    bpy.context.scene.frame_set(1)
