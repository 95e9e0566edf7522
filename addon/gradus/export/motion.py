"""The moments around the rendered frame: for vectors one frame before and after, for motion blur those at which the shutter is open.

Stepping evaluates the same depsgraph in place, so whatever is needed of the rendered frame must have been read
before. Objects are found again by their instance key, never by name.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from .camera import CameraState
from .collect import Entry, InstanceKey, collect
from .mesh import MeshArrays, corner_vertices, read_positions
from .shutter import Blur, Shutter, blur_of
from .views import Cameras, States, bound_camera, states_of

AROUND = (-1.0, 1.0)
_BECOME_MESHES = frozenset({"CURVE", "SURFACE", "FONT", "META"})


Shape = tuple[int, Blur]
"""A mesh as it is shown in the rendered frame: its place, and how it is blurred."""


@dataclass
class Deforming:
    """A mesh whose positions may differ between moments. Any of its instances shows it."""

    shape: Shape
    arrays: MeshArrays  # at the rendered frame
    name: str  # of the object that it belongs to
    by_velocity: bool = False  # its motion is known, whatever its topology at other moments


@dataclass
class Moment:
    """What moved, at another time."""

    matrices: dict[InstanceKey, array] = field(default_factory=dict)
    positions: dict[Shape, array] = field(default_factory=dict)
    other_topology: set[Shape] = field(default_factory=set)
    cameras: States = field(default_factory=dict)
    is_cut: bool = False  # seen by another camera, which a marker binds


Moments = dict[float, Moment]
"""By frames relative to the one rendered, which is not among them."""


@dataclass(frozen=True)
class Wanted:
    """Which motion an export is to read."""

    vectors: bool = False
    shutter: Shutter | None = None

    def any(self) -> bool:
        return self.vectors or self.shutter is not None

    def times(self, blurs: Iterable[Blur]) -> list[float]:
        """In order, without the frame itself."""
        found = set(AROUND if self.vectors else ())
        if self.shutter is not None:
            for keys in {blur.keys for blur in blurs} - {0}:
                found.update(self.shutter.times(keys))
        return sorted(found - {0.0})


def may_deform(entry: Entry) -> bool:
    """Whether the positions of an instance's mesh may differ between moments."""
    original = entry.object.original
    if original.type in _BECOME_MESHES or is_deformed_by_parent(original):
        return True
    if any(modifier.show_render for modifier in original.modifiers):
        return True
    return getattr(original.data, "shape_keys", None) is not None


def is_deformed_by_parent(obj: Any) -> bool:
    """As a modifier of an armature, a lattice or a curve does, which is not among the object's own."""
    return obj.parent is not None and obj.parent_type in ("ARMATURE", "LATTICE")  # a curve's reads as the first


@contextmanager
def other_frames(scene: Any, engine: Any) -> Iterator[Callable[[float], None]]:
    """Gives a function that moves the evaluation by frames; returns to the frame in the end, whatever happens."""
    time = scene.frame_current + scene.frame_subframe
    current = 0.0

    def step(offset: float) -> None:
        nonlocal current
        whole = math.floor(time + offset)
        current = offset
        (engine or scene).frame_set(whole, subframe=time + offset - whole)

    try:
        yield step
    finally:
        if current != 0.0:
            step(0.0)


def read_moments(
    depsgraph: Any,
    engine: Any,
    times: list[float],
    deforming: dict[InstanceKey, Deforming],
    cameras: Cameras,
    size: tuple[int, int],
    poll: Callable[[], None],
) -> Moments:
    """Visits the times in order. deforming: by all instances. cameras: the frame's."""
    moments: Moments = {}
    scene = depsgraph.scene.original
    now = scene.frame_current
    bound = bound_camera(scene, now)
    with other_frames(depsgraph.scene, engine) as step:
        for time in times:
            poll()
            step(time)
            moments[time] = _read_moment(depsgraph, deforming, poll)
            moments[time].cameras = states_of(cameras, depsgraph, engine, size)
            moments[time].is_cut = bound_camera(scene, math.floor(now + time)) != bound
    return moments


def _read_moment(depsgraph: Any, deforming: dict[InstanceKey, Deforming], poll: Callable[[], None]) -> Moment:
    moment = Moment()
    collected = collect(depsgraph, poll)
    tried: set[tuple[Shape, int]] = set()
    for entry in collected.surfaces:
        moment.matrices[entry.key] = collected.matrices[16 * entry.index : 16 * entry.index + 16]
        found = deforming.get(entry.key)
        if found is None or found.shape in moment.positions or (found.shape, entry.place) in tried:
            continue
        poll()
        tried.add((found.shape, entry.place))
        positions = _same_topology_positions(entry, found.arrays)
        if positions is not None:
            moment.positions[found.shape] = positions
    moment.other_topology = {shape for shape, _ in tried} - moment.positions.keys()
    return moment


def _same_topology_positions(entry: Entry, arrays: MeshArrays) -> array | None:
    mesh = entry.data
    if len(mesh.vertices) * 3 != len(arrays.positions) or len(mesh.loops) != len(arrays.corner_vertices):
        return None
    if corner_vertices(mesh).tobytes() != arrays.corner_vertices.tobytes():
        return None
    return read_positions(mesh)


