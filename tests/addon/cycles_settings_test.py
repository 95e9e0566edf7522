"""Scenes made for Cycles: differences of bounces, exposure and filter are reported and can be copied."""

from __future__ import annotations

import bpy
import pytest
from gradus import cycles_settings


@pytest.fixture
def cycles(scene: bpy.types.Scene) -> bpy.types.Scene:
    if not hasattr(scene, "cycles"):
        pytest.skip("Cycles is switched off in this host")
    return scene


def test_the_defaults_are_those_of_cycles(cycles: bpy.types.Scene) -> None:
    assert cycles_settings.warnings(cycles, set()) == []


def test_differences_from_cycles_are_reported(cycles: bpy.types.Scene) -> None:
    cycles.cycles.diffuse_bounces, cycles.cycles.film_exposure = 1, 2.5
    [text] = cycles_settings.warnings(cycles, set())
    assert "Diffuse (diffuse_bounces) 4 instead of 1" in text and "Exposure (film_exposure) 1 instead of 2.5" in text
    assert (
        "diffuse_bounces" not in cycles_settings.warnings(cycles, {"diffuse_bounces"})[0]
    )  # because the command line sets it


def test_settings_that_the_user_has_set_are_not_reported(cycles: bpy.types.Scene) -> None:
    cycles.cycles.glossy_bounces = 7
    cycles.gradus.glossy_bounces = 3
    assert cycles_settings.warnings(cycles, set()) == []


def test_settings_without_a_counterpart_are_named(cycles: bpy.types.Scene) -> None:
    cycles.cycles.caustics_reflective, cycles.cycles.use_fast_gi = False, True
    [text] = cycles_settings.warnings(cycles, set())
    assert text.endswith("does not have: Reflective Caustics off, Fast GI Approximation")


def test_copy_from_cycles(cycles: bpy.types.Scene) -> None:
    cycles.cycles.max_bounces, cycles.cycles.transparent_max_bounces = 5, 64
    cycles.cycles.pixel_filter_type, cycles.cycles.filter_width = "GAUSSIAN", 2.0
    with bpy.context.temp_override(scene=cycles):
        bpy.ops.gradus.copy_from_cycles()
    ours = cycles.gradus
    assert (ours.max_bounces, ours.transparent_max_bounces, ours.pixel_filter, ours.filter_width) == (
        5,
        64,
        "GAUSSIAN",
        2.0,
    )
    assert cycles_settings.warnings(cycles, set()) == []
