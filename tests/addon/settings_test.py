"""Settings: Blender's properties have the limits of the table, and their values reach the library."""

from __future__ import annotations

import ctypes
from ctypes import byref

import bpy
import pytest
from gradus import native, options, passes, renderer, settings
from gradus.failure import Failure


def test_properties_have_the_limits_of_the_table() -> None:
    described = bpy.context.scene.gradus.bl_rna.properties
    for setting in settings.SETTINGS:
        entry = described[setting.name]
        assert entry.description == setting.doc
        if setting.kind in (settings.INT, settings.FLOAT):
            assert entry.hard_min == pytest.approx(setting.minimum)
            assert entry.hard_max == pytest.approx(setting.maximum)


def test_seconds_are_shown_as_such() -> None:
    """Regression: Time Limit had no unit."""
    assert bpy.context.scene.gradus.bl_rna.properties["time_limit"].unit == "TIME_ABSOLUTE"


def test_values_reach_the_library_and_options_win(scene: bpy.types.Scene) -> None:
    scene.gradus.samples, scene.gradus.reconstruction, scene.gradus.filter_width = 5, "L1", 2.0
    scene.view_layers[0].pass_alpha_threshold = 0.25
    overrides = options.parse(["--gradus-samples", "9", "--gradus-integrator", "gradient"])
    filled = renderer.native_settings(native.load(), scene, scene.view_layers[0], overrides)
    assert (filled.samples, filled.reconstruction, filled.integrator) == (
        9,
        native.Reconstruction.L1,
        native.Integrator.GRADIENT,
    )
    assert (filled.filter_width, filled.alpha_threshold) == (2.0, 0.25)
    assert scene.gradus.samples == 5


@pytest.mark.parametrize("value", [99, 3], ids=["never used", "of the removed WEIGHTED"])
def test_a_stored_value_of_another_version_names_its_setting(scene: bpy.types.Scene, value: int) -> None:
    """Regression: a traceback ended with KeyError: ''."""
    if "gradus" not in scene:
        scene["gradus"] = {}
    scene["gradus"]["reconstruction"] = value
    if scene.gradus.reconstruction:
        pytest.skip("this Blender keeps the values of properties apart from what scripts store")
    with pytest.raises(Failure, match="Reconstruction .reconstruction. has an unknown value"):
        renderer.native_settings(native.load(), scene, scene.view_layers[0], options.Overrides())


def test_samples_of_the_view_layer_win_over_the_scene(scene: bpy.types.Scene) -> None:
    scene.view_layers[0].samples = 3
    assert renderer.native_settings(native.load(), scene, scene.view_layers[0], options.Overrides()).samples == 3


def test_e8_zero_samples_is_an_error_text(scene: bpy.types.Scene) -> None:
    with pytest.raises(native.GradusError, match="samples"):
        renderer.native_settings(native.load(), scene, scene.view_layers[0], options.parse(["--gradus-samples", "0"]))


def test_defaults_of_the_library_are_ours() -> None:
    ours, theirs = native.Settings(), native.Settings()
    library = native.load()
    library.settings_default(byref(theirs))
    library.settings_default(byref(ours))
    fresh = bpy.data.scenes.new("fresh").gradus
    settings.fill(ours, lambda name: (fresh, name))
    for name, _ in native.Settings._fields_:
        first, second = getattr(ours, name), getattr(theirs, name)
        if isinstance(first, ctypes.Array):
            first, second = list(first), list(second)
        assert first == second, name


def test_region_rounds_as_blender_does() -> None:
    class Border:
        use_border = True
        border_min_x, border_min_y = (ctypes.c_float(value).value for value in (0.1, 0.2))
        border_max_x, border_max_y = (ctypes.c_float(value).value for value in (0.7, 0.7))

    assert renderer.region_of(Border, 100, 60) == (10, 12, 70, 42)
    Border.use_border = False
    assert renderer.region_of(Border, 100, 60) == (0, 0, 100, 60)


def test_groups_name_planes_of_the_table() -> None:
    planes = {info.plane for info in passes.TABLE}
    assert all(set(group) <= planes for group in passes.GROUPS.values())
