"""The times around the rendered frame, for vectors and motion blur.

Vectors need one frame before and after, motion blur the times at which the shutter is open. Other times are evaluated
in the same depsgraph, so that everything of the rendered frame must be read first. Objects are identified by their
instance key, never by name.
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

NEIGHBORS = (-1.0, 1.0)
_BECOME_MESHES = frozenset({"CURVE", "SURFACE", "FONT", "META"})


Shape = tuple[int, Blur]
"""A mesh in the rendered frame: the address of its data, and its motion blur."""


@dataclass
class Deforming:
    """A mesh whose positions may differ between times."""

    shape: Shape
    arrays: MeshArrays  # at the rendered frame
    name: str  # that of its object
    by_velocity: bool = False  # its motion is known from the attribute `velocity`, even if its topology changes


@dataclass
class Moment:
    """Matrices, positions and cameras at another time."""

    matrices: dict[InstanceKey, array] = field(default_factory=dict)
    positions: dict[Shape, array] = field(default_factory=dict)
    other_topology: set[Shape] = field(default_factory=set)
    cameras: States = field(default_factory=dict)
    is_shot_change: bool = False  # a marker binds another camera


Moments = dict[float, Moment]
"""By time in frames, relative to the rendered frame, which is not included."""


@dataclass(frozen=True)
class MotionRequest:
    """The motion that an export reads."""

    vectors: bool = False
    shutter: Shutter | None = None

    def any(self) -> bool:
        return self.vectors or self.shutter is not None

    def times(self, blurs: Iterable[Blur]) -> list[float]:
        """Returns the times to evaluate in order, without the frame itself."""
        found = set(NEIGHBORS if self.vectors else ())
        if self.shutter is not None:
            for keys in {blur.keys for blur in blurs} - {0}:
                found.update(self.shutter.times(keys))
        return sorted(found - {0.0})


def may_deform(entry: Entry) -> bool:
    """Returns whether the positions of an instance's mesh may differ between times."""
    original = entry.object.original
    if original.type in _BECOME_MESHES or is_deformed_by_parent(original):
        return True
    if any(modifier.show_render for modifier in original.modifiers):
        return True
    return getattr(original.data, "shape_keys", None) is not None


def is_deformed_by_parent(obj: Any) -> bool:
    """Returns whether the parent of an object deforms it: an armature, a lattice or a curve."""
    return obj.parent is not None and obj.parent_type in ("ARMATURE", "LATTICE")  # curves use the type ARMATURE


@contextmanager
def other_frames(scene: Any, engine: Any) -> Iterator[Callable[[float], None]]:
    """Yields a function that moves the evaluation to a time relative to the frame.

    At exit, the evaluation returns to the frame.
    """
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
    """Evaluates the times in order. `deforming` has all instances, `cameras` are those of the frame."""
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
            moments[time].is_shot_change = bound_camera(scene, math.floor(now + time)) != bound
    return moments


def _read_moment(depsgraph: Any, deforming: dict[InstanceKey, Deforming], poll: Callable[[], None]) -> Moment:
    moment = Moment()
    collected = collect(depsgraph, poll)
    tried: set[tuple[Shape, int]] = set()
    for entry in collected.surfaces:
        moment.matrices[entry.key] = collected.matrices[16 * entry.index : 16 * entry.index + 16]
        found = deforming.get(entry.key)
        if found is None or found.shape in moment.positions or (found.shape, entry.data_address) in tried:
            continue
        poll()
        tried.add((found.shape, entry.data_address))
        positions = _same_topology_positions(entry, found.arrays)
        if positions is not None:
            moment.positions[found.shape] = positions
    moment.other_topology = {shape for shape, _ in tried} - moment.positions.keys()
    return moment


def _same_topology_positions(entry: Entry, arrays: MeshArrays) -> array | None:
    """Returns the positions of a mesh at another time, or None if its topology differs."""
    mesh = entry.data
    if len(mesh.vertices) * 3 != len(arrays.positions) or len(mesh.loops) != len(arrays.corner_vertices):
        return None
    if corner_vertices(mesh).tobytes() != arrays.corner_vertices.tobytes():
        return None
    return read_positions(mesh)


def _moved_by_velocity(mesh: Any, arrays: MeshArrays, seconds: list[float]) -> list[array] | None:
    """Returns the positions after some times in seconds, from the attribute `velocity` in metres per second.

    Baked simulations and caches have this attribute, because their topology may change from frame to frame. Returns
    None without it.
    """
    velocity = mesh.attributes.get("velocity")
    if velocity is None or velocity.domain != "POINT" or velocity.data_type != "FLOAT_VECTOR":
        return None
    import numpy as np  # imported late, because few scenes have velocities and the import is slow

    values = np.zeros(len(velocity.data) * 3, dtype=np.float32)
    velocity.data.foreach_get("vector", values)
    if not values.any():
        return None
    now = np.frombuffer(arrays.positions, dtype=np.float32)
    return [array("f", (now + values * np.float32(time)).tobytes()) for time in seconds]


