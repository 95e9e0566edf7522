"""The pass `Path NAME Irradiance Motion` in an animation of a moving shadow on a static floor."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images, recording
from support.animation import key

WIDTH, HEIGHT = 96, 64
SHIFT = 1.5  # pixels per frame, to the right
LAST = 4
NO_NEIGHBOUR = -12.0


@pytest.fixture
def shadow(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a ball above the camera whose shadow moves through the image."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0).location = (0.0, 0.0, 5.0)
    recording.add(recording.grid(1, 20.0), "Floor")
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, segments=48, ring_count=24)
    across = SHIFT * 4.0 / WIDTH
    key(bpy.context.object, "location", {0: (-2 * across, 0.0, 8.0), 10: (8 * across, 0.0, 8.0)})
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = 3.0, math.radians(3.0)
    recording.add(light, "Sun")
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.frame_start, scene.frame_end = 1, LAST
    scene.gradus.samples, scene.gradus.use_decomposition = 64, True
    layer = scene.view_layers[0].gradus
    layer.use_pass_component_motion = layer.use_pass_component_irradiance_motion = True
    return scene


def animate(scene: bpy.types.Scene, folder: Path) -> list[images.Passes]:
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    return [images.read(folder / f"f_{frame:04d}.exr") for frame in range(scene.frame_start, scene.frame_end + 1)]


def test_a_shadow_has_vectors_where_the_floor_is_static(shadow: bpy.types.Scene, tmp_path: Path) -> None:
    frames = animate(shadow, tmp_path)
    for place, rendered in enumerate(frames):
        vectors, known = rendered["Path Diffuse Irradiance Motion"], rendered["Path Diffuse Irradiance Tracked"][..., 0]
        assert vectors.shape == (HEIGHT, WIDTH, 4)
        assert np.isfinite(vectors).all()
        assert np.abs(rendered["Path Diffuse Motion"]).max() < 1e-3, "the floor does not move"
        if place in (0, LAST - 1):
            assert (known == NO_NEIGHBOUR).any() and not (known == 1.0).any()
            continue
        light = rendered["Path Diffuse"][..., 0]
        slope = np.stack(np.gradient(light)[::-1], axis=-1)
        steepness = np.linalg.norm(slope, axis=-1)
        edge = steepness > 0.03 * light.max()
        edge[:, :8] = edge[:, -8:] = False
        seen = edge & (known == 1.0)
        assert seen.sum() > 0.5 * edge.sum() > 20
        # Motion along an edge is not visible.
        across = slope[seen] / steepness[seen][:, None]
        away = [
            np.abs(((vectors[seen][:, side] + (SHIFT, 0.0)) * across).sum(axis=1))
            for side in (slice(0, 2), slice(2, 4))
        ]
        assert np.median(np.maximum(*away)) < 0.2


def test_a_still_has_the_floor_s_motion_untracked(shadow: bpy.types.Scene, tmp_path: Path) -> None:
    rendered = images.render(shadow, tmp_path, frame=2)
    assert (rendered["Path Diffuse Irradiance Tracked"] == NO_NEIGHBOUR).all()
    assert np.abs(rendered["Path Diffuse Irradiance Motion"]).max() < 1e-3
