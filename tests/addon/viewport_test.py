"""What makes the Rendered viewport start again. Drawing itself is tested in a window (robustness/window_test.py)."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import pytest
from gradus import viewport
from support import recording


def signature() -> object:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    return viewport._signature(depsgraph)


def no_sky(layer: bpy.types.ViewLayer) -> None:
    layer.use_sky = False


def no_surfaces(layer: bpy.types.ViewLayer) -> None:
    layer.use_solid = False


def clay(layer: bpy.types.ViewLayer) -> None:
    layer.material_override = bpy.data.materials.new("Clay")


@pytest.mark.parametrize("change", [no_sky, no_surfaces, clay], ids=lambda change: change.__name__)
def test_a_changed_view_layer_starts_the_picture_again(scene: bpy.types.Scene, change: Callable[[bpy.types.ViewLayer], None]) -> None:
    """Blender tells of these by an update of the scene alone, as it does when something is selected."""
    obj = recording.add(recording.grid(1))
    before = signature()
    obj.select_set(True)
    assert signature() == before
    change(scene.view_layers[0])
    assert signature() != before
