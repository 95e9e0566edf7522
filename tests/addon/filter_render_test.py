"""The pixel filter: the edge of a bright plane equals that of Cycles in the same Blender."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images
from support.nodes import new_material, show, socket


@pytest.fixture(scope="module")
def edge() -> bpy.types.Scene:
    """Returns a scene whose emissive plane covers the left half of an orthographic view.

    Its edge is at the centre of a column of pixels.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    scene.render.resolution_x, scene.render.resolution_y = 16, 8
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeEmission")
    socket(node.inputs, "Strength").default_value = 1.0
    show(material, node.outputs[0])
    bpy.ops.mesh.primitive_plane_add(size=40.0, location=(-20.0, 0.0, 0.0))
    bpy.context.object.data.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 16.0, (-0.5, 0.0, 5.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


@pytest.mark.parametrize(
    "kind, width", [("BOX", 3.0), ("GAUSSIAN", 1.5), ("BLACKMAN_HARRIS", 1.5), ("BLACKMAN_HARRIS", 3.0)]
)
def test_a9_filter_is_as_wide_as_in_cycles(kind: str, width: float, edge: bpy.types.Scene, tmp_path: Path) -> None:
    cycles = edge.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 128, False, False
    cycles.pixel_filter_type, cycles.filter_width = kind, width
    settings = {
        "samples": 128,
        "integrator": "PATH",
        "reconstruction": "NONE",
        "pixel_filter": kind,
        "filter_width": width,
    }
    profiles = []
    for engine in ("CYCLES", "GRADUS"):
        edge.render.engine = engine
        profiles.append(images.render(edge, tmp_path, **settings)["Combined"][..., 0].mean(axis=0))
    assert profiles[1][0] == pytest.approx(1.0, abs=1e-3)
    assert profiles[1][-1] == pytest.approx(0.0, abs=1e-3)
    assert np.abs(profiles[0] - profiles[1]).max() < 0.01
