"""The views of a frame in stereo and multi-view. Each has a camera of its own, and everything else is shared."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from .camera import CameraState, camera_state
from .report import ExportError

Cameras = dict[str, Any]
"""Camera objects by view, with the view "" without multi-view. Markers may bind other cameras at other times."""

States = dict[str, CameraState]


def cameras_of(views: Iterable[str], engine: Any, scene: Any) -> Cameras:
    """Returns the cameras of the frame."""
    return {view: _camera(engine, scene).original for view in _activate_each(views, engine)}


def states_of(cameras: Cameras, depsgraph: Any, engine: Any, size: tuple[int, int]) -> States:
    """Returns the states of cameras in the depsgraph."""
    scene = depsgraph.scene_eval
    return {
        view: camera_state(cameras[view].evaluated_get(depsgraph), scene, *size, engine)
        for view in _activate_each(cameras, engine)
    }


def bound_camera(scene: Any, frame: int) -> Any:
    """Returns the camera that a marker binds to the scene at a frame, or None if no marker binds one.

    It is that of the last marker up to the frame, or else of the first marker.
    """
    binding = (marker for marker in scene.timeline_markers if marker.camera is not None)
    bound = sorted(binding, key=lambda marker: marker.frame)
    before = [marker for marker in bound if marker.frame <= frame]
    return (before[-1] if before else bound[0]).camera if bound else None


def _activate_each(views: Iterable[str], engine: Any) -> Iterator[str]:
    """Yields each view while it is the active view of the engine."""
    for view in views:
        if view:
            engine.active_view_set(view)
        yield view


def _camera(engine: Any, scene: Any) -> Any:
    found = getattr(engine, "camera_override", None) or scene.camera
    if found is None:
        raise ExportError(f"Scene '{scene.name}' has no camera")
    return found
