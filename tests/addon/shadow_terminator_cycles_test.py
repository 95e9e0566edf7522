"""The shading offset of the shadow terminator darkens surfaces as in Cycles in the same Blender."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus.export import shadow_terminator
from support import images
from support.nodes import Graph, new_material, show


def material(kind: str, **inputs: Any) -> bpy.types.Material:
    found = new_material(kind)
    show(found, Graph(found)(kind, "BSSRDF" if kind == "SubsurfaceScattering" else "BSDF", inputs))
    return found


MATERIALS: dict[str, dict[str, Any]] = {
    "BsdfDiffuse": {},
    "BsdfAnisotropic": {"Roughness": 0.5},
    "BsdfPrincipled": {"Roughness": 0.4},
    "BsdfTranslucent": {},
    "SubsurfaceScattering": {"Scale": 0.1},
}


@pytest.mark.parametrize("kind", MATERIALS)
def test_shading_offset(kind: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    images.prepare(scene)
    for x, offset in ((-1.2, 0.0), (1.2, 0.6)):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6, location=(x, 0.0, 0.0))
        bpy.ops.object.shade_smooth()
        ball = bpy.context.object
        ball.data.materials.append(material(kind, **MATERIALS[kind]))
        owner = shadow_terminator.owner(ball)
        setattr(owner, shadow_terminator.shading_offset_name(owner), offset)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0.3, 1.2, 0.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -7.0, 1.5), (1.37, 0.0, 0.0)
    for item in (camera, sun):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.05, 0.05, 0.05)
    expected, found = (picture(scene, tmp_path, engine) for engine in ("CYCLES", "GRADUS"))
    if kind != "BsdfTranslucent":
        assert expected[:, 8:].mean() < 0.97 * expected[:, :8].mean(), "the offset darkens the ball on the right"
    for half in (np.s_[:, :8], np.s_[:, 8:]):
        scale = expected[half].mean()
        error = abs(found[half].mean() / scale - 1.0)
        difference = np.abs(expected[half] - found[half]).mean() / scale
        print(f"  mean off by {error:.4f}, blocks by {difference:.4f}")
        assert error < 0.01
        assert difference < 0.05


def picture(scene: bpy.types.Scene, folder: Path, engine: str) -> np.ndarray:
    """Renders an image and returns means of blocks of 4×4 pixels."""
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 128, False, False
    cycles.sample_clamp_indirect, cycles.blur_glossy, cycles.max_bounces = 0.0, 0.0, 2
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    settings = {"samples": 128, "integrator": "PATH", "reconstruction": "NONE", "max_bounces": 2}
    image = images.render(scene, folder, **settings, pixel_filter="BOX", filter_width=1.0)["Combined"][..., :3]
    return image.reshape(9, 4, 16, 4, 3).mean(axis=(1, 3))
