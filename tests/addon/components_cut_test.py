"""Motion of components at shot changes and disocclusions, where pass Tracked holds the cause."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

TRACKED, NOTHING, GONE, SHOT_CHANGE = 1.0, -1.0, -2.0, -8.0


@pytest.fixture
def room(scene: Any) -> Any:
    """Returns a scene with a wall in front of a camera, and a second static camera beside it."""
    bpy.ops.mesh.primitive_plane_add(size=20.0, location=(0, 5, 0), rotation=(np.pi / 2, 0, 0))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    scene.collection.objects.link(sun)
    for name, x in (("First", 0.0), ("Second", 0.1)):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        camera.location, camera.rotation_euler = (x, -5, 0), (np.pi / 2, 0, 0)
        scene.collection.objects.link(camera)
    scene.camera = bpy.data.objects["First"]
    scene.frame_start, scene.frame_end = 1, 4
    scene.gradus.use_decomposition = True
    scene.view_layers[0].gradus.use_pass_component_motion = True
    return scene


def tracked(render: Any, scene: Any, frame: int) -> np.ndarray:
    return render(scene, frame=frame)["ViewLayer.Path Diffuse Tracked"][..., 0]


def test_a_marker_that_binds_another_camera_is_a_shot_change(room: Any, render: Any) -> None:
    for name, frame in (("First", 1), ("Second", 3)):
        marker = room.timeline_markers.new(name, frame=frame)
        marker.camera = bpy.data.objects[name]
    found = {frame: np.unique(tracked(render, room, frame)) for frame in (1, 2, 3, 4)}
    assert found == {1: [TRACKED], 2: [SHOT_CHANGE], 3: [SHOT_CHANGE], 4: [TRACKED]}


def test_an_object_that_appears_is_not_tracked(room: Any, render: Any) -> None:
    bpy.ops.mesh.primitive_plane_add(size=2.0, location=(0, 0, 0), rotation=(np.pi / 2, 0, 0))
    board = bpy.context.object
    for frame, hidden in ((1, True), (2, False), (3, False)):
        board.hide_render = hidden
        board.keyframe_insert("hide_render", frame=frame)
    for frame, cause in ((2, GONE), (3, TRACKED)):
        found = tracked(render, room, frame)
        height, width = found.shape
        assert found[height // 2, width // 2] == cause, frame
        assert found[1, 1] == TRACKED, "the wall"


def test_a_mesh_of_another_topology_is_another_object(room: Any, render: Any) -> None:
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=2.0, rotation=(np.pi / 2, 0, 0))
    build = bpy.context.object.modifiers.new("Build", "BUILD")
    build.frame_start, build.frame_duration = -20, 100
    bpy.context.object.modifiers.new("Thick", "SOLIDIFY")
    found = tracked(render, room, 3)
    assert (found == GONE).any()
    assert found[1, 1] == TRACKED, "the wall"
