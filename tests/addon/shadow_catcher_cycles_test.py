"""Shadow catchers show what Cycles shows in the same Blender: colour and alpha, with and without a background."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images
from support.nodes import shader_material


def material(kind: str, **inputs: Any) -> bpy.types.Material:
    return shader_material(kind, {"Color": (0.6, 0.6, 0.6, 1.0)} | inputs)


@pytest.fixture
def stage() -> bpy.types.Scene:
    """Returns a scene with a red sphere and a cube on a floor that catches shadows, in a blueish world."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    for name, add, settings, color in (
        ("Ball", bpy.ops.mesh.primitive_uv_sphere_add, {"location": (-1.3, 0, 0)}, (0.8, 0.2, 0.2, 1.0)),
        ("Cube", bpy.ops.mesh.primitive_cube_add, {"size": 1.4, "location": (1.2, 0.2, -0.3)}, (0.6, 0.6, 0.6, 1.0)),
        ("Floor", bpy.ops.mesh.primitive_plane_add, {"size": 7.0, "location": (0, 0, -1.0)}, (0.5, 0.7, 0.5, 1.0)),
    ):
        add(**settings)
        bpy.context.object.name = name
        bpy.context.object.data.materials.append(material("BsdfDiffuse", Color=color))
    bpy.data.objects["Floor"].is_shadow_catcher = True
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.3, -6.5, 2.5), (1.25, 0.0, 0.05)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 3.0, 0.1, (0.5, 0.7, 0.0)
    for item in (camera, sun):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.2, 0.3, 0.5)
    return scene


def emissive(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Ball"].active_material = material("Emission", Strength=3.0)


def two_catchers(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Cube"].is_shadow_catcher = True


def glossy_catcher(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Floor"].active_material = material("BsdfAnisotropic", Roughness=0.3)


def unlit_by_a_light(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Sun"].is_shadow_catcher = False


def seen_in_gloss(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Cube"].active_material = material("BsdfAnisotropic", Roughness=0.4)


def holdouts(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Cube"].is_holdout = True


def held_out_catcher(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Floor"].is_holdout = True


def instanced(scene: bpy.types.Scene) -> None:
    """Replaces the floor by an instance of a collection whose instancer is the catcher."""
    floor, hidden = bpy.data.objects["Floor"], bpy.data.collections.new("Hidden")
    floor.is_shadow_catcher = False
    scene.collection.objects.unlink(floor)
    hidden.objects.link(floor)
    instancer = bpy.data.objects.new("Instancer", None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", hidden
    instancer.is_shadow_catcher = True
    scene.collection.objects.link(instancer)


CASES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "plain": lambda scene: None,
    "emissive object": emissive,
    "two catchers": two_catchers,
    "glossy catcher": glossy_catcher,
    "light that does not light catchers": unlit_by_a_light,
    "seen in gloss": seen_in_gloss,
    "holdouts": holdouts,
    "catcher that is a holdout": held_out_catcher,
    "instancer": instanced,
}


def picture(scene: bpy.types.Scene, folder: Path, engine: str, name: str = "Combined", **settings: Any) -> np.ndarray:
    """Renders a pass and returns means of blocks of 4×4 pixels."""
    samples = 256
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.sample_clamp_indirect, cycles.blur_glossy, cycles.max_bounces = 0.0, 0.0, 3
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    settings = {"integrator": "PATH", "reconstruction": "NONE"} | settings
    settings |= {"samples": samples, "pixel_filter": "BOX", "filter_width": 1.0, "max_bounces": 3}
    image = images.render(scene, folder, **settings)[name]
    return image.reshape(9, 4, 16, 4, image.shape[2]).mean(axis=(1, 3))


def compare(expected: np.ndarray, found: np.ndarray) -> None:
    scale = np.maximum(expected.mean(axis=(0, 1)), 0.05)
    error = np.abs(found.mean(axis=(0, 1)) - expected.mean(axis=(0, 1))) / scale
    difference = np.abs(expected - found) / scale
    print(f"  mean off by {error.round(4)}, blocks by {difference.mean():.4f}, at most {difference.max():.3f}")
    assert error.max() < 0.01
    assert difference.mean() < 0.03


@pytest.mark.parametrize("transparent", [True, False], ids=["transparent", "background"])
@pytest.mark.parametrize("name", CASES)
def test_shadow_catcher(name: str, transparent: bool, stage: bpy.types.Scene, tmp_path: Path) -> None:
    stage.render.film_transparent = transparent
    CASES[name](stage)
    compare(*(picture(stage, tmp_path, engine) for engine in ("CYCLES", "GRADUS")))


@pytest.mark.parametrize("transparent", [True, False], ids=["transparent", "background"])
@pytest.mark.parametrize("name", ["Shadow Catcher", "Combined"])
def test_pass(name: str, transparent: bool, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """With the pass, Combined leaves shadows out."""
    layer = stage.view_layers[0]
    if not hasattr(layer, "cycles"):
        pytest.skip("Cycles' add-on is off")
    layer.cycles.use_pass_shadow_catcher = True
    stage.render.film_transparent = transparent
    compare(*(picture(stage, tmp_path, engine, name) for engine in ("CYCLES", "GRADUS")))


@pytest.mark.parametrize("transparent", [True, False], ids=["transparent", "background"])
def test_gradients_give_the_same_picture(transparent: bool, stage: bpy.types.Scene, tmp_path: Path) -> None:
    stage.render.film_transparent = transparent
    expected = picture(stage, tmp_path, "GRADUS")
    compare(expected, picture(stage, tmp_path, "GRADUS", integrator="GRADIENT", reconstruction="L2"))
