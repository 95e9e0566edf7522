"""A compositor that combines Blender's light passes to the reconstructed image, rendered in the background."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from gradus import passes
from gradus.abi import Pass
from support import compositing, images

SAMPLE = Path(__file__).resolve().parents[2] / "sample_blends" / "glass_and_chrome.blend"
SCATTERED = ("DIFFUSE", "GLOSSY", "TRANSMISSION")
SWITCHES = ("use_pass_emit", "use_pass_environment") + tuple(
    f"use_pass_{kind.lower()}_{part}" for kind in SCATTERED for part in ("direct", "indirect", "color")
)


def socket(render: bpy.types.Node, name: str) -> bpy.types.NodeSocket:
    info = next(info for info in passes.TABLE if info.plane == Pass[name])
    return render.outputs[info.blender_name(bpy.app.version)]


def mixed(
    tree: bpy.types.NodeTree, kind: str, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Returns the output of a Mix node.

    From 5.0 on it is the shader node, whose colour sockets follow those of other types.
    """
    since_5_0 = bpy.app.version >= (5, 0, 0)
    mix = tree.nodes.new("ShaderNodeMix" if since_5_0 else "CompositorNodeMixRGB")
    if since_5_0:
        mix.data_type = "RGBA"
    mix.blend_type = kind
    mix.inputs[0].default_value = 1.0
    inputs = [s for s in mix.inputs if s.type == "RGBA"]
    tree.links.new(first, inputs[0])
    tree.links.new(second, inputs[1])
    return next(s for s in mix.outputs if s.type == "RGBA")


def summed(tree: bpy.types.NodeTree, render: bpy.types.Node) -> bpy.types.NodeSocket:
    total = mixed(tree, "ADD", socket(render, "EMISSION"), socket(render, "ENVIRONMENT"))
    for kind in SCATTERED:
        light = mixed(tree, "ADD", socket(render, f"{kind}_DIRECT"), socket(render, f"{kind}_INDIRECT"))
        total = mixed(tree, "ADD", total, mixed(tree, "MULTIPLY", light, socket(render, f"{kind}_COLOR")))
    return total


def compose(scene: bpy.types.Scene) -> None:
    """Composes Σ Color · (Direct + Indirect) + Emission + Environment."""
    tree, render, output = compositing.new_tree(scene)
    tree.links.new(summed(tree, render), output)


@pytest.mark.parametrize("reconstruction", ["REGULARIZED", "L2"])
def test_the_sum_of_light_passes_is_the_render(tmp_path: Path, reconstruction: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    scene = bpy.context.scene
    layer = scene.view_layers[0]
    for switch in SWITCHES:
        setattr(layer, switch, True)
    layer.update_render_passes()
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 54, 100
    scene.render.use_compositing = True
    compose(scene)
    done = images.render(scene, tmp_path, samples=8, noise_threshold=0.0, reconstruction=reconstruction)
    combined, noisy = done["ViewLayer.Combined"][..., :3], done["ViewLayer.Noisy Image"][..., :3]
    np.testing.assert_allclose(done["Composite.Combined"][..., :3], combined, rtol=1e-4, atol=1e-4)
    assert np.abs(noisy - combined).mean() > 0.02 * combined.mean()
