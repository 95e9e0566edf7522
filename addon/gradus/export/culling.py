"""Instances that Simplify leaves out, because they are far from the camera or outside of its picture, as in Cycles."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..abi import CameraType
from .camera import CameraState
from .collect import Collected, Entry

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Culling:
    """The settings of a scene, and its camera. None: instances are not left out by this."""

    camera: CameraState
    distance: float | None  # metres
    margin: float | None  # around the picture, as a share of its size

    def hides(self, entry: Entry, matrix: Sequence[float]) -> bool:
        """Returns whether an instance is left out. matrix: its placement, column-major.

        An object with both switches is left out if both tests say so.
        """
        switches = getattr(entry.object, "cycles", None)
        by_camera = self.margin is not None and getattr(switches, "use_camera_cull", False)
        by_distance = self.distance is not None and getattr(switches, "use_distance_cull", False)
        if not (by_camera or by_distance):
            return False
        corners = [_transform(matrix, corner) for corner in entry.object.bound_box]
        is_outside = by_camera and _is_outside(self.camera, corners, self.margin)
        is_far = by_distance and _distance(self.camera, corners) > self.distance
        return (is_outside or not by_camera) and (is_far or not by_distance)


def culling_of(scene: Any, camera: CameraState | None) -> Culling | None:
    """Returns the culling of a scene, or None if it leaves nothing out. camera: None with several views.

    As in Cycles, panoramas show everything, and so does a distance of 0.
    """
    cycles = getattr(scene, "cycles", None)
    is_off = cycles is None or not scene.render.use_simplify or scene.render.use_multiview
    if is_off or camera is None or camera.type == CameraType.PANORAMA:
        return None
    distance = cycles.distance_cull_margin if cycles.use_distance_cull and cycles.distance_cull_margin else None
    margin = cycles.camera_cull_margin if cycles.use_camera_cull else None
    return None if distance is None and margin is None else Culling(camera, distance, margin)


def cull(collected: Collected, culling: Culling) -> None:
    """Removes the surfaces that are left out. Lights stay."""

    def matrix(entry: Entry) -> array:
        return collected.matrices[16 * entry.index : 16 * entry.index + 16]

    collected.surfaces = [entry for entry in collected.surfaces if not culling.hides(entry, matrix(entry))]


def _transform(matrix: Sequence[float], point: Sequence[float]) -> Point:
    x, y, z = point
    return tuple(matrix[i] * x + matrix[4 + i] * y + matrix[8 + i] * z + matrix[12 + i] for i in range(3))


def _distance(camera: CameraState, corners: list[Point]) -> float:
    """Returns the distance of the camera from the box around corners, whose sides are along the axes of the world."""
    eye = camera.matrix[12:15]
    boxes = ((min(values), max(values)) for values in zip(*corners, strict=True))
    return sum(max(low - x, x - high, 0.0) ** 2 for x, (low, high) in zip(eye, boxes, strict=True)) ** 0.5


def _is_outside(camera: CameraState, corners: list[Point], margin: float) -> bool:
    """Returns whether the rectangle around the projected corners misses the picture, or all are behind the camera.

    Corners before the near plane are mirrored, as in Cycles.
    """
    near, far = camera.clip
    left, right, bottom, top = camera.window
    is_orthographic = camera.type == CameraType.ORTHOGRAPHIC
    xs, ys, depths = [], [], []
    for corner in corners:
        x, y, z = _in_view(camera.matrix, corner)
        scale = 1.0 if is_orthographic else 1.0 / (z or 1e-30)
        depth = (z - near) * (1.0 if is_orthographic else far) / (far - near)
        x, y = (x * scale - left) / (right - left), (y * scale - bottom) / (top - bottom)
        xs.append(1.0 - x if depth < 0.0 else x)
        ys.append(1.0 - y if depth < 0.0 else y)
        depths.append(depth)
    if max(depths) < -margin:
        return True
    return any(min(values) >= 1.0 + margin or max(values) <= -margin for values in (xs, ys))


def _in_view(matrix: Sequence[float], point: Point) -> Point:
    """Returns a point relative to the camera: to the right, upwards and ahead. matrix: a placement without scale."""
    x, y, z = (sum(matrix[4 * axis + i] * (point[i] - matrix[12 + i]) for i in range(3)) for axis in range(3))
    return x, y, -z
