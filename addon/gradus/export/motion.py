"""The moments around the rendered frame, for vectors: matrices, deforming positions and the camera one frame before and
after.

Stepping evaluates the same depsgraph in place, so whatever is needed of the rendered frame must have been read
before. Objects are found again by their instance key, never by name.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from .camera import CameraState, camera_state
from .collect import Entry, InstanceKey, collect
from .mesh import MeshArrays, corner_vertices, read_positions

OFFSETS = (-1, 1)
_BECOME_MESHES = frozenset({"CURVE", "SURFACE", "FONT", "META"})


@dataclass
class Moment:
    """What moved, at one other frame."""

    matrices: dict[InstanceKey, array] = field(default_factory=dict)
    positions: dict[InstanceKey, array] = field(default_factory=dict)
    camera: CameraState | None = None


def may_deform(entry: Entry) -> bool:
    """Whether the positions of an instance's mesh may differ between frames."""
    original = entry.object.original
    if original.type in _BECOME_MESHES:
        return True
    if any(modifier.show_render for modifier in original.modifiers):
        return True
    return getattr(original.data, "shape_keys", None) is not None


@contextmanager
def other_frames(scene: Any, engine: Any) -> Iterator[Callable[[int], None]]:
    """Gives a function that moves the evaluation by whole frames; returns to the frame in the end, whatever happens."""
    time = scene.frame_current + scene.frame_subframe
    current = 0

    def step(offset: int) -> None:
        nonlocal current
        whole = math.floor(time + offset)
        current = offset
        (engine or scene).frame_set(whole, subframe=time + offset - whole)

    try:
        yield step
    finally:
        if current != 0:
            step(0)


def read_moments(
    depsgraph: Any,
    engine: Any,
    deforming: dict[InstanceKey, MeshArrays],
    size: tuple[int, int],
    poll: Callable[[], None],
) -> list[Moment]:
    """The frames before and after. deforming: one instance for each mesh that may deform, with its arrays at the rendered frame."""
    moments = []
    with other_frames(depsgraph.scene, engine) as step:
        for offset in OFFSETS:
            poll()
            step(offset)
            moments.append(_read_moment(depsgraph, engine, deforming, size, poll))
    return moments


def _read_moment(
    depsgraph: Any, engine: Any, deforming: dict[InstanceKey, MeshArrays], size: tuple[int, int], poll: Callable[[], None]
) -> Moment:
    moment = Moment()
    collected = collect(depsgraph, poll)
    for entry in collected.surfaces:
        moment.matrices[entry.key] = collected.matrices[16 * entry.index : 16 * entry.index + 16]
        arrays = deforming.get(entry.key)
        if arrays is not None:
            poll()
            positions = _same_topology_positions(entry, arrays)
            if positions is not None:
                moment.positions[entry.key] = positions
    scene = depsgraph.scene_eval
    camera = getattr(engine, "camera_override", None) or scene.camera
    if camera is not None:
        moment.camera = camera_state(camera, scene, *size, engine)
    return moment


def _same_topology_positions(entry: Entry, arrays: MeshArrays) -> array | None:
    mesh = entry.data
    if len(mesh.vertices) * 3 != len(arrays.positions) or len(mesh.loops) != len(arrays.corner_vertices):
        return None
    if corner_vertices(mesh).tobytes() != arrays.corner_vertices.tobytes():
        return None
    return read_positions(mesh)


def mesh_motion(key: InstanceKey, arrays: MeshArrays, moments: list[Moment]) -> tuple[array, array] | None:
    """Positions before and after; None for a mesh at rest, or one whose topology changes."""
    found = [moment.positions.get(key) for moment in moments]
    if all(values is None for values in found):
        return None
    still = arrays.positions.tobytes()
    if all(values is None or values.tobytes() == still for values in found):
        return None
    previous, following = (values if values is not None else arrays.positions for values in found)
    return previous, following


def instance_motion(entries: list[Entry], matrices: array, moment: Moment) -> array:
    """Matrices of the entries at another moment; those that are not there stay where they are."""
    moved = array("f")
    for position, entry in enumerate(entries):
        moved.extend(moment.matrices.get(entry.key) or matrices[16 * position : 16 * position + 16])
    return moved
