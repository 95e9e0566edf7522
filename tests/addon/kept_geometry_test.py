"""Static geometry is built once for all frames of an animation.

Images are correct even if the prediction of motion is wrong.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import store
from gradus.export.may_move import MayMove
from support import images, recording, simulations
from support.animation import key, step

CELLS = 364  # so many triangles that the library keeps them instead of rebuilding them


@pytest.fixture
def room(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a large floor and a square above it that is predicted to move.

    It has neither motion blur nor vectors.
    """
    recording.add_camera(type="ORTHO", ortho_scale=6.0)
    recording.add(_floor(), "Room", (0, 0, -3))
    key(
        recording.add(recording.grid(1, size=0.5), "Predicted"),
        "location",
        {0: (-2.0, -1.0, 0.0), 10: (0.0, -1.0, 0.0)},
    )
    sun = recording.add(bpy.data.lights.new("Sun", "SUN"), "Sun")
    sun.rotation_euler = (0.6, 0.4, 0.0)
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    scene.frame_start, scene.frame_end = 1, 3
    scene.gradus.integrator, scene.gradus.samples = "PATH", 1
    return scene


@pytest.fixture
def each_frame() -> Iterator[Callable[[Callable[[int], None]], None]]:
    """Returns a function that adds a frame change handler, which changes the scene."""
    handlers = bpy.app.handlers.frame_change_pre
    before = list(handlers)
    yield lambda change: handlers.append(lambda scene, *_: change(scene.frame_current))
    handlers[:] = before


def _floor() -> bpy.types.Mesh:
    corners = np.stack(np.meshgrid(*[np.linspace(-5, 5, CELLS + 1)] * 2), axis=-1).reshape(-1, 2)
    first = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).ravel()
    faces = first[:, None] + np.array([0, 1, CELLS + 2, CELLS + 1])
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(x, y, 0.0) for x, y in corners.tolist()], [], faces.tolist())
    return mesh


def _animate(scene: bpy.types.Scene, folder: Path) -> list[np.ndarray]:
    folder.mkdir()
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    return [images.read(path)["Combined"] for path in sorted(folder.glob("f_*.exr"))]


def _square(name: str = "Square") -> bpy.types.Object:
    return recording.add(recording.grid(4, size=1.5), name, (1.0, 0.5, 0.0))


# -------------------------------------------------------------------------------- time


