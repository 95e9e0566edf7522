"""The denoiser of the host. The bpy modules have Open Image Denoise, Debian's Blender 3.4 has none."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import compat, native
from gradus.setting_table import DENOISER_MINIMUM_SAMPLES
from support import images

Render = Callable[..., images.Passes]


@pytest.fixture
def corner(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a cube on a floor, noisy penumbrae of a large light, and a transparent background."""
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(0.0, 0.0, 0.75))
    bpy.ops.mesh.primitive_plane_add(size=5.0)
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "AREA"))
    light.data.energy, light.data.size, light.location = 300.0, 3.0, (0.0, 0.0, 4.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (5.0, -5.0, 4.0), (1.05, 0.0, 0.785)
    for item in (light, camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.render.film_transparent = True
    scene.gradus.integrator, scene.gradus.noise_threshold = "PATH", 0.0
    return scene


def error(image: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(np.mean((image[..., :3] - truth[..., :3]) ** 2)))


@pytest.mark.module
@pytest.mark.parametrize(("integrator", "left"), [("PATH", 0.7), ("GRADIENT", 0.95)])
def test_noise_falls_and_the_rest_stays(corner: bpy.types.Scene, render: Render, integrator: str, left: float) -> None:
    truth = render(corner, samples=512)["Combined"]
    plain = render(corner, samples=4, integrator=integrator)["Combined"]
    passes = render(corner, samples=4, integrator=integrator, denoiser="OIDN")
    assert error(passes["Combined"], truth) < left * error(plain, truth)
    assert np.array_equal(passes["Combined"][..., 3], plain[..., 3])
    assert np.isfinite(passes["Combined"]).all()
    if integrator == "PATH":
        assert np.array_equal(passes["Noisy Image"], plain)


@pytest.mark.module
def test_error_is_that_of_the_denoised_picture(corner: bpy.types.Scene, render: Render) -> None:
    """The mean over all pixels is compared, because single pixels at edges have too small estimates."""
    truth = render(corner, samples=2048)["Combined"][..., :3]
    corner.view_layers[0].gradus.use_pass_error = True
    passes = render(corner, samples=16, reconstruction="REGULARIZED", denoiser="OIDN")
    estimated, actual = passes["Error"][..., 0], np.mean((passes["Combined"][..., :3] - truth) ** 2, axis=2)
    assert 0.25 < estimated.mean() / actual.mean() < 2.0
    assert 0.5 < np.median(estimated) / np.median(actual) < 2.0


@pytest.mark.module
def test_stats_name_it(
    corner: bpy.types.Scene, render: Render, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "stats.jsonl"
    monkeypatch.setattr("sys.argv", ["blender", "--", "--gradus-stats", str(path), "--gradus-denoiser", "auto"])
    render(corner, samples=8, reconstruction="REGULARIZED")
    stats = json.loads(path.read_text())
    assert stats["denoiser"].startswith("Open Image Denoise 2.")
    assert stats["seconds"]["denoise"] > 0.0
    assert stats["cpu_seconds"]["denoise"] > 0.0
    assert not stats["unbiased"]
    assert stats["warnings"] == []


@pytest.mark.module
@pytest.mark.parametrize("samples", [DENOISER_MINIMUM_SAMPLES - 1, DENOISER_MINIMUM_SAMPLES])
def test_auto_denoises_from_the_sample_count_of_the_panel(
    corner: bpy.types.Scene, render: Render, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, samples: int
) -> None:
    path = tmp_path / "stats.jsonl"
    monkeypatch.setattr("sys.argv", ["blender", "--", "--gradus-stats", str(path)])
    render(corner, samples=samples, reconstruction="REGULARIZED")
    assert (json.loads(path.read_text())["denoiser"] is not None) == (samples >= DENOISER_MINIMUM_SAMPLES)


@pytest.mark.module
def test_denoised_frames_are_the_same_again(corner: bpy.types.Scene, render: Render) -> None:
    one, other = (render(corner, samples=2, denoiser="OIDN")["Combined"] for _ in range(2))
    assert np.array_equal(one, other)


@pytest.mark.application
def test_a_missing_denoiser_is_refused_by_name(corner: bpy.types.Scene, render: Render) -> None:
    with pytest.raises(
        RuntimeError, match="denoiser oidn: no Open Image Denoise in this process.*use denoiser auto or none"
    ):
        render(corner, samples=1, denoiser="OIDN")


@pytest.mark.application
def test_auto_renders_without_a_missing_denoiser(corner: bpy.types.Scene, render: Render) -> None:
    plain = render(corner, samples=8, reconstruction="REGULARIZED", denoiser="NONE")["Combined"]
    assert np.array_equal(render(corner, samples=8, reconstruction="REGULARIZED", denoiser="AUTO")["Combined"], plain)


def test_previews_are_not_denoised(corner: bpy.types.Scene) -> None:
    from gradus import options, renderer

    corner.gradus.denoiser = "OIDN"
    filled: Any = renderer.native_settings(native.load(), corner, corner.view_layers[0], options.Overrides())
    assert filled.denoiser == native.Denoiser.OIDN
    renderer.limit_preview(filled, 8)
    assert filled.denoiser == native.Denoiser.NONE


def test_bundled_libraries_contain_the_denoiser_of_blender() -> None:
    folder = compat.bundled_libraries()
    assert (folder != "") == getattr(bpy.app, "module", False)
    if folder:
        assert (Path(folder) / "libOpenImageDenoise.so.2").exists()