def _moved_by_velocity(mesh: Any, arrays: MeshArrays, seconds: list[float]) -> list[array] | None:
    """Positions some seconds on, by the attribute `velocity` (metres per second) of baked simulations and caches, whose topology may change
    from frame to frame; None without one."""
    velocity = mesh.attributes.get("velocity")
    if velocity is None or velocity.domain != "POINT" or velocity.data_type != "FLOAT_VECTOR":
        return None
    import numpy as np  # Blender's own; its import takes a while, and few scenes have velocities

    values = np.zeros(len(velocity.data) * 3, dtype=np.float32)
    velocity.data.foreach_get("vector", values)
    if not values.any():
        return None
    now = np.frombuffer(arrays.positions, dtype=np.float32)
    return [array("f", (now + values * np.float32(time)).tobytes()) for time in seconds]


# ------------------------------------------------------------------------------------------------ for vectors


def mesh_motion(deforming: Deforming, moments: Moments) -> tuple[array, array] | None:
    """Positions before and after; None for a mesh at rest, or one whose topology changes."""
    arrays = deforming.arrays
    found = [moments[time].positions.get(deforming.shape) for time in AROUND]
    if all(values is None for values in found):
        return None
    still = arrays.positions.tobytes()
    if all(values is None or values.tobytes() == still for values in found):
        return None
    previous, following = (values if values is not None else arrays.positions for values in found)
    return previous, following


def velocity_motion(mesh: Any, arrays: MeshArrays, frames_per_second: float) -> tuple[array, array] | None:
    """Positions before and after by the mesh's velocity, as Cycles has them in pass Vector; None without one."""
    moved = _moved_by_velocity(mesh, arrays, [time / frames_per_second for time in AROUND])
    return None if moved is None else (moved[0], moved[1])


_NOWHERE = array("f", [math.nan] * 16)


def instance_motion(entries: list[Entry], moment: Moment, gone: Callable[[Entry], bool]) -> array:
    """Matrices of the entries at another moment, not a number where they are not there. gone: whether one is there as another mesh."""
    moved = array("f")
    for entry in entries:
        found = moment.matrices.get(entry.key)
        moved.extend(_NOWHERE if found is None or gone(entry) else found)
    return moved


def camera_at(view: str, moment: Moment) -> CameraState:
    """A view's camera; over a cut it is nowhere."""
    state = moment.cameras[view]
    return replace(state, matrix=tuple(_NOWHERE)) if moment.is_cut else state


# ------------------------------------------------------------------------------------------------ for motion blur


def _keys(times: list[float], now: Any, at: Callable[[float], Any]) -> list[Any] | None:
    """What is there at the times; None where something is missing, or all is as it is now."""
    found = [now if time == 0.0 else at(time) for time in times]
    if any(value is None for value in found) or all(value == now for value in found):
        return None
    return found


def mesh_blur(deforming: Deforming, shutter: Shutter, moments: Moments) -> array | None:
    """Positions at the mesh's keys, one after the other; None for a mesh that stands still or whose topology changes."""
    _, blur = deforming.shape
    if not blur.keys or not blur.deform:
        return None
    found = _keys(shutter.times(blur.keys), deforming.arrays.positions, lambda time: moments[time].positions.get(deforming.shape))
    return None if found is None else _joined(found)


def changes_topology(deforming: Deforming, shutter: Shutter, moments: Moments) -> bool:
    """While the shutter is open, of a mesh that would be blurred."""
    _, blur = deforming.shape
    times = shutter.times(blur.keys) if blur.deform else ()
    return any(deforming.shape in moments[time].other_topology for time in times if time != 0.0)


def velocity_blur(mesh: Any, arrays: MeshArrays, blur: Blur, shutter: Shutter, frames_per_second: float) -> array | None:
    """Positions at opening and closing by the mesh's velocity; None without one."""
    if not blur.keys or not blur.deform:
        return None
    moved = _moved_by_velocity(mesh, arrays, [time / frames_per_second for time in (shutter.open, shutter.close)])
    return None if moved is None else _joined(moved)


@dataclass
class InstanceBlur:
    """Matrices of those instances that move, one after the other."""

    first: array = field(default_factory=lambda: array("I"))
    count: array = field(default_factory=lambda: array("I"))
    matrices: array = field(default_factory=lambda: array("f"))


def instance_blur(entries: list[Entry], matrices: array, shutter: Shutter, moments: Moments) -> InstanceBlur | None:
    """None where nothing moves."""
    result = InstanceBlur()
    for position, entry in enumerate(entries):
        keys = None
        if entry.blur.keys:
            now = matrices[16 * position : 16 * position + 16]
            keys = _keys(shutter.times(entry.blur.keys), now, lambda time, key=entry.key: moments[time].matrices.get(key))
        result.first.append(len(result.matrices) // 16)
        result.count.append(len(keys or ()))
        for matrix in keys or ():
            result.matrices.extend(matrix)
    return result if result.matrices else None


def camera_blur(view: str, camera: Any, now: CameraState, shutter: Shutter, moments: Moments) -> list[CameraState]:
    """A view's camera at its keys; [] where it rests."""
    blur = blur_of(camera)
    if not blur.keys:
        return []
    return _keys(shutter.times(blur.keys), now, lambda time: moments[time].cameras[view]) or []


def _joined(parts: list[array]) -> array:
    whole = array("f")
    for part in parts:
        whole.extend(part)
    return whole