def test_frames_without_blur_and_vectors_keep_static_geometry(
    room: bpy.types.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seconds: list[float] = []

    def commit(session: store.Session, cancelled: Callable[[], bool], original: Any = store.Session.commit) -> None:
        start = time.process_time()
        original(session, cancelled)
        seconds.append(time.process_time() - start)

    monkeypatch.setattr(store.Session, "commit", commit)
    told = _animate(room, tmp_path / "told")
    kept = seconds[1:]
    seconds.clear()
    monkeypatch.setattr(MayMove, "__call__", lambda *_: False)
    untold = _animate(room, tmp_path / "untold")
    assert len(kept) == len(seconds) - 1 == 2
    assert sum(kept) < 0.5 * sum(seconds[1:])
    assert all(np.array_equal(a, b) for a, b in zip(told, untold, strict=True))
    assert not np.array_equal(told[0], told[1])


# -------------------------------------------------------------------------------- pictures


def _moved_by_a_handler(each_frame: Any) -> None:
    obj = _square()
    each_frame(lambda frame: setattr(obj, "location", (0.3 * frame, 0.5, 0.0)))


def _deformed_by_a_handler(each_frame: Any) -> None:
    mesh = _square().data

    def deform(frame: int) -> None:
        for vertex in mesh.vertices:
            vertex.co.z = 0.5 * math.sin(frame + 2.0 * vertex.co.x)
        mesh.update()

    each_frame(deform)


def _given_another_mesh_by_a_handler(each_frame: Any) -> None:
    obj, meshes = _square(), [recording.grid(2, size=0.5 * size) for size in range(1, 5)]
    each_frame(lambda frame: setattr(obj, "data", meshes[frame]))


def _shown_by_a_handler(each_frame: Any) -> None:
    obj = _square()
    each_frame(lambda frame: setattr(obj, "hide_render", frame != 2))


def _in_a_collection_shown_by_a_handler(each_frame: Any) -> None:
    obj, collection = _square(), bpy.data.collections.new("Shown")
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.collection.objects.unlink(obj)
    collection.objects.link(obj)
    each_frame(lambda frame: setattr(collection, "hide_render", frame != 2))


def _copied_by_a_handler(each_frame: Any) -> None:
    source = bpy.data.collections.new("Source")
    source.objects.link(bpy.data.objects.new("Inner", recording.grid(1, size=0.5)))

    def add(frame: int) -> None:
        for obj in [obj for obj in bpy.data.objects if obj.instance_type == "COLLECTION"]:
            bpy.data.objects.remove(obj)
        for place in range(frame):
            empty = recording.add(None, f"Copy {place}", (0.7 * place, 0.5, 0.0))
            empty.instance_type, empty.instance_collection = "COLLECTION", source

    each_frame(add)


def _in_an_array_along_another_object(_each_frame: Any) -> None:
    other, array = recording.add(None, "Other"), _square().modifiers.new("Array", "ARRAY")
    key(other, "location", {1: (0.0, 0.0, 0.0), 3: (0.0, 2.0, 0.0)})
    array.use_relative_offset, array.use_object_offset, array.offset_object = False, True, other


def _shown_by_keys(_each_frame: Any) -> None:
    step(_square(), "hide_render", {1: True, 2: False, 3: True})


def _shaped_by_keys(_each_frame: Any) -> None:
    obj = _square()
    obj.shape_key_add(name="Basis")
    for point in obj.shape_key_add(name="Other").data:
        point.co.x *= 0.2
    for frame in (1, 3):
        obj.data.shape_keys.key_blocks["Other"].value = 0.5 * (frame - 1)
        obj.data.shape_keys.key_blocks["Other"].keyframe_insert("value", frame=frame)


def _bent_by_an_armature(_each_frame: Any) -> None:
    bpy.ops.object.armature_add()
    armature, obj = bpy.context.object, _square()
    obj.parent, obj.parent_type = armature, "ARMATURE"
    obj.vertex_groups.new(name="Bone").add(list(range(10)), 1.0, "ADD")
    for frame in (1, 3):
        armature.pose.bones[0].location.x = 0.4 * frame
        armature.pose.bones[0].keyframe_insert("location", frame=frame)


def _falling(_each_frame: Any) -> None:
    simulations.rigid_body()
    bpy.data.objects["Falling"].location = (1.0, 0.5, 0.0)
    bpy.context.scene.gravity = (0.0, -200.0, 0.0)


def _strewn(_each_frame: Any) -> None:
    simulations.particles()
    bpy.data.objects["Emitter"].location = (1.0, 0.5, 0.0)
    bpy.context.scene.gravity = (0.0, -200.0, 0.0)


UNTOLD = [
    _moved_by_a_handler,
    _deformed_by_a_handler,
    _given_another_mesh_by_a_handler,
    _shown_by_a_handler,
    _in_a_collection_shown_by_a_handler,
    _copied_by_a_handler,
    _in_an_array_along_another_object,
]
TOLD = [_shown_by_keys, _shaped_by_keys, _bent_by_an_armature, _falling, _strewn]


@pytest.mark.parametrize("change", UNTOLD + TOLD)
def test_pictures_equal_those_of_frames_built_from_scratch(
    room: bpy.types.Scene,
    each_frame: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    change: Callable[[Any], None],
) -> None:
    change(each_frame)
    bpy.data.objects["Predicted"].animation_data_clear()
    step(bpy.data.objects["Predicted"], "location", {1: (-2.0, -1.0, 0.0)})  # predicted to move, but static
    kept = _animate(room, tmp_path / "kept")

    def sync(session: store.Session, *arguments: Any, original: Any = store.Session.sync) -> Any:
        session.free()
        session.__init__(session.library, session.device)
        return original(session, *arguments)

    monkeypatch.setattr(store.Session, "sync", sync)
    built = _animate(room, tmp_path / "built")
    assert len(kept) == len(built) == 3
    assert all(np.array_equal(a, b) for a, b in zip(kept, built, strict=True))
    assert not np.array_equal(kept[0], kept[1]) and not np.array_equal(kept[1], kept[2])
