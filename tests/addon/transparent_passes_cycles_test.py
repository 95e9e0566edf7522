"""Passes of partly transparent surfaces agree with Cycles in the same Blender."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import cycles, images
from support.nodes import Graph, new_material, show

# Names of each pass: until Blender 4.5 and since 5.0, and of the property that adds it.
PASSES = {
    ("Mist", "Mist"): "use_pass_mist",
    ("AO", "Ambient Occlusion"): "use_pass_ambient_occlusion",
    ("DiffCol", "Diffuse Color"): "use_pass_diffuse_color",
}


def add_plane(location: tuple[float, float, float], size: float, opacity: float) -> None:
    """Adds an upright plane that is diffuse, and lets a part of the light pass in another colour."""
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=(np.pi / 2, 0.0, 0.0))
    material = new_material()
    graph = Graph(material)
    clear = graph("BsdfTransparent", "BSDF", {"Color": (0.9, 0.7, 0.4, 1.0)})
    matte = graph("BsdfDiffuse", "BSDF", {"Color": (0.3, 0.5, 0.8, 1.0)})
    show(material, graph("MixShader", "Shader", {"Fac": opacity, "Shader": clear, "Shader_001": matte}))
    bpy.context.object.data.materials.append(material)


@pytest.fixture
def sheets() -> bpy.types.Scene:
    """Returns a scene with two sheets, one before the other, above an opaque floor and in front of the sky."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    add_plane((-1.0, 0.0, 0.0), 4.0, 0.4)
    add_plane((1.0, 2.0, 0.5), 4.0, 0.8)
    bpy.ops.mesh.primitive_plane_add(size=20.0, location=(0.0, 0.0, -2.0))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -9.0, 0.0), (np.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.light_settings.distance = 3.0
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 5.0, 12.0
    for name in PASSES.values():
        setattr(bpy.context.view_layer, name, True)
    return scene


def picture_of(scene: bpy.types.Scene, folder: Path, engine: str, names: tuple[str, str]) -> np.ndarray:
    """Renders a pass and returns means of blocks of 4×4 pixels."""
    passes = cycles.passes(scene, folder, engine, 64)
    return cycles.blocks(next(passes[name] for name in names if name in passes)[..., :3])


@pytest.mark.parametrize("names", PASSES)
def test_passes_of_sheets_are_those_of_cycles(sheets: bpy.types.Scene, tmp_path: Path, names: tuple[str, str]) -> None:
    """Mist was negative and ambient occlusion above 1: the chance to pass a sheet was counted, its opacity was not."""
    expected, found = (picture_of(sheets, tmp_path, engine, names) for engine in ("CYCLES", "GRADUS"))
    assert expected.max() > expected.min() + 0.2
    np.testing.assert_allclose(found, expected, atol=0.03)
    np.testing.assert_allclose(found.mean(), expected.mean(), rtol=0.01)
