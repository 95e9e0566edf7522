"""Cameras. Blender's sensor, fit and shift become the window of the full frame on the plane at distance 1.

The formula equals that of Blender's `object.calc_matrix_camera`. Shift moves the window, so the view axis appears at
minus the shift.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from .. import compat, native
from . import panorama
from .arrays import matrix_values
from .report import ExportError
from .shutter import Shutter

_PERSPECTIVE, _ORTHOGRAPHIC, _PANORAMA = native.CameraType
_MIN_FSTOP = 1e-5
_DEFAULT_LENS = 35.0  # mm, for objects that are not cameras, as in Blender
_DEFAULT_SENSOR = 36.0  # mm
_FAR = 1e30

# The version from which Cycles measures the focus of orthographic cameras from the camera, not from its near plane.
_FOCUS_FROM_CAMERA_SINCE = (4, 2, 0)


@dataclass(frozen=True)
class ViewOverride:
    """The view of a viewport, which is not a camera object."""

    matrix: tuple[float, ...]  # 16, column-major, view to world, without scale
    window: tuple[float, float, float, float]  # left, right, bottom, top; as GradusCamera.window
    type: str  # PERSP, ORTHO or PANO
    clip: tuple[float, float]
    width: int
    height: int
    projection: panorama.Projection | None = None

    @classmethod
    def from_view(
        cls, view_matrix: Any, window_matrix: Any, clip: tuple[float, float], width: int, height: int
    ) -> ViewOverride:
        """Derives the view from the matrices of a `region_data`, which is exact in every mode of the viewport."""
        projection = window_matrix
        m00, m11 = projection[0][0], projection[1][1]
        if projection[3][2] != 0.0:  # perspective: clip.w = -z
            kind, x, y = "PERSP", projection[0][2], projection[1][2]
        else:
            kind, x, y = "ORTHO", -projection[0][3], -projection[1][3]
        window = ((x - 1.0) / m00, (x + 1.0) / m00, (y - 1.0) / m11, (y + 1.0) / m11)
        if kind == "ORTHO" and clip[0] > 0.0:
            # The orthographic view of the viewport also shows objects behind its origin.
            clip = (-clip[1], clip[1])
        return cls(tuple(matrix_values(view_matrix.inverted().normalized())), window, kind, clip, width, height)

    @classmethod
    def from_panorama(
        cls, data: Any, view_matrix: Any, frame: tuple[float, float, float, float], render: Any, size: tuple[int, int]
    ) -> ViewOverride:
        """Returns the view through a panoramic camera.

        frame: left, bottom, right, top of the camera's frame in pixels of the view.
        """
        left, bottom, right, top = frame
        section = (
            -left / (right - left),
            (size[0] - left) / (right - left),
            -bottom / (top - bottom),
            (size[1] - bottom) / (top - bottom),
        )
        aspect = (render.pixel_aspect_x, render.pixel_aspect_y)
        shift = (data.shift_x, data.shift_y)
        window = panorama.window(data, shift, (render.resolution_x, render.resolution_y), aspect, section)
        matrix = tuple(matrix_values(view_matrix.inverted().normalized()))
        return cls(matrix, window, "PANO", (data.clip_start, data.clip_end), *size, panorama.Projection.of(data))


@dataclass(frozen=True)
class Eye:
    """An eye of spherical stereo."""

    offset: float = 0.0  # distance from the camera to the right
    convergence_distance: float = 0.0
    pole_merge: tuple[float, float] = (0.0, 0.0)


@dataclass
class CameraState:
    """A camera at one time."""

    matrix: tuple[float, ...]
    window: tuple[float, float, float, float]
    type: int = _PERSPECTIVE
    clip: tuple[float, float] = (0.1, 1000.0)
    aperture_radius: float = 0.0
    focus_distance: float = 1.0
    blades: int = 0
    blade_rotation: float = 0.0
    aperture_ratio: float = 1.0
    projection: panorama.Projection | None = None
    eye: Eye = Eye()


def frame_window(
    extent: float, fit: str, shift: tuple[float, float], width: int, height: int, aspect: tuple[float, float]
) -> tuple[float, float, float, float]:
    """Returns left, right, bottom, top of the frame.

    extent: size of the fitted side at distance 1 (sensor / lens), or ortho_scale in metres. fit: HORIZONTAL or
    VERTICAL. aspect: width and height of a pixel.
    """
    pixel_height = aspect[1] / aspect[0]
    view = width if fit == "HORIZONTAL" else pixel_height * height
    half_x = 0.5 * extent * width / view
    half_y = 0.5 * extent * height * pixel_height / view
    x, y = shift[0] * extent, shift[1] * extent
    return (x - half_x, x + half_x, y - half_y, y + half_y)


def resolve_fit(fit: str, width: int, height: int, aspect: tuple[float, float]) -> str:
    """Returns HORIZONTAL or VERTICAL. AUTO fits the longer side of the frame."""
    if fit != "AUTO":
        return fit
    return "HORIZONTAL" if width * aspect[0] >= height * aspect[1] else "VERTICAL"


def _focus_distance(dof: Any, matrix: Any) -> float:
    """Returns the distance to the focus along the view axis."""
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.matrix_world
    bone = getattr(dof, "focus_subtarget", "")
    if bone and dof.focus_object.pose is not None and bone in dof.focus_object.pose.bones:
        target = target @ dof.focus_object.pose.bones[bone].matrix
    offset = target.translation - matrix.translation
    return abs(offset.dot(matrix.col[2].to_3d().normalized()))


def _set_depth_of_field(state: CameraState, data: Any, matrix: Any) -> None:
    dof = data.dof
    if not dof.use_dof:
        return
    fstop = max(dof.aperture_fstop, _MIN_FSTOP)
    focal_length = 1.0 if data.type == "ORTHO" else data.lens * 1e-3  # m
    state.aperture_radius = focal_length / (2.0 * fstop)
    near = data.clip_start if data.type == "ORTHO" and compat.VERSION < _FOCUS_FROM_CAMERA_SINCE else 0.0
    state.focus_distance = max(_focus_distance(dof, matrix), 1e-5) + near
    state.blades = dof.aperture_blades
    state.blade_rotation = dof.aperture_rotation
    state.aperture_ratio = dof.aperture_ratio


def _camera_matrix(camera: Any, engine: Any, scene: Any) -> Any:
    """Returns camera to world without scale, for the current eye of a stereo render."""
    if engine is not None and scene.render.use_multiview:
        is_spherical = engine.use_spherical_stereo(camera)
        return engine.camera_model_matrix(camera, use_spherical_stereo=is_spherical).normalized()
    return camera.matrix_world.normalized()


def _shift_x(camera: Any, engine: Any, scene: Any) -> float:
    if engine is not None and scene.render.use_multiview:
        return engine.camera_shift_x(camera, use_spherical_stereo=engine.use_spherical_stereo(camera))
    return camera.data.shift_x


def _eye(camera: Any, engine: Any, scene: Any) -> Eye:
    sides = {"left": -0.5, "right": 0.5}
    view = engine.active_view_get() if engine is not None and scene.render.use_multiview else ""
    if view not in sides or not engine.use_spherical_stereo(camera):
        return Eye()
    stereo = camera.data.stereo
    return Eye(
        sides[view] * stereo.interocular_distance,
        0.0 if stereo.convergence_mode == "PARALLEL" else stereo.convergence_distance,
        (stereo.pole_merge_angle_from, stereo.pole_merge_angle_to) if stereo.use_pole_merge else (0.0, 0.0),
    )


def _refuse_unknown(camera: Any) -> None:
    data = camera.data
    if data.type == "CUSTOM":
        raise ExportError(f"Camera '{camera.name}' is of type Custom: Gradus does not support camera shaders")
    if data.type == "PANO" and not panorama.is_known(data):
        raise ExportError(f"Camera '{camera.name}' has a panorama type that Gradus does not support")


def camera_state(camera: Any, scene: Any, width: int, height: int, engine: Any = None) -> CameraState:
    """Returns the state of a camera at the evaluated frame. `camera` may be any object that is the scene's camera."""
    aspect = (scene.render.pixel_aspect_x, scene.render.pixel_aspect_y)
    matrix = _camera_matrix(camera, engine, scene)
    values = tuple(matrix_values(matrix))
    if not all(map(math.isfinite, values)):
        raise ExportError(f"Camera '{camera.name}' cannot be used: its matrix is not finite")
    if camera.type != "CAMERA":
        lens = _DEFAULT_LENS
        if camera.type == "LIGHT" and camera.data.type == "SPOT":
            lens = 16.0 / max(math.tan(0.5 * camera.data.spot_size), 1e-6)
        fit = resolve_fit("AUTO", width, height, aspect)
        window = frame_window(_DEFAULT_SENSOR / lens, fit, (0.0, 0.0), width, height, aspect)
        return CameraState(values, window, clip=(0.1, _FAR))
    data = camera.data
    _refuse_unknown(camera)
    shift = (_shift_x(camera, engine, scene), data.shift_y)
    clip = (data.clip_start, data.clip_end)
    if data.type == "PANO":
        state = CameraState(values, panorama.window(data, shift, (width, height), aspect), _PANORAMA, clip)
        state.projection = panorama.Projection.of(data)
    else:
        kind = _ORTHOGRAPHIC if data.type == "ORTHO" else _PERSPECTIVE
        state = CameraState(values, _flat_window(data, shift, width, height, aspect), kind, clip)
    state.eye = _eye(camera, engine, scene)
    _set_depth_of_field(state, data, matrix)
    return state


