"""Cameras: the window of the frame for all settings, depth of field, and objects that are used as cameras."""

from __future__ import annotations

import itertools

import bpy
import numpy as np
import pytest
from mathutils import Vector
from support import recording

FRAMES = ((64, 36, 1.0, 1.0), (36, 64, 1.0, 1.0), (50, 50, 1.0, 1.0), (64, 36, 2.0, 1.0), (36, 64, 1.0, 3.0))
POINTS = (Vector((0.3, -0.2, 0.0)), Vector((-0.7, 0.4, 1.0)), Vector((1.2, 0.9, -2.0)))


def _pixel(camera: object, window: list[float], point: Vector, size: tuple[int, int], orthographic: bool) -> np.ndarray:
    """Returns the position of a world point in pixels, by the exported matrix and window."""
    world = np.array(camera.matrix).reshape(4, 4).T  # matrices of the C API are column-major
    local = np.linalg.inv(world) @ np.array([*point, 1.0])
    place = local[:2] if orthographic else local[:2] / -local[2]
    left, right, bottom, top = window
    return np.array([(place[0] - left) / (right - left) * size[0], (place[1] - bottom) / (top - bottom) * size[1]])


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
def test_projection_equals_blender(scene: bpy.types.Scene, kind: str, fit: str) -> None:
    """Points project within 0.01 px of Blender's own projection, for several sizes, pixel aspects and shifts."""
    camera = recording.add_camera(
        type=kind, sensor_fit=fit, lens=35.0, sensor_width=36.0, sensor_height=20.0, ortho_scale=4.0
    )
    camera.rotation_euler = (0.2, -0.1, 0.3)
    for (width, height, aspect_x, aspect_y), shift in itertools.product(FRAMES, ((0.0, 0.0), (0.3, -0.2))):
        render = scene.render
        render.resolution_x, render.resolution_y, render.pixel_aspect_x, render.pixel_aspect_y = (
            width,
            height,
            aspect_x,
            aspect_y,
        )
        camera.data.shift_x, camera.data.shift_y = shift
        recorded, _ = recording.export(scene)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        projection = camera.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=aspect_x, scale_y=aspect_y)
        view = projection @ camera.matrix_world.normalized().inverted()
        for point in POINTS:
            clip = view @ point.to_4d()
            expected = [(clip[0] / clip[3] * 0.5 + 0.5) * width, (clip[1] / clip[3] * 0.5 + 0.5) * height]
            found = _pixel(recorded.camera, list(recorded.camera.window), point, (width, height), kind == "ORTHO")
            assert np.abs(found - expected).max() < 0.01, (width, height, aspect_x, aspect_y, shift, point)


def test_depth_of_field(scene: bpy.types.Scene) -> None:
    camera = recording.add_camera(lens=50.0)
    dof = camera.data.dof
    dof.use_dof, dof.aperture_fstop, dof.aperture_blades, dof.aperture_ratio = True, 2.0, 6, 1.5
    dof.aperture_rotation, dof.focus_distance = 0.25, 3.0
    recorded = recording.export(scene)[0].camera
    assert recorded.aperture_radius == pytest.approx(0.050 / 4.0)
    assert (recorded.focus_distance, recorded.blades) == (pytest.approx(3.0), 6)
    assert (recorded.blade_rotation, recorded.aperture_ratio) == (pytest.approx(0.25), pytest.approx(1.5))
    dof.focus_object = recording.add(None, "Focus", (3.0, 4.0, 1.0))
    assert recording.export(scene)[0].camera.focus_distance == pytest.approx(4.0), (
        "along the view axis, not the distance"
    )
    camera.data.type, camera.data.clip_start = "ORTHO", 0.5
    orthographic = recording.export(scene)[0].camera
    assert orthographic.aperture_radius == pytest.approx(0.25)
    # Regression: Cycles before 4.2 measures the focus of orthographic cameras from their near plane.
    near = 0.5 if bpy.app.version < (4, 2, 0) else 0.0
    assert orthographic.focus_distance == pytest.approx(4.0 + near)


