"""The sample file whose compositor grades the reflection, blurs each component by its motion and adds them up."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import compositing, images

SAMPLE = Path(__file__).resolve().parents[2] / "sample_blends" / "components.blend"
COMPOSITE, COMBINED = "Composite.Combined", "ViewLayer.Combined"
NAMES = ("Emission", "Diffuse", "Reflection", "Transmission", "Residual")
BLURS = tuple(f"Blur {name}" for name in NAMES)
WARM = np.array((1.6, 0.9, 0.5), np.float32)


@pytest.fixture(scope="module")
def render(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., images.Passes]:
    """Returns a function that renders the sample with the named nodes muted: render("Grade").

    It returns all passes and the composite.
    """

    @cache
    def passes(*muted: str) -> images.Passes:
        folder = tmp_path_factory.mktemp("composite")
        return compositing.render_muted(SAMPLE, folder, muted, percentage=50, frame=12, samples=4)

    return passes


def rgb(passes: images.Passes, name: str) -> np.ndarray:
    return passes[name][..., :3]


def test_without_grade_and_blur_the_sum_is_the_render(render: Callable[..., images.Passes]) -> None:
    plain = render("Grade", *BLURS)
    np.testing.assert_allclose(rgb(plain, COMPOSITE), rgb(plain, COMBINED), rtol=1e-5, atol=1e-5)


def test_the_grade_changes_the_reflection_alone(render: Callable[..., images.Passes]) -> None:
    graded = render(*BLURS)
    reflection = rgb(graded, "ViewLayer.Path Reflection")
    change = rgb(graded, COMPOSITE) - rgb(graded, COMBINED)
    assert (reflection > 0.05).any(axis=-1).mean() > 0.02
    np.testing.assert_allclose(change, reflection * (WARM - 1.0), atol=2e-5 * max(1.0, float(reflection.max())))
    assert np.abs(change[reflection.max(axis=-1) == 0.0]).max() < 1e-5


def test_reflections_are_blurred_by_their_own_depth() -> None:
    """The Vector Blur node orders objects in a mirror and behind glass by their own depths.

    Regression: they had the depth of the mirror.
    """
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    for name, blur in zip(NAMES, BLURS, strict=True):
        sources = {
            link.from_socket.name for link in compositing.tree_of(bpy.context.scene).links if link.to_node.name == blur
        }
        assert {f"Path {name} Depth", f"Path {name} Motion"} < sources


def show_the_world(scene: bpy.types.Scene) -> None:
    """Makes the world transparent behind the room, and gives the sum the alpha of the render."""
    bpy.data.objects.remove(bpy.data.objects["Back"])
    scene.render.film_transparent = True
    tree = compositing.tree_of(scene)
    alpha = tree.nodes.new("CompositorNodeSetAlpha")
    if hasattr(alpha, "mode"):
        alpha.mode = "REPLACE_ALPHA"
    else:
        alpha.inputs["Type"].default_value = "Replace Alpha"
    ((total, output),) = (
        (link.from_socket, link.to_socket) for link in tree.links if link.from_node.name == "Add Residual"
    )
    (render,) = (node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers")
    tree.links.new(total, alpha.inputs["Image"])
    tree.links.new(render.outputs["Alpha"], alpha.inputs["Alpha"])
    tree.links.new(alpha.outputs["Image"], output)


def test_the_sum_over_a_transparent_film_has_the_alpha_of_the_render(tmp_path: Path) -> None:
    """The compositor tree follows the user guide."""
    settings = {"percentage": 25, "frame": 12, "samples": 4, "change": show_the_world}
    passes = compositing.render_muted(SAMPLE, tmp_path, ("Grade", *BLURS), **settings)
    assert (passes[COMBINED][..., 3].min(), passes[COMBINED][..., 3].max()) == (0.0, 1.0)
    np.testing.assert_allclose(passes[COMPOSITE], passes[COMBINED], rtol=1e-5, atol=1e-5)


def test_the_composite_is_finite(render: Callable[..., images.Passes]) -> None:
    assert all(np.isfinite(image).all() for image in render().values())
