"""The passes `Path NAME Motion` and `Tracked` in Blender, also with motion blur and in the compositor."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from gradus import store
from support import compositing, images

SAMPLES = Path(__file__).resolve().parents[2] / "sample_blends"
NAMES = ("Emission", "Diffuse", "Reflection", "Transmission", "Residual")
WIDTH, HEIGHT = 160, 90
NO_NEIGHBOUR = -12.0


@pytest.fixture
def sample() -> bpy.types.Scene:
    """Returns a static room with a rolling mirror ball, a box that moves behind a slab of glass, and a moving light."""
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / "mirror_and_glass.blend"))
    scene = bpy.context.scene
    images.prepare(scene)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.view_layers[0].use_pass_vector = True
    return scene


def motion(rendered: images.Passes, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Returns the motion of a component, and a mask of the pixels where it is known."""
    return rendered[f"ViewLayer.Path {name} Motion"], rendered[f"ViewLayer.Path {name} Tracked"][..., 0] == 1.0


def lit(rendered: images.Passes, name: str) -> np.ndarray:
    """Returns a mask of the pixels in which the component is most of the image."""
    combined = rendered["ViewLayer.Combined"][..., :3].sum(axis=-1)
    return rendered[f"ViewLayer.Path {name}"].sum(axis=-1) > 0.7 * combined


def test_directly_visible_objects_move_as_their_surface(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    bpy.data.objects.remove(bpy.data.objects["Slab"])
    rendered = render(sample, frame=12)
    vectors, known = motion(rendered, "Diffuse")
    surface = rendered["ViewLayer.Vector"]
    inside = known & lit(rendered, "Diffuse")
    assert inside.sum() > 0.9 * lit(rendered, "Diffuse").sum()
    away = np.abs(vectors - surface)[inside].max(axis=-1)
    assert np.percentile(away, 95) < 0.02  # all others are edges
    assert (np.abs(vectors[inside]).max(axis=-1) > 0.3).sum() > 100, "the box moves"


def test_a_reflection_moves_differently_from_its_mirror(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    rendered = render(sample, frame=12)
    vectors, known = motion(rendered, "Reflection")
    mirror = known & lit(rendered, "Reflection")
    assert mirror.sum() > 0.8 * lit(rendered, "Reflection").sum()
    surface = rendered["ViewLayer.Vector"]
    assert np.median(np.abs(vectors - surface)[mirror].max(axis=-1)) > 0.15
    assert np.median(np.abs(vectors)[mirror].max(axis=-1)) > 0.2


def test_refracted_objects_move_behind_static_glass(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    rendered = render(sample, frame=12)
    vectors, known = motion(rendered, "Transmission")
    glass = known & lit(rendered, "Transmission")
    assert np.abs(rendered["ViewLayer.Vector"][glass]).max() < 1e-3
    assert (np.abs(vectors[glass]).max(axis=-1) > 0.3).sum() > 100


def test_untracked_motion_is_0_with_a_cause(sample: bpy.types.Scene, render: Callable[..., images.Passes]) -> None:
    rendered = render(sample, frame=12)
    causes = set()
    for name in NAMES:
        vectors, known = motion(rendered, name)
        tracked = rendered[f"ViewLayer.Path {name} Tracked"][..., 0]
        assert (tracked[~known] < 0.0).all()
        if name != "Residual":  # a single frame has motion of its surfaces only
            assert not vectors[~known].any()
        assert np.isfinite(vectors).all()
        assert np.abs(vectors).max() <= max(WIDTH, HEIGHT)
        causes |= set(np.unique(tracked[~known]).tolist())
    assert causes > {NO_NEIGHBOUR}
    assert not known.any(), "of Residual, the last"


def test_components_have_motion_under_motion_blur(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    """Components have the same motion with and without motion blur.

    Vector is 0 with a warning, so that no one blurs twice.
    """
    still, known = motion(render(sample, frame=12), "Reflection")
    sample.render.use_motion_blur = True
    store.summaries.clear()
    rendered = render(sample, frame=12)
    blurred, known_too = motion(rendered, "Reflection")
    assert (known == known_too).mean() > 0.99
    assert np.abs(blurred - still)[known & known_too].max() < 0.01
    assert np.abs(blurred).max() > 0.3
    assert not rendered["ViewLayer.Vector"].any()
    (summary,) = store.summaries.values()
    assert [text for text in summary["warnings"] if text.startswith("Pass Vector is 0")]
    assert render(sample, vector_with_motion_blur=True)["ViewLayer.Vector"].any()


# -------------------------------------------------------------------------------- the compositor's sample


def composite(folder: Path, blurred: str) -> images.Passes:
    """Renders the compositor's sample with one component blurred and none graded."""
    muted = ("Grade", *(f"Blur {name}" for name in NAMES if name != blurred))
    return compositing.render_muted(SAMPLES / "components.blend", folder, muted, percentage=50, frame=18, samples=4)


@pytest.mark.parametrize("name", ["Diffuse", "Reflection", "Transmission"])
def test_each_component_is_blurred_where_it_moves(tmp_path: Path, name: str) -> None:
    rendered = composite(tmp_path, name)
    change = np.abs(rendered["Composite.Combined"] - rendered["ViewLayer.Combined"])[..., :3].max(axis=-1)
    speed = np.abs(motion(rendered, name)[0]).max(axis=-1)
    moving, far = speed > 0.3, ~grown(speed > 0.01, 1 + int(np.ceil(speed.max())))
    assert moving.sum() > 50
    assert change[moving].mean() > 1e-3
    assert change[moving].mean() > 3.0 * change[far].mean()


def grown(mask: np.ndarray, by: int) -> np.ndarray:
    """Returns a mask grown by `by` pixels along rows and columns, as far as a blur may reach."""
    for axis in (0, 1):
        mask = np.any([np.roll(mask, shift, axis) for shift in range(-by, by + 1)], axis=0)
    return mask
