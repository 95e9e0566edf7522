"""Pass Vector of known motions is exact to 0.01 px.

XY is previous - current and ZW is current - next, in pixels, y upwards.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import mathutils
import numpy as np
import pytest
from support import animation, images, recording

SETTINGS = {"samples": 2, "integrator": "PATH", "reconstruction": "NONE", "max_bounces": 0}
PIXELS_PER_METRE = 16.0  # px/m: 64 px cover 4 m


@pytest.fixture
def vectors(scene: bpy.types.Scene, render: Callable[..., Any]) -> Callable[[], np.ndarray]:
    """Returns a function that renders the Vector pass at frame 2."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)

    def run() -> np.ndarray:
        scene.view_layers[0].use_pass_vector = True
        return render(scene, frame=2, **SETTINGS)["Vector"]

    return run


def _covered(vector: np.ndarray) -> np.ndarray:
    """Returns the centre of the image, which the object covers in all frames."""
    height, width, _ = vector.shape
    return vector[height // 2 - 4 : height // 2 + 4, width // 2 - 4 : width // 2 + 4]


def test_c1_moving_object_over_a_static_background(vectors: Callable[[], np.ndarray]) -> None:
    obj = recording.add(recording.grid(1, 1.5))
    animation.key(obj, "location", {1: (-0.25, -0.125, 0), 2: (0, 0, 0), 3: (0.5, 0.125, 0)})
    found = vectors()
    expected = (-0.25 * PIXELS_PER_METRE, -0.125 * PIXELS_PER_METRE, -0.5 * PIXELS_PER_METRE, -0.125 * PIXELS_PER_METRE)
    assert np.allclose(_covered(found), expected, atol=0.01)
    assert np.array_equal(found[0, 0], np.zeros(4)), "the background does not move"


def test_c1_static_object_is_exactly_zero(vectors: Callable[[], np.ndarray]) -> None:
    recording.add(recording.grid(1, 1.5)).rotation_euler = (0.3, 0.2, 0.1)
    moving = recording.add(recording.grid(1, 0.2), "Moving", (0, 1.05, 0))
    animation.key(moving, "location", {1: (-1, 1.05, 0), 3: (1, 1.05, 0)})
    assert np.array_equal(_covered(vectors()), np.zeros((8, 8, 4)))


def test_c1_deformation(vectors: Callable[[], np.ndarray]) -> None:
    """A shape key moves all points."""
    obj = recording.add(recording.grid(2, 2.0))
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Moved")
    for point in key.data:
        point.co.x += 1.0
    animation.key(key, "value", {1: 0.0, 2: 0.25, 3: 0.375})
    assert np.allclose(_covered(vectors()), (-4.0, 0.0, -2.0, 0.0), atol=0.01)


def test_c1_instances(vectors: Callable[[], np.ndarray], scene: bpy.types.Scene) -> None:
    """A moving empty instances a static collection."""
    source = bpy.data.collections.new("Source")
    source.objects.link(bpy.data.objects.new("Inner", recording.grid(1, 1.5)))
    empty = recording.add(None, "Copy")
    empty.instance_type, empty.instance_collection = "COLLECTION", source
    animation.key(empty, "location", {1: (-0.25, 0, 0), 2: (0, 0, 0), 3: (0.25, 0, 0)})
    assert np.allclose(_covered(vectors()), (-4.0, 0.0, -4.0, 0.0), atol=0.01)


def test_c1_camera_pan(vectors: Callable[[], np.ndarray], scene: bpy.types.Scene) -> None:
    """Static objects move relative to the camera."""
    recording.add(recording.grid(1, 1.5))
    animation.key(scene.camera, "location", {1: (-0.25, 0, 5), 2: (0, 0, 5), 3: (0.25, 0, 5)})
    assert np.allclose(_covered(vectors()), (4.0, 0.0, 4.0, 0.0), atol=0.01)


def test_c1_each_view_has_vectors_of_its_own_camera(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """The frame is exported once for all views."""
    recording.add(recording.grid(1, 1.5))
    for name in ("Camera_R", "Camera_L"):
        recording.add_camera(type="ORTHO", ortho_scale=4.0).name = name
    animation.key(bpy.data.objects["Camera_R"], "location", {1: (-0.25, 0, 5), 2: (0, 0, 5), 3: (0.25, 0, 5)})
    scene.render.use_multiview, scene.render.views_format = True, "MULTIVIEW"
    scene.view_layers[0].use_pass_vector = True
    for name, value in SETTINGS.items():
        setattr(scene.gradus, name, value)
    scene.frame_set(2)
    images.use_exr(scene, tmp_path / "f.exr")
    scene.render.image_settings.views_format = "INDIVIDUAL"
    bpy.ops.render.render(write_still=True, scene=scene.name)
    left, right = (images.read(tmp_path / f"f{suffix}.exr")["Vector"] for suffix in ("_L", "_R"))
    assert not left.any(), "it does not move"
    assert np.allclose(_covered(right), (4.0, 0.0, 4.0, 0.0), atol=0.01)


def test_c1_camera_zoom(vectors: Callable[[], np.ndarray], scene: bpy.types.Scene) -> None:
    """A point at p pixels from the centre was at p s_2/s_1 in the previous frame."""
    recording.add(recording.grid(1, 8.0))
    animation.key(scene.camera.data, "ortho_scale", {1: 5.0, 2: 4.0, 3: 3.2})
    found = vectors()
    height, width, _ = found.shape
    x = np.arange(width) + 0.5 - width / 2
    row = found[height // 2]
    # Samples within the pixel are averaged: half a filter width times the relative change.
    assert np.allclose(row[:, 0], x * (4.0 / 5.0 - 1.0), atol=0.25)
    assert np.allclose(row[:, 2], x * (1.0 - 4.0 / 3.2), atol=0.25)


def _panorama(camera: bpy.types.Object, kind: str) -> Any:
    """Sets up a panorama that looks along Y, in a room whose walls are visible all around."""
    camera.data.type = "PANO"
    camera.location, camera.rotation_euler = (0, 0, 0), (math.pi / 2, 0, 0)
    bpy.ops.mesh.primitive_cube_add(size=8.0, location=(0.5, 0.3, 0.2))
    settings = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    settings.panorama_type = kind
    return settings


def test_c1_panorama_turns(scene: bpy.types.Scene, vectors: Callable[[], np.ndarray]) -> None:
    """Everything moves by the same angle, also across the seam.

    Near the poles, pixels are as small as rounding errors.
    """
    _panorama(scene.camera, "EQUIRECTANGULAR")
    animation.key(
        scene.camera, "rotation_euler", {1: (math.pi / 2, 0, -0.1), 2: (math.pi / 2, 0, 0), 3: (math.pi / 2, 0, 0.2)}
    )
    found = vectors()
    pixels = found.shape[1] / (2 * math.pi)
    assert np.allclose(found[3:-3], (-0.1 * pixels, 0, -0.2 * pixels, 0), atol=0.01)


def test_c1_fisheye_zooms(scene: bpy.types.Scene, vectors: Callable[[], np.ndarray]) -> None:
    """The radius in the image is proportional to the focal length."""
    settings = _panorama(scene.camera, "FISHEYE_EQUISOLID")
    animation.key(settings, "fisheye_lens", {1: 10.0, 2: 15.0, 3: 18.0})
    scene.gradus.pixel_filter, scene.gradus.filter_width = "GAUSSIAN", 0.01
    found = vectors()
    height, width, _ = found.shape
    y, x = np.mgrid[0:height, 0:width] + 0.5
    place = np.stack([x - width / 2, y - height / 2], axis=2)
    expected = np.concatenate([place * (10 / 15 - 1), place * (1 - 18 / 15)], axis=2)
    seen = np.any(found != 0.0, axis=2)
    assert seen.sum() > 1000
    assert np.allclose(found[seen], expected[seen], atol=0.016)  # half the width of the filter


def test_c1_rotation(vectors: Callable[[], np.ndarray]) -> None:
    """A quad rotates about the view axis: vectors are perpendicular to the radius, with its length times the angle."""
    obj = recording.add(recording.grid(1, 3.0))
    angle = 0.01
    animation.key(obj, "rotation_euler", {1: (0, 0, -angle), 2: (0, 0, 0), 3: (0, 0, angle)})
    found = vectors()
    height, width, _ = found.shape
    x, y = 15.0, 10.0
    pixel = found[height // 2 + int(y), width // 2 + int(x)]
    assert np.allclose(pixel, (angle * (y + 0.5), -angle * (x + 0.5), angle * (y + 0.5), -angle * (x + 0.5)), atol=0.02)


def test_c1_camera_orbit(scene: bpy.types.Scene, vectors: Callable[[], np.ndarray]) -> None:
    """A perspective camera orbits: the expected vectors follow from the point on the floor and the other cameras."""
    recording.add(recording.grid(1, 40.0))
    camera, pivot = scene.camera, recording.add(None, "Pivot")
    camera.parent, camera.data.type, camera.data.lens, camera.data.sensor_width = pivot, "PERSP", 50.0, 36.0
    camera.location, camera.rotation_euler = (0.0, -4.0, 4.0), (math.pi / 4, 0.0, 0.0)
    turns = {1: -0.1, 2: 0.0, 3: 0.15}
    animation.key(pivot, "rotation_euler", {frame: (0, 0, angle) for frame, angle in turns.items()})
    scene.gradus.pixel_filter, scene.gradus.filter_width = "GAUSSIAN", 0.01
    found = vectors()
    height, width, _ = found.shape
    scale = width / (2 * 18.0 / 50.0)  # px/m at distance 1
    y, x = np.mgrid[0:height, 0:width] + 0.5
    film = np.stack([x - width / 2, y - height / 2], axis=2)
    pose = np.array(mathutils.Matrix.Translation((0, -4, 4)) @ mathutils.Matrix.Rotation(math.pi / 4, 4, "X"))
    rays = np.concatenate([film / scale, -np.ones((height, width, 1))], axis=2) @ pose[:3, :3].T
    floor = pose[:3, 3] - rays * (4.0 / rays[..., 2:])

    def seen(angle: float) -> np.ndarray:
        matrix = np.linalg.inv(np.array(mathutils.Matrix.Rotation(angle, 4, "Z")) @ pose)
        local = floor @ matrix[:3, :3].T + matrix[:3, 3]
        return scale * local[..., :2] / -local[..., 2:]

    expected = np.concatenate([seen(turns[1]) - film, film - seen(turns[3])], axis=2)
    away = np.abs(found - expected).max(axis=2)
    assert np.abs(expected).max() > 1.0
    assert np.quantile(away, 0.999) < 0.02  # half the width of the filter


def test_c1_skin(vectors: Callable[[], np.ndarray]) -> None:
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    obj = recording.add(recording.grid(2, 1.5))
    obj.vertex_groups.new(name=armature.pose.bones[0].name).add(range(9), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = armature
    animation.key(armature.pose.bones[0], "location", {1: (-0.25, 0, 0), 2: (0, 0, 0), 3: (0.125, 0, 0)})
    assert np.allclose(_covered(vectors()), (-4.0, 0.0, -2.0, 0.0), atol=0.01)


def test_c1_topology_change_does_not_crash(vectors: Callable[[], np.ndarray]) -> None:
    obj = recording.add(recording.grid(2, 2.0))
    modifier = obj.modifiers.new("Array", "ARRAY")
    animation.key(modifier, "count", {1: 1, 2: 2, 3: 3})
    assert np.isfinite(vectors()).all()


def test_c1_velocities_are_motion(vectors: Callable[[], np.ndarray]) -> None:
    """Regression: fluids and caches, whose topology changes, had the motion of their matrices only."""
    mesh = recording.grid(1, 1.5)
    velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    for item in velocity.data:
        item.vector = (6.0, -3.0, 0.0)  # metres per second, at 24 frames per second
    recording.add(mesh)
    assert np.allclose(_covered(vectors()), (-4.0, 2.0, -4.0, 2.0), atol=0.01)


def test_c1_without_motion_blur_or_vector_the_pass_is_absent(
    scene: bpy.types.Scene, render: Callable[..., Any]
) -> None:
    recording.add_camera()
    assert "Vector" not in render(scene, **SETTINGS)


def test_c1_vectors_requested_on_the_command_line_contain_motion(
    scene: bpy.types.Scene, render: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Regression: neighbouring frames were read only if the view layer had the pass, so that everything was static."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    animation.key(recording.add(recording.grid(1, 1.5)), "location", {1: (-0.25, 0, 0), 2: (0, 0, 0), 3: (0.25, 0, 0)})
    monkeypatch.setattr(sys, "argv", ["blender", "--", "--gradus-passes", "vector"])
    found = render(scene, frame=2, **SETTINGS)["Vector"]
    assert np.allclose(_covered(found), (-4.0, 0.0, -4.0, 0.0), atol=0.01)
