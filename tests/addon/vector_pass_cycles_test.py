"""The pass Vector is that of Cycles in the same Blender, also at outlines and in the background."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import cycles, recording
from support.nodes import new_world

MOVES = {
    "object": (0.4, 0.0, 0.0),
    "object, orthographic": (0.4, 0.0, 0.0),
    "camera": (0.3, 0.0, 0.1),
    "turn": (0.0, 0.0, 0.06),
}


@pytest.mark.parametrize("moves", MOVES)
def test_vectors(scene: bpy.types.Scene, tmp_path: Path, moves: str) -> None:
    """A cube or the camera moves; pixels at the outline show the cube and the world."""
    if moves == "turn" and bpy.app.version >= (5, 2, 0):
        pytest.skip("Cycles 5.2 does not divide the background's motion by the distance from the camera's plane")
    camera = recording.add_camera(**({"type": "ORTHO", "ortho_scale": 5.0} if "ortho" in moves else {"lens": 40.0}))
    camera.location, camera.rotation_euler = (0.0, -6.0, 0.0), (1.5708, 0.0, 0.0)
    bpy.ops.mesh.primitive_cube_add(size=2.0, rotation=(0.0, 0.5, 0.0))
    obj = bpy.context.object if "object" in moves else camera
    path = "rotation_euler" if moves == "turn" else "location"
    start = np.array(getattr(obj, path))
    for frame in (0, 2):
        setattr(obj, path, start + (frame - 1) * np.array(MOVES[moves]))
        obj.keyframe_insert(path, frame=frame)
    scene.frame_set(1)
    scene.world = new_world((0.5, 0.5, 0.5))
    bpy.context.view_layer.use_pass_vector = True
    pictures = [cycles.passes(scene, tmp_path, engine, samples=64)["Vector"] for engine in ("CYCLES", "GRADUS")]
    reference, ours = (cycles.blocks(np.asarray(picture)) for picture in pictures)
    assert np.abs(reference).max() > 1.0
    # A pixel of which the cube covers less than a sample has its full motion before 5.2, in one engine or in both.
    assert np.mean(np.abs(ours - reference) > 0.03 * np.abs(reference).max()) < 0.03
    np.testing.assert_allclose(ours.sum(axis=(0, 1)), reference.sum(axis=(0, 1)), atol=0.02 * np.abs(reference).sum())
