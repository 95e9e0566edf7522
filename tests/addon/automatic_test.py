"""What the add-on takes AUTO for before a render (automatic.py) is what the library's plan says."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable
from pathlib import Path

import bpy
import pytest
from gradus import setting_table, settings
from gradus.automatic import method_of

INTEGRATORS, RECONSTRUCTIONS, DENOISERS = (
    [choice[0] for choice in settings.BY_NAME[name].choices] for name in ("integrator", "reconstruction", "denoiser")
)


@pytest.mark.parametrize(
    ("integrator", "reconstruction", "denoiser", "expected"),
    [
        ("AUTO", "AUTO", "NONE", True),
        ("GRADIENT", "L1", "NONE", True),
        ("GRADIENT", "NONE", "NONE", False),
        ("PATH", "AUTO", "NONE", False),
        ("PATH", "NONE", "NONE", False),
        ("PATH", "NONE", "OIDN", True),
        ("PATH", "REGULARIZED", "NONE", True),
        ("PATH", "NONE", "AUTO", False),
    ],
)
def test_noisy_image_exists_whenever_combined_is_reconstructed(
    integrator: str, reconstruction: str, denoiser: str, expected: bool
) -> None:
    assert method_of(integrator, reconstruction, denoiser).is_reconstructed == expected


@pytest.mark.parametrize(("integrator", "reconstruction"), itertools.product(INTEGRATORS, RECONSTRUCTIONS))
def test_the_plan_has_the_same_reconstruction(
    scene: bpy.types.Scene,
    render: Callable[..., dict],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    integrator: str,
    reconstruction: str,
) -> None:
    method = method_of(integrator, reconstruction, "NONE")
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    stats = tmp_path / "stats.jsonl"
    monkeypatch.setattr("sys.argv", ["blender", "--", "--gradus-stats", str(stats)])
    if method.is_refused:
        with pytest.raises(RuntimeError, match="needs gradients"):
            render(scene, samples=1, integrator=integrator, reconstruction=reconstruction)
        return
    made = render(scene, samples=1, integrator=integrator, reconstruction=reconstruction)
    chosen = json.loads(stats.read_text())["plan"]["chosen"]
    names = [name.removeprefix("reconstruction ") for name in chosen if name.startswith("reconstruction ")]
    assert names == ([method.reconstruction.lower()] if method.reconstruction != "NONE" else [])
    assert ("Noisy Image" in made) == method.is_reconstructed


def test_every_choice_of_the_denoiser_is_known() -> None:
    """denoise_render_test.py compares the number of samples of AUTO with renders."""
    found = {denoiser: method_of("AUTO", "REGULARIZED", denoiser).denoised_from for denoiser in DENOISERS}
    assert found == {"NONE": math.inf, "AUTO": setting_table.DENOISER_MINIMUM_SAMPLES, "OIDN": 0}
    others = [reconstruction for reconstruction in RECONSTRUCTIONS if reconstruction not in ("AUTO", "REGULARIZED")]
    assert {method_of("GRADIENT", reconstruction, "AUTO").denoised_from for reconstruction in others} == {math.inf}
