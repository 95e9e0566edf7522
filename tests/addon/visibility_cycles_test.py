"""Holdout, indirect-only, shadow catchers and visibility to the camera have the effect of Cycles in the same Blender.

One picture shows all combinations.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images, recording
from support.nodes import new_world, shader_material

COLUMNS, ROWS = 16, 6


def switches() -> Iterator[tuple[bool, ...]]:
    """Yields all values of: holdout, indirect-only and exclude of a collection, holdout, catcher and hidden object."""
    for values in itertools.product((False, True), repeat=6):
        if not values[2] or sum(values) < 3:
            yield values


def add_cell(scene: bpy.types.Scene, index: int, values: tuple[bool, ...], is_instanced: bool) -> None:
    """Adds a plane in a collection of its own, or an instance of it, whose instancer is in that collection."""
    holdout, indirect, exclude, *of_object = values
    mesh = recording.grid(1, 0.9)
    mesh.materials.append(bpy.data.materials["Cell"])
    shown = bpy.data.objects.new(f"Cell {index}", mesh)
    owner = shown
    if is_instanced:
        inner = bpy.data.collections.new(f"Inner {index}")
        inner.objects.link(shown)
        owner = bpy.data.objects.new(f"Instancer {index}", None)
        owner.instance_type, owner.instance_collection = "COLLECTION", inner
    owner.location = (index % COLUMNS - COLUMNS / 2 + 0.5, index // COLUMNS - ROWS / 2 + 0.5, 0.0)
    collection = bpy.data.collections.new(f"Group {index}")
    scene.collection.children.link(collection)
    collection.objects.link(owner)
    shown.is_holdout, shown.is_shadow_catcher, shown.visible_camera = of_object[0], of_object[1], not of_object[2]
    layer = scene.view_layers[0].layer_collection.children[collection.name]
    layer.holdout, layer.indirect_only, layer.exclude = holdout, indirect, exclude


def blocks(scene: bpy.types.Scene, folder: Path, engine: str) -> np.ndarray:
    """Renders the picture and returns the means of the cells, with alpha."""
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y = 8 * COLUMNS, 8 * ROWS
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 64, False, False
    image = images.render(scene, folder, samples=64, integrator="PATH", reconstruction="NONE")["Combined"]
    return image.reshape(ROWS, 8, COLUMNS, 8, 4).mean(axis=(1, 3))


@pytest.mark.parametrize("is_instanced", [False, True], ids=["object", "instance"])
@pytest.mark.parametrize("transparent", [False, True], ids=["background", "transparent"])
def test_combinations(transparent: bool, is_instanced: bool, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: an object vanished that was held out and indirect-only, and instances of holdouts were holes."""
    recording.add_camera(type="ORTHO", ortho_scale=COLUMNS).location = (0.0, 0.0, 5.0)
    shader_material("BsdfDiffuse", {"Color": (0.8, 0.5, 0.3, 1.0)}).name = "Cell"
    scene.world = new_world((0.2, 0.3, 0.5))
    scene.render.film_transparent = transparent
    cells = list(switches())
    for index, values in enumerate(cells):
        add_cell(scene, index, values, is_instanced)
    expected, found = (blocks(scene, tmp_path, engine) for engine in ("CYCLES", "GRADUS"))
    difference = np.abs(expected - found).max(axis=2).ravel()
    off = [(cells[i], expected.reshape(-1, 4)[i], found.reshape(-1, 4)[i]) for i in np.flatnonzero(difference > 0.03)]
    assert not off, off
    assert len({tuple(cell.round(1)) for cell in expected.reshape(-1, 4)}) >= 2, "the switches have no effect"