def test_scale_of_a_camera_does_not_count(scene: bpy.types.Scene) -> None:
    camera = recording.add_camera()
    camera.scale = (2.0, 3.0, 0.5)
    matrix = np.array(recording.export(scene)[0].camera.matrix).reshape(4, 4)
    assert np.allclose(np.linalg.norm(matrix[:3, :3], axis=1), 1.0)


@pytest.mark.parametrize("kind", ["SPOT", "EMPTY"])
def test_other_objects_as_cameras_have_the_view_of_blender_s_viewport(scene: bpy.types.Scene, kind: str) -> None:
    """Regression: the sensor was 32 mm wide instead of 36 mm, so that everything was 12 % too large."""
    data = None if kind == "EMPTY" else bpy.data.lights.new("Eye", kind)
    scene.camera = recording.add(data, "Eye")
    left, right, _, _ = recording.export(scene)[0].camera.window
    depsgraph = bpy.context.evaluated_depsgraph_get()
    width, height = scene.render.resolution_x, scene.render.resolution_y
    projection = scene.camera.evaluated_get(depsgraph).calc_matrix_camera(depsgraph, x=width, y=height)
    assert 2 / (right - left) == pytest.approx(projection[0][0])


def test_camera_shader_is_refused(scene: bpy.types.Scene) -> None:
    from gradus.export import ExportError

    camera = recording.add_camera()
    if "CUSTOM" not in camera.data.bl_rna.properties["type"].enum_items:
        pytest.skip("this Blender has no camera shaders")
    camera.data.type = "CUSTOM"
    with pytest.raises(ExportError, match="camera shaders"):
        recording.export(scene)


def test_sensor_of_a_fisheye_has_the_frame_s_shape(scene: bpy.types.Scene) -> None:
    """With an equisolid lens of 10 mm and a sensor of 20 mm, the sine of half the angle at the edge is 0.5."""
    camera = recording.add_camera(type="PANO", sensor_width=20.0, sensor_fit="HORIZONTAL")
    panorama = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    panorama.panorama_type, panorama.fisheye_lens, panorama.fisheye_fov = "FISHEYE_EQUISOLID", 10.0, 3.0
    scene.render.resolution_x, scene.render.resolution_y = 40, 20
    recorded = recording.export(scene)[0].camera
    assert list(recorded.window) == pytest.approx([-0.5, 0.5, -0.25, 0.25])
    assert recorded.fisheye_fov == pytest.approx(3.0)


def test_no_camera_is_refused(scene: bpy.types.Scene) -> None:
    from gradus.export import ExportError

    with pytest.raises(ExportError, match="no camera"):
        recording.export(scene)


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_view_from_matrices_equals_the_camera(scene: bpy.types.Scene, kind: str) -> None:
    """The matrices of a viewport result in the window of the same camera."""
    from gradus.export import ViewOverride

    camera = recording.add_camera(type=kind, shift_x=0.1, shift_y=-0.2)
    expected = recording.export(scene)[0].camera
    projection = camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=64, y=36)
    view = ViewOverride.from_view(camera.matrix_world.inverted(), projection, (0.1, 100.0), 64, 36)
    found = recording.export(scene, view=view)[0].camera
    assert np.allclose(list(found.window), list(expected.window), atol=1e-5)
    assert np.allclose(list(found.matrix), list(expected.matrix), atol=1e-5)


def test_view_through_a_panorama_shows_the_part_of_the_frame_in_view(scene: bpy.types.Scene) -> None:
    """If the frame fills the middle half of a view, the window is twice as wide about the same centre."""
    from gradus.export import ViewOverride

    camera = recording.add_camera(type="PANO", shift_x=0.1)
    (camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles).panorama_type = "FISHEYE_EQUIDISTANT"
    whole = list(recording.export(scene)[0].camera.window)
    view = ViewOverride.from_panorama(
        camera.data, camera.matrix_world.inverted(), (20.0, 10.0, 60.0, 30.0), scene.render, (80, 40)
    )
    found = recording.export(scene, view=view)[0].camera
    assert found.type == 2 and found.fisheye_fov == pytest.approx(3.14159265)
    width, height = whole[1] - whole[0], whole[3] - whole[2]
    expected = [whole[0] - width / 2, whole[1] + width / 2, whole[2] - height / 2, whole[3] + height / 2]
    assert list(found.window) == pytest.approx(expected, abs=1e-5)