def _flat_window(
    data: Any, shift: tuple[float, float], width: int, height: int, aspect: tuple[float, float]
) -> tuple[float, float, float, float]:
    fit = resolve_fit(data.sensor_fit, width, height, aspect)
    sensor = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    extent = data.ortho_scale if data.type == "ORTHO" else sensor / data.lens
    return frame_window(extent, fit, shift, width, height, aspect)


def view_state(view: ViewOverride) -> CameraState:
    """Returns the camera state of a viewport."""
    kind = {"PERSP": _PERSPECTIVE, "ORTHO": _ORTHOGRAPHIC, "PANO": _PANORAMA}[view.type]
    return CameraState(tuple(view.matrix), view.window, kind, view.clip, projection=view.projection)


def _zoomed(window: panorama.Window, key: panorama.Window) -> panorama.Window:
    """Returns a window as wide and as tall as another one, with its own shift.

    As in Cycles, the shift does not move while the shutter is open.
    """
    left, right, bottom, top = window
    x, y = (key[1] - key[0]) / (right - left), (key[3] - key[2]) / (top - bottom)
    return (x * left, x * right, y * bottom, y * top)


def fill_camera(
    now: CameraState,
    previous: CameraState | None = None,
    following: CameraState | None = None,
    shutter: Shutter | None = None,
    keys: Sequence[CameraState] = (),
) -> tuple[native.Camera, list[Any]]:
    """Returns a native Camera, and the objects that must stay alive until the library has copied it.

    previous, following: the camera one frame before and after; None if it is static. keys: the camera while the shutter
    is open.
    """
    struct = native.Camera()
    previous = previous or now
    following = following or now
    struct.type = now.type
    struct.matrix[:] = array("f", now.matrix)
    struct.matrix_previous[:] = array("f", previous.matrix)
    struct.matrix_next[:] = array("f", following.matrix)
    struct.window[:] = now.window
    struct.window_previous[:] = previous.window
    struct.window_next[:] = following.window
    struct.clip_start, struct.clip_end = now.clip
    struct.aperture_radius = now.aperture_radius
    struct.focus_distance = now.focus_distance
    struct.blades = now.blades
    struct.blade_rotation = now.blade_rotation
    struct.aperture_ratio = now.aperture_ratio
    if now.projection is not None:
        struct.panorama = now.projection.kind
        struct.fisheye_fov = now.projection.fov
        struct.fisheye_polynomial[:] = now.projection.polynomial
    struct.eye_offset = now.eye.offset
    struct.convergence_distance = now.eye.convergence_distance
    struct.pole_merge_from, struct.pole_merge_to = now.eye.pole_merge
    if shutter is None:
        return struct, []
    matrices = array("f", [value for state in keys for value in state.matrix])
    windows = array("f", [value for state in keys for value in _zoomed(now.window, state.window)])
    struct.shutter_open, struct.shutter_close = shutter.open, shutter.close
    struct.shutter_curve_count = len(shutter.curve or ())
    struct.shutter_curve = native.pointer(shutter.curve)
    struct.shutter_key_count = len(keys)
    struct.shutter_matrices = native.pointer(matrices or None)
    struct.shutter_windows = native.pointer(windows or None)
    return struct, [shutter, matrices, windows]
