"""Rendered cameras: the point in a pixel projects to that pixel for all settings; depth and clipping."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Vector
from support import recording

EXACT = {
    "samples": 1,
    "integrator": "PATH",
    "reconstruction": "NONE",
    "pixel_filter": "GAUSSIAN",
    "filter_width": 0.01,
    "max_bounces": 0,
}


def _check(scene: bpy.types.Scene, render: Callable[..., Any]) -> None:
    """Requires that pass Position projects to the centre of its pixel, within 0.01 px and half the filter."""
    camera = scene.camera
    scene.view_layers[0].use_pass_position = True
    position = render(scene, **EXACT)["Position"]
    height, width, _ = position.shape
    settings = scene.render
    matrix = camera.calc_matrix_camera(
        bpy.context.evaluated_depsgraph_get(),
        x=width,
        y=height,
        scale_x=settings.pixel_aspect_x,
        scale_y=settings.pixel_aspect_y,
    )
    view = matrix @ camera.matrix_world.normalized().inverted()
    for y in range(0, height, 5):
        for x in range(0, width, 7):
            clip = view @ Vector((*position[y, x], 1.0))
            found = ((clip[0] / clip[3] * 0.5 + 0.5) * width, (clip[1] / clip[3] * 0.5 + 0.5) * height)
            assert found == pytest.approx((x + 0.5, y + 0.5), abs=0.016), (x, y)


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize(
    "fit, size, aspect",
    [
        ("AUTO", (40, 24), (1, 1)),
        ("AUTO", (24, 40), (1, 2)),
        ("VERTICAL", (40, 24), (2, 1)),
        ("HORIZONTAL", (24, 40), (1, 1)),
    ],
)
def test_projection(
    scene: bpy.types.Scene,
    render: Callable[..., Any],
    kind: str,
    fit: str,
    size: tuple[int, int],
    aspect: tuple[int, int],
) -> None:
    camera = recording.add_camera(
        type=kind,
        sensor_fit=fit,
        lens=30.0,
        ortho_scale=3.0,
        shift_x=0.2,
        shift_y=-0.1,
        sensor_width=36.0,
        sensor_height=20.0,
    )
    camera.rotation_euler = (0.1, -0.15, 0.4)
    recording.add(recording.grid(1, 200.0))
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect
    if hasattr(scene.render.image_settings, "use_exr_interleave"):
        scene.render.image_settings.use_exr_interleave = (
            True  # 5.0 cannot write multipart files of images without square pixels
        )
    _check(scene, render)


def test_border_shows_the_same_points(scene: bpy.types.Scene, render: Callable[..., Any]) -> None:
    recording.add_camera().rotation_euler = (0.2, 0.1, 0.0)
    recording.add(recording.grid(1, 200.0))
    scene.view_layers[0].use_pass_position = True
    whole = render(scene, **EXACT)["Position"]
    settings = scene.render
    settings.use_border = settings.use_crop_to_border = True
    settings.border_min_x, settings.border_max_x, settings.border_min_y, settings.border_max_y = 0.25, 0.75, 0.25, 0.5
    part = render(scene, **EXACT)["Position"]
    height, width, _ = whole.shape
    assert np.array_equal(part, whole[height // 4 : height // 2, width // 4 : width * 3 // 4])


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_depth_is_planar(scene: bpy.types.Scene, render: Callable[..., Any], kind: str) -> None:
    """A plane perpendicular to the view axis has a constant depth."""
    recording.add_camera(type=kind, lens=15.0, ortho_scale=8.0)
    recording.add(recording.grid(1, 200.0))
    scene.view_layers[0].use_pass_z = True
    assert np.allclose(render(scene, **EXACT)["Depth"], 5.0, rtol=1e-5)


def test_clipping(scene: bpy.types.Scene, render: Callable[..., Any]) -> None:
    """Surfaces nearer than clip_start and farther than clip_end are invisible."""
    camera = recording.add_camera()
    recording.add(recording.grid(1, 200.0))
    scene.view_layers[0].use_pass_z = True
    camera.data.clip_end = 4.9
    assert np.all(render(scene, **EXACT)["Depth"] > 1e9)
    camera.data.clip_start, camera.data.clip_end = 5.1, 100.0
    assert np.all(render(scene, **EXACT)["Depth"] > 1e9)