# ------------------------------------------------------------------------------------------------ vectors


def mesh_motion(deforming: Deforming, moments: Moments) -> tuple[array, array] | None:
    """Returns the positions before and after, or None for a mesh that is static or changes its topology."""
    arrays = deforming.arrays
    found = [moments[time].positions.get(deforming.shape) for time in NEIGHBORS]
    if all(values is None for values in found):
        return None
    current = arrays.positions.tobytes()
    if all(values is None or values.tobytes() == current for values in found):
        return None
    previous, following = (values if values is not None else arrays.positions for values in found)
    return previous, following


def velocity_motion(mesh: Any, arrays: MeshArrays, frames_per_second: float) -> tuple[array, array] | None:
    """Returns the positions before and after from the attribute `velocity`, as in Cycles, or None without it."""
    moved = _moved_by_velocity(mesh, arrays, [time / frames_per_second for time in NEIGHBORS])
    return None if moved is None else (moved[0], moved[1])


_NOWHERE = array("f", [math.nan] * 16)


def instance_motion(entries: list[Entry], moment: Moment, is_replaced: Callable[[Entry], bool]) -> array:
    """Returns the matrices of instances at another time, NaN for those that do not exist or are replaced."""
    moved = array("f")
    for entry in entries:
        found = moment.matrices.get(entry.key)
        moved.extend(_NOWHERE if found is None or is_replaced(entry) else found)
    return moved


def camera_at(view: str, moment: Moment) -> CameraState:
    """Returns the camera of a view. After a shot change its matrix is NaN."""
    state = moment.cameras[view]
    return replace(state, matrix=tuple(_NOWHERE)) if moment.is_shot_change else state


# ------------------------------------------------------------------------------------------------ motion blur


def _keys(times: list[float], now: Any, at: Callable[[float], Any]) -> list[Any] | None:
    """Returns the values at some times, or None if one is missing or all equal `now`."""
    found = [now if time == 0.0 else at(time) for time in times]
    if any(value is None for value in found) or all(value == now for value in found):
        return None
    return found


def mesh_blur(deforming: Deforming, shutter: Shutter, moments: Moments) -> array | None:
    """Returns the positions at the time keys of a mesh, joined, or None if it is static or changes its topology."""
    _, blur = deforming.shape
    if not blur.keys or not blur.deform:
        return None
    shape, now = deforming.shape, deforming.arrays.positions
    found = _keys(shutter.times(blur.keys), now, lambda time: moments[time].positions.get(shape))
    return None if found is None else _joined(found)


def changes_topology(deforming: Deforming, shutter: Shutter, moments: Moments) -> bool:
    """Returns whether a mesh with deformation blur changes its topology while the shutter is open."""
    _, blur = deforming.shape
    times = shutter.times(blur.keys) if blur.deform else ()
    return any(deforming.shape in moments[time].other_topology for time in times if time != 0.0)


def velocity_blur(
    mesh: Any, arrays: MeshArrays, blur: Blur, shutter: Shutter, frames_per_second: float
) -> array | None:
    """Returns the positions at opening and closing from the attribute `velocity`, or None without it."""
    if not blur.keys or not blur.deform:
        return None
    moved = _moved_by_velocity(mesh, arrays, [time / frames_per_second for time in (shutter.open, shutter.close)])
    return None if moved is None else _joined(moved)


@dataclass
class InstanceBlur:
    """Matrices of all moving instances, one after another."""

    first: array = field(default_factory=lambda: array("I"))
    count: array = field(default_factory=lambda: array("I"))
    matrices: array = field(default_factory=lambda: array("f"))


def instance_blur(entries: list[Entry], matrices: array, shutter: Shutter, moments: Moments) -> InstanceBlur | None:
    """Returns the matrices of moving instances while the shutter is open, or None if nothing moves."""
    result = InstanceBlur()
    for position, entry in enumerate(entries):
        keys = None
        if entry.blur.keys:
            now = matrices[16 * position : 16 * position + 16]
            times = shutter.times(entry.blur.keys)
            keys = _keys(times, now, lambda time, key=entry.key: moments[time].matrices.get(key))
        result.first.append(len(result.matrices) // 16)
        result.count.append(len(keys or ()))
        for matrix in keys or ():
            result.matrices.extend(matrix)
    return result if result.matrices else None


def camera_blur(view: str, camera: Any, now: CameraState, shutter: Shutter, moments: Moments) -> list[CameraState]:
    """Returns the camera of a view at its time keys, or [] if it is static."""
    blur = blur_of(camera)
    if not blur.keys:
        return []
    return _keys(shutter.times(blur.keys), now, lambda time: moments[time].cameras[view]) or []


def _joined(parts: list[array]) -> array:
    whole = array("f")
    for part in parts:
        whole.extend(part)
    return whole
