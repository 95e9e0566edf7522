"""The views of a frame: eyes, or whatever multi-view has. Each looks through a camera of its own; all else they share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from .camera import CameraState, camera_state
from .report import ExportError

Cameras = dict[str, Any]
"""Objects of the file by view; "" = there is no multi-view. Markers may bind others to the scene at other moments."""

States = dict[str, CameraState]


def cameras_of(views: Iterable[str], engine: Any, scene: Any) -> Cameras:
    """Those of the frame."""
    return {view: _camera(engine, scene).original for view in _each(views, engine)}


def states_of(cameras: Cameras, depsgraph: Any, engine: Any, size: tuple[int, int]) -> States:
    """As the depsgraph shows them."""
    scene = depsgraph.scene_eval
    return {view: camera_state(cameras[view].evaluated_get(depsgraph), scene, *size, engine) for view in _each(cameras, engine)}


def bound_camera(scene: Any, frame: int) -> Any:
    """The camera that a marker binds to the scene at a frame: that of the last marker before it, or else of the first one. None: no
    marker binds any."""
    bound = sorted((marker for marker in scene.timeline_markers if marker.camera is not None), key=lambda marker: marker.frame)
    before = [marker for marker in bound if marker.frame <= frame]
    return (before[-1] if before else bound[0]).camera if bound else None


def _each(views: Iterable[str], engine: Any) -> Iterator[str]:
    """In turn, when it is the engine's."""
    for view in views:
        if view:
            engine.active_view_set(view)
        yield view


def _camera(engine: Any, scene: Any) -> Any:
    found = getattr(engine, "camera_override", None) or scene.camera
    if found is None:
        raise ExportError(f"Scene '{scene.name}' has no camera")
    return found
