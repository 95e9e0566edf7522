"""Baking of colour spaces into a curve and a matrix."""

from __future__ import annotations

from array import array
from pathlib import Path

import bpy
import pytest
from gradus import color, compat, native, store

MATRIX = (0.6, 0.3, 0.1, 0.2, 0.7, 0.1, 0.05, 0.15, 0.8)


def linear(encoded: float) -> float:
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def convert(rgb: array) -> None:
    for first in range(0, len(rgb), 3):
        values = [linear(value) for value in rgb[first : first + 3]]
        for row in range(3):
            rgb[first + row] = sum(MATRIX[3 * row + i] * values[i] for i in range(3))


def mix_channels(rgb: array) -> None:
    for first in range(0, len(rgb), 3):
        rgb[first] *= rgb[first + 1]


def lift(rgb: array) -> None:
    for index in range(len(rgb)):
        rgb[index] += 0.1


def blacken(rgb: array) -> None:
    for index in range(len(rgb)):
        rgb[index] = 0.0


def test_profile() -> None:
    assert color.profile_of("ocio_profile_version: 2.4\n\nenvironment: {}") == (2, 4)
    assert color.profile_of("# x\nocio_profile_version: 2\n") == (2, 0)
    assert color.profile_of("nonsense") == (1, 0)


def test_curve_and_matrix_are_found() -> None:
    curve, matrix = color.curve_and_matrix(convert)
    assert matrix == pytest.approx(MATRIX)
    assert curve[512] == pytest.approx(linear(512 / (color.CURVE_SAMPLES - 1)), abs=1e-6)


@pytest.mark.parametrize("other", [mix_channels, lift, blacken])
def test_spaces_of_another_form_are_refused(other: color.Convert) -> None:
    assert color.curve_and_matrix(other) is None


def test_a_linear_space_has_no_curve() -> None:
    curve, matrix = color.curve_and_matrix(lambda rgb: None)
    assert len(curve) == 0
    assert matrix == pytest.approx([1, 0, 0, 0, 1, 0, 0, 0, 1])


def test_this_blender_s_configuration() -> None:
    path = compat.color_config_path()
    assert Path(path).is_file()
    baker = color.baker_for(path, compat.bundled_python_packages())
    assert (baker is not None) == (bpy.app.version >= (5, 0, 0))
    if baker is None:
        return
    curve, matrix = baker.bake("sRGB")
    assert curve[512] == pytest.approx(linear(512 / (color.CURVE_SAMPLES - 1)), abs=1e-4)
    assert matrix == pytest.approx([1, 0, 0, 0, 1, 0, 0, 0, 1], abs=1e-3)
    assert len(baker.bake("Linear Rec.709")[0]) == 0
    assert baker.bake("ACEScg")[1][0] == pytest.approx(1.7050, abs=1e-3)  # AP1 to Rec.709
    assert baker.bake("AgX Base sRGB") is None
    assert baker.bake("no such space") is None


def test_f5_missing_configuration(tmp_path: Path) -> None:
    assert not color.needs_baking(str(tmp_path / "none.ocio"))
    assert color.baker_for(str(tmp_path / "none.ocio"), compat.bundled_python_packages()) is None


def test_the_device_has_no_warnings_about_blender_s_configuration() -> None:
    library = native.load()
    store.clear()
    assert library.take_device_warnings(store.device(library)) == []
