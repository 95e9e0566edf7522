"""Stereo against Cycles: the images of both eyes for all convergence modes, planar and panoramic."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images, recording

EXACT = {
    "samples": 1,
    "integrator": "PATH",
    "reconstruction": "NONE",
    "pixel_filter": "GAUSSIAN",
    "filter_width": 0.01,
    "max_bounces": 0,
}
EYES = {"left": "_L", "right": "_R"}


def _prepare(scene: bpy.types.Scene, **camera_settings: object) -> bpy.types.Object:
    """Adds a ball around the camera and one in front of it. Both engines take one sample at the centre of the pixel."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=20.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.8, location=(0.3, 0.2, 0.0))
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising, cycles.max_bounces = 1, False, False, 0
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    for name, value in EXACT.items():
        setattr(scene.gradus, name, value)
    scene.view_layers[0].use_pass_position = True
    scene.render.use_multiview = True
    scene.render.views_format = "STEREO_3D"
    return recording.add_camera(**camera_settings)


def _render(scene: bpy.types.Scene, engine: str, folder: Path) -> dict[str, np.ndarray]:
    """Returns the positions that the eyes see."""
    scene.render.engine = engine
    images.use_exr(scene, folder / f"{engine}.exr")
    scene.render.image_settings.views_format = "INDIVIDUAL"
    bpy.ops.render.render(write_still=True, scene=scene.name)
    return {eye: images.read(folder / f"{engine}{suffix}.exr")["Position"] for eye, suffix in EYES.items()}


def _compare(scene: bpy.types.Scene, folder: Path) -> dict[str, np.ndarray]:
    ours, cycles = _render(scene, "GRADUS", folder), _render(scene, "CYCLES", folder)
    for eye in EYES:
        away = np.linalg.norm(ours[eye] - cycles[eye], axis=2)
        assert np.percentile(away, 95) < 0.02, eye  # all others are edges
    # The eyes differ by more than the tolerance.
    assert np.percentile(np.linalg.norm(ours["left"] - ours["right"], axis=2), 50) > 0.1
    return ours


@pytest.mark.parametrize("mode", ["OFFAXIS", "PARALLEL", "TOE"])
def test_eyes_of_a_flat_picture(scene: bpy.types.Scene, tmp_path: Path, mode: str) -> None:
    stereo = _prepare(scene, lens=30.0, shift_x=0.05).data.stereo
    stereo.convergence_mode, stereo.interocular_distance, stereo.convergence_distance = mode, 0.4, 4.0
    _compare(scene, tmp_path)


@pytest.mark.parametrize("merge", [False, True])
@pytest.mark.parametrize("mode", ["OFFAXIS", "PARALLEL"])
@pytest.mark.parametrize("kind", ["EQUIRECTANGULAR", "MIRRORBALL", "PERSP"])
def test_eyes_on_a_circle(scene: bpy.types.Scene, tmp_path: Path, kind: str, mode: str, merge: bool) -> None:
    camera = _prepare(scene, type="PERSP" if kind == "PERSP" else "PANO", lens=15.0)
    camera.rotation_euler = (1.0, 0.1, 0.3)
    if kind != "PERSP":
        (camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles).panorama_type = kind
    stereo = camera.data.stereo
    stereo.use_spherical_stereo, stereo.use_pole_merge = True, merge
    stereo.convergence_mode, stereo.interocular_distance, stereo.convergence_distance = mode, 0.8, 4.0
    _compare(scene, tmp_path)
