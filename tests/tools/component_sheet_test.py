"""`make picture-components` shows the components of a frame side by side."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.module  # the application's Python has no Pillow
HEIGHT, WIDTH = 9, 16


@pytest.fixture
def tool() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "tools" / "component_sheet.py"))


def passes_of(name: str, color: tuple[float, float, float], tracked: float) -> dict[str, np.ndarray]:
    plane = np.ones((HEIGHT, WIDTH, 1), np.float32)
    motion = plane * np.array((-4.0, 0.0, -4.0, 0.0), np.float32)
    surface = {suffix: plane * np.array(color, np.float32) for suffix in ("", " Reflectance", " Irradiance", " Normal")}
    return {
        f"Path {name}{suffix}": image
        for suffix, image in (surface | {" Motion": motion, " Tracked": plane * tracked}).items()
    }


def test_a_column_for_each_component_and_a_row_for_each_pass(tool: dict[str, Any]) -> None:
    passes = {"Combined": np.ones((HEIGHT, WIDTH, 4), np.float32)}
    passes |= passes_of("Diffuse", (1.0, 0.0, 0.0), 1.0) | passes_of("Reflection", (0.0, 0.0, 1.0), -3.0)
    made = np.asarray(tool["sheet"](passes))
    gap, header = tool["GAP"], tool["HEADER"]
    assert made.shape == (5 * (HEIGHT + header) - gap, 2 * (WIDTH + gap) - gap, 3)

    def shown(row: int, column: int) -> list[int]:
        return made[row * (HEIGHT + header) + header - gap + HEIGHT // 2, column * (WIDTH + gap) + WIDTH // 2].tolist()

    assert [shown(0, 0), shown(0, 1)] == [[255, 0, 0], [0, 0, 255]]
    assert shown(4, 0) == [255, 0, 0], "to the right is red"
    assert shown(4, 1) == [64, 64, 64], "not tracked"


def flow_of(name: str, x: float) -> dict[str, np.ndarray]:
    motion = np.full((HEIGHT, WIDTH, 4), x, np.float32)
    return {f"Path {name} Irradiance Motion": motion, f"Path {name} Irradiance Tracked": motion[..., :1] * 0.0 - 9.0}


def test_motion_of_irradiance_is_not_that_of_a_component(tool: dict[str, Any]) -> None:
    """Motion of irradiance must not count as motion of a component.

    Regression: it ended in KeyError: 'Path Diffuse Irradiance Tracked', or its length dimmed all other motion.
    """
    passes = {"Combined": np.ones((HEIGHT, WIDTH, 4), np.float32)}
    for name in ("Diffuse", "Irradiance"):
        passes |= passes_of(name, (1.0, 0.0, 0.0), 1.0) | flow_of(name, -400.0)
    assert tool["components"](passes) == ["Diffuse", "Irradiance"]
    assert tool["longest_motion"](passes) == 4.0
    assert tool["sheet"](passes).size[0] == 2 * (WIDTH + tool["GAP"]) - tool["GAP"]


def test_empty_passes_have_no_row(tool: dict[str, Any]) -> None:
    passes = {"Combined": np.ones((HEIGHT, WIDTH, 4), np.float32)} | passes_of("Diffuse", (1.0, 0.0, 0.0), 0.0)
    passes["Path Diffuse Motion"] = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    assert tool["sheet"](passes).size[1] == 4 * (HEIGHT + tool["HEADER"]) - tool["GAP"]


def test_files_of_blender_are_read(tool: dict[str, Any], tmp_path: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "sample_blends" / "mirror_and_glass.blend"))
    scene = bpy.context.scene
    images.prepare(scene)
    images.use_exr(scene, tmp_path / "frame.exr")
    bpy.ops.render.render(write_still=True, scene=scene.name)
    found, expected = tool["read"](tmp_path / "frame.exr"), images.read(tmp_path / "frame.exr")
    assert sorted(tool["components"](found)) == ["Diffuse", "Emission", "Reflection", "Residual", "Transmission"]
    for name in ("Combined", "Path Diffuse", "Path Diffuse Motion"):
        np.testing.assert_array_equal(found[name], np.flipud(expected[f"ViewLayer.{name}"]))
