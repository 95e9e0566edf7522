"""Baking of colour spaces into curve and matrix (contract 8.1)."""

from __future__ import annotations

from array import array
from pathlib import Path

import bpy
import pytest
from gradus import color, compat

MATRIX = (0.6, 0.3, 0.1, 0.2, 0.7, 0.1, 0.05, 0.15, 0.8)


def linear(encoded: float) -> float:
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def convert(rgb: list[float]) -> list[float]:
    values = [linear(value) for value in rgb]
    return [sum(MATRIX[3 * row + i] * values[i] for i in range(3)) for row in range(3)]


def test_profile() -> None:
    assert color.profile_of("ocio_profile_version: 2.4\n\nenvironment: {}") == (2, 4)
    assert color.profile_of("# x\nocio_profile_version: 2\n") == (2, 0)
    assert color.profile_of("nonsense") == (1, 0)


def test_curve_and_matrix_are_found() -> None:
    curve, matrix = color.curve_and_matrix(convert)
    assert matrix == pytest.approx(MATRIX)
    assert curve[512] == pytest.approx(linear(512 / (color.CURVE_SAMPLES - 1)), abs=1e-6)


def test_what_has_another_form_is_refused() -> None:
    assert color.curve_and_matrix(lambda rgb: [rgb[0] * rgb[1], rgb[1], rgb[2]]) is None
    assert color.curve_and_matrix(lambda rgb: [value + 0.1 for value in rgb]) is None
    assert color.curve_and_matrix(lambda rgb: [0.0, 0.0, 0.0]) is None


def test_this_blender_s_configuration() -> None:
    path = compat.color_config_path()
    assert Path(path).is_file()
    assert color.needs_baking(path) == (bpy.app.version >= (5, 0, 0))
    if not color.needs_baking(path):
        return
    baked = {name: (curve, matrix) for name, curve, matrix in color.bake(path, compat.bundled_python_packages())}
    curve, matrix = baked["sRGB"]
    assert curve[512] == pytest.approx(linear(512 / (color.CURVE_SAMPLES - 1)), abs=1e-4)
    assert matrix == pytest.approx([1, 0, 0, 0, 1, 0, 0, 0, 1], abs=1e-3)
    assert baked["Linear Rec.709"][0] == array("f")
    assert "ACEScg" in baked


def test_f5_missing_configuration(tmp_path: Path) -> None:
    assert not color.needs_baking(str(tmp_path / "none.ocio"))
    assert list(color.bake(str(tmp_path / "none.ocio"), compat.bundled_python_packages())) == []
