"""Scenes made for Cycles: differences of bounces, exposure and filter are reported and can be copied."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from gradus import cycles_settings, native, options, renderer, settings
from support import recording
from support.cycles import picture
from support.nodes import Graph, new_world, shader_material, socket


@pytest.fixture
def cycles(scene: bpy.types.Scene) -> bpy.types.Scene:
    if not hasattr(scene, "cycles"):
        pytest.skip("Cycles is switched off in this host")
    return scene


def native_settings(scene: bpy.types.Scene) -> native.Settings:
    return renderer.native_settings(native.load(), scene, scene.view_layers[0], options.current())


def test_the_defaults_are_those_of_cycles(cycles: bpy.types.Scene) -> None:
    """Filter Glossy and clamps differ, because they add bias."""
    assert cycles_settings.untouched(cycles) == {"blur_glossy": 1.0, "clamp_indirect": 10.0}


def test_settings_that_were_never_set_follow_cycles(cycles: bpy.types.Scene) -> None:
    cycles.cycles.diffuse_bounces, cycles.cycles.glossy_bounces, cycles.cycles.caustics_reflective = 1, 7, False
    cycles.cycles.pixel_filter_type, cycles.cycles.sample_clamp_direct = "GAUSSIAN", 2.0
    cycles.gradus.glossy_bounces = 3
    found = native_settings(cycles)
    assert (found.diffuse_bounces, found.glossy_bounces, found.caustics_reflective) == (1, 3, 0)
    assert found.pixel_filter == settings.BY_NAME["pixel_filter"].value_of("GAUSSIAN")
    assert (found.blur_glossy, found.clamp_direct, found.clamp_indirect) == (1.0, 2.0, 10.0)
    assert cycles_settings.warnings(cycles, set(), is_followed=True) == []


def test_settings_do_not_follow_cycles_where_that_is_off(cycles: bpy.types.Scene) -> None:
    cycles.cycles.diffuse_bounces = 1
    cycles.gradus.use_cycles_settings = False
    found = native_settings(cycles)
    assert (found.diffuse_bounces, found.blur_glossy, found.clamp_indirect) == (4, 0.0, 0.0)


def test_differences_from_cycles_are_reported(cycles: bpy.types.Scene) -> None:
    cycles.cycles.diffuse_bounces, cycles.cycles.film_exposure = 1, 2.5
    [text] = cycles_settings.warnings(cycles, set(), is_followed=False)
    assert "Diffuse (diffuse_bounces) 4 instead of 1" in text and "Exposure (film_exposure) 1 instead of 2.5" in text
    assert (
        "diffuse_bounces" not in cycles_settings.warnings(cycles, {"diffuse_bounces"}, is_followed=False)[0]
    )  # because the command line sets it


def test_settings_that_the_user_has_set_are_not_reported(cycles: bpy.types.Scene) -> None:
    cycles.cycles.glossy_bounces = 7
    cycles.gradus.glossy_bounces, cycles.gradus.blur_glossy, cycles.gradus.clamp_indirect = 3, 0.0, 0.0
    assert cycles_settings.warnings(cycles, set(), is_followed=False) == []


def test_settings_without_a_counterpart_are_named(cycles: bpy.types.Scene) -> None:
    cycles.cycles.use_fast_gi = True
    [text] = cycles_settings.warnings(cycles, set(), is_followed=True)
    assert text.endswith("does not have: Fast GI Approximation")


def test_use_pixel_jitter_is_named(cycles: bpy.types.Scene) -> None:
    if not hasattr(cycles.cycles, "use_pixel_jitter"):
        pytest.skip("it exists since Blender 5.2")
    cycles.cycles.use_pixel_jitter = True
    [text] = cycles_settings.warnings(cycles, set(), is_followed=True)
    assert text.endswith("does not have: Use Pixel Jitter")


def test_a_limit_of_textures_is_named(cycles: bpy.types.Scene) -> None:
    cycles.cycles.texture_limit_render = "128"
    assert cycles_settings.warnings(cycles, set(), is_followed=True) == []
    cycles.render.use_simplify = True
    [text] = cycles_settings.warnings(cycles, set(), is_followed=True)
    assert text.endswith("does not have: Texture Limit")


@pytest.mark.parametrize("sampling", ["AUTOMATIC", "NONE"])
@pytest.mark.parametrize("portal", [False, True])
@pytest.mark.parametrize("varies", [False, True])
def test_a_limit_of_bounces_of_the_world_is_named(
    cycles: bpy.types.Scene, tmp_path: Path, varies: bool, portal: bool, sampling: str
) -> None:
    """It was ignored without a word. A warning names it exactly where it changes the picture of Cycles."""
    recording.add_camera(lens=30.0).location = (0.0, 0.0, 3.0)
    bpy.ops.mesh.primitive_plane_add(size=10.0)
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    cycles.world = new_world((1.0, 1.0, 1.0))
    if varies:
        graph = Graph(cycles.world)
        background = next(node for node in graph.tree.nodes if node.type == "BACKGROUND")
        graph.tree.links.new(graph("TexChecker", "Color"), socket(background.inputs, "Color"))
    if portal:
        bpy.ops.object.light_add(type="AREA", location=(0.0, 0.0, 2.0))
        bpy.context.object.data.cycles.is_portal = True
    cycles.world.cycles.sampling_method = sampling
    unlimited = picture(cycles, tmp_path, "CYCLES")
    cycles.world.cycles.max_bounces = 0
    changes = not np.array_equal(picture(cycles, tmp_path, "CYCLES"), unlimited)
    assert changes == any("World > Max Bounces" in text for text in cycles_settings.warnings(cycles, set(), True))


def test_clamps_of_several_lights_are_named(cycles: bpy.types.Scene) -> None:
    """With one light there is nothing to choose. Lights that are hidden were counted, and none with a light tree."""
    lights = [bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT")) for _ in range(2)]
    for light in lights:
        cycles.collection.objects.link(light)
    assert clamp_warnings(cycles, 0.0) == []
    [text] = clamp_warnings(cycles)
    assert text.startswith("Clamp Direct is 1")
    lights[0].hide_viewport = lights[0].hide_render = True
    assert clamp_warnings(cycles) == []


def test_a_world_is_a_light_that_clamps_cut_without_a_light_tree(cycles: bpy.types.Scene) -> None:
    cycles.collection.objects.link(bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT")))
    world = new_world((1.0, 1.0, 1.0))
    assert bool(clamp_warnings(cycles, world=world)) != hasattr(cycles.cycles, "use_light_tree")
    use_no_light_tree(cycles)
    assert len(clamp_warnings(cycles, world=world)) == 1


@pytest.mark.parametrize(
    ("kind", "size", "limit", "count"),
    [
        ("AREA", 1.0, 8, 0),
        ("AREA", 1.0, 2, 1),
        ("AREA", 1.0, 1, 1),
        ("POINT", 0.0, 1, 0),
        ("SPOT", 0.1, 2, 1),
        ("SUN", 0.1, 1, 0),
    ],
)
def test_lights_that_count_as_transparent_surfaces_are_named(
    kind: str, size: float, limit: int, count: int, cycles: bpy.types.Scene
) -> None:
    """Cycles ends paths at lights that they cross, if the limit of transparent surfaces is reached there."""
    light = bpy.data.lights.new("Light", kind)
    if kind in {"POINT", "SPOT"}:
        light.shadow_soft_size = size
    cycles.collection.objects.link(bpy.data.objects.new("Light", light))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert len(cycles_settings.transparency_warnings(depsgraph, limit)) == count


def use_no_light_tree(scene: bpy.types.Scene) -> None:
    if hasattr(scene.cycles, "use_light_tree"):
        scene.cycles.use_light_tree = False


def clamp_warnings(scene: bpy.types.Scene, clamp: float = 1.0, world: bpy.types.World | None = None) -> list[str]:
    """Returns the warnings about the scene with a world, or without one."""
    scene.world = world
    return cycles_settings.clamp_warnings(bpy.context.evaluated_depsgraph_get(), clamp)


@pytest.mark.parametrize(("strength", "count"), [(0.0, 0), (2.0, 1)])
def test_surfaces_that_emit_are_lights_that_clamps_cut(cycles: bpy.types.Scene, strength: float, count: int) -> None:
    """They were not counted. Cycles chooses among their triangles, with a light tree, too."""
    cycles.collection.objects.link(bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT")))
    bpy.ops.mesh.primitive_plane_add()
    bpy.context.object.data.materials.append(shader_material("Emission", {"Strength": strength}))
    assert len(clamp_warnings(cycles)) == count


def test_copy_from_cycles(cycles: bpy.types.Scene) -> None:
    cycles.cycles.max_bounces, cycles.cycles.transparent_max_bounces = 5, 64
    cycles.cycles.pixel_filter_type, cycles.cycles.filter_width = "GAUSSIAN", 2.0
    cycles.cycles.caustics_refractive = False
    with bpy.context.temp_override(scene=cycles):
        bpy.ops.gradus.copy_from_cycles()
    ours = cycles.gradus
    assert (ours.max_bounces, ours.transparent_max_bounces, ours.pixel_filter, ours.filter_width) == (
        5,
        64,
        "GAUSSIAN",
        2.0,
    )
    assert (ours.blur_glossy, ours.caustics_refractive) == (1.0, False)
    assert cycles_settings.warnings(cycles, set(), is_followed=False) == []
