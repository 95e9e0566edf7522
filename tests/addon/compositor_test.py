"""The sample whose compositor uses the passes in the nodes Denoise, Vector Blur and Mix, rendered in the background."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import compositing, images

SAMPLE = Path(__file__).resolve().parent.parent.parent / "sample_blends" / "compositor.blend"
COMPOSITE, COMBINED = "Composite.Combined", "ViewLayer.Combined"


@pytest.fixture(scope="module")
def render(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., images.Passes]:
    """Returns a function that renders the sample with the named nodes muted: render("Vector Blur").

    It returns all passes and the composite.
    """

    @cache
    def passes(*muted: str) -> images.Passes:
        folder = tmp_path_factory.mktemp("composite")
        return compositing.render_muted(SAMPLE, folder, muted, percentage=30, frame=12, samples=8, reconstruction="L1")

    return passes


def rim(mask: np.ndarray, axis: int) -> np.ndarray:
    """Returns a mask of the outermost two pixels of a mask along an axis."""
    return mask & ~(np.roll(mask, 2, axis) & np.roll(mask, -2, axis))


def roughness(image: np.ndarray) -> float:
    return float(np.abs(np.diff(image[..., :3], axis=1)).mean())


def test_the_mix_puts_the_background_where_the_mist_is(render: Callable[..., images.Passes]) -> None:
    whole, blurred = render(), render("Mix")[COMPOSITE][..., :3]
    background = np.array((0.25, 0.32, 0.45), np.float32)
    mist = whole["ViewLayer.Mist"]
    assert mist.max() > 0.2
    np.testing.assert_allclose(whole[COMPOSITE][..., :3], blurred + mist * (background - blurred), atol=2e-3)


def test_the_vector_blur_blurs_moving_objects_along_their_motion(render: Callable[..., images.Passes]) -> None:
    """The ball rolls to the right: its left and right rims are blurred, but not its top and bottom, nor the static
    room."""
    changed = np.abs(render()[COMPOSITE] - render("Vector Blur")[COMPOSITE])[..., :3].max(axis=2)
    speed = np.abs(render()["ViewLayer.Vector"][..., :2])
    ball = (speed[..., 0] > 1.0) & (speed[..., 0] > 4.0 * speed[..., 1])
    assert ball.sum() > 500
    left_right, top_bottom = rim(ball, 1), rim(ball, 0)
    assert changed[left_right & ~top_bottom].mean() > 1.5 * changed[top_bottom & ~left_right].mean()
    assert changed[ball].mean() > 5.0 * changed[speed.max(axis=2) < 0.05].mean()


def test_denoise_smooths_the_picture(render: Callable[..., images.Passes]) -> None:
    """Debian's 3.4 has no denoiser, and its node passes the image through."""
    smooth, noisy = render()[COMPOSITE], render("Denoise")[COMPOSITE]
    if bpy.app.version < (4, 0, 0) and np.array_equal(smooth, noisy):
        return
    assert roughness(smooth) < 0.9 * roughness(noisy)


def test_the_composite_is_finite_and_not_the_render(render: Callable[..., images.Passes]) -> None:
    whole = render()
    assert all(np.isfinite(image).all() for image in whole.values())
    assert np.abs(whole[COMPOSITE] - whole[COMBINED]).mean() > 0.01
