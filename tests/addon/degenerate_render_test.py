"""Degenerate meshes: concave faces are triangulated correctly, and loose edges and vertices are invisible."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest
from support import recording

# Outlines of faces. Holes are connected to them by two coinciding edges, as Blender's tools do.
SHAPES = {
    "L": ([(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)], 3.0),
    "frame": (
        [
            (-1, -1),
            (1, -1),
            (1, 1),
            (-1, 1),
            (-1, -1),
            (-0.5, -0.5),
            (-0.5, 0.5),
            (0.5, 0.5),
            (0.5, -0.5),
            (-0.5, -0.5),
        ],
        3.0,
    ),
    "star": ([(0, 1), (0.2, 0.2), (1, 0), (0.2, -0.2), (0, -1), (-0.2, -0.2), (-1, 0), (-0.2, 0.2)], 0.8),
    "no faces": ([], 0.0),
}


@pytest.mark.parametrize("name", list(SHAPES))
def test_d7_faces_with_holes_and_loose_edges(
    scene: bpy.types.Scene, render: Callable[..., dict[str, np.ndarray]], name: str
) -> None:
    outline, area = SHAPES[name]
    count = len(outline)
    loose = [(3.0, 0.0, 0.0), (-3.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, 0.0, 0.5)]
    mesh = bpy.data.meshes.new(name)
    vertices = [(x, y, 0.0) for x, y in outline] + loose
    mesh.from_pydata(vertices, [(count, count + 1), (count + 1, count + 2)], [list(range(count))] if count else [])
    recording.add(mesh)
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.film_transparent = True
    found = render(scene, samples=16, integrator="PATH", reconstruction="NONE", filter_width=1.0)["Combined"]
    assert np.isfinite(found).all()
    assert found[:, :, 3].mean() * 16.0 == pytest.approx(area, abs=0.03)
