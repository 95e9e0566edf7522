"""Simulations that are not baked, in rendered animations, frame by frame and ahead of their delivery: what is exported of a frame is what
stepping the scene to it gives."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from gradus import simulation
from support import images, recording, simulations
from support.exports import Exports

LAST = 8
TOLERANCE = 2e-4  # particles go through caches of less precision


@pytest.fixture
def exports(monkeypatch: pytest.MonkeyPatch) -> Exports:
    return Exports(monkeypatch)


def new_scene(kind: str, first: int = 1, last: int = LAST, temporal: bool = False) -> bpy.types.Scene:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    recording.add_camera(type="ORTHO", ortho_scale=20.0)
    scene.frame_start, scene.frame_end = 1, 50  # caches take their range from the scene's
    simulations.KINDS[kind]()
    scene.frame_start, scene.frame_end = first, last
    scene.render.resolution_x, scene.render.resolution_y = 16, 9
    scene.gradus.samples, scene.gradus.reconstruction, scene.gradus.use_temporal = 2, "L2", temporal
    return scene


def check(kind: str, found: list[tuple[int, simulations.Places]], frames: range, starts_at: int = 1) -> None:
    truth = simulations.in_order(new_scene(kind, starts_at), starts_at, LAST)
    assert [frame for frame, _ in found] == list(frames), "each frame is exported once, in order"
    for frame, places in found:
        assert set(places) == set(truth[frame]), frame
        for name, place in places.items():
            assert place == pytest.approx(truth[frame][name], abs=TOLERANCE), (frame, name)
    moving = {name for name in truth[LAST] if truth[LAST][name] != pytest.approx(truth[starts_at].get(name, ()), abs=TOLERANCE)}
    assert moving, "the scene simulates something"


def render(scene: bpy.types.Scene, folder: Path) -> None:
    images.use_exr(scene, folder / "####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)


@pytest.fixture(params=simulations.KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    if not simulations.exists(request.param):
        pytest.skip("this Blender has none")
    return request.param


@pytest.fixture(params=[False, True], ids=["frame by frame", "ahead"])
def temporal(request: pytest.FixtureRequest) -> bool:
    return request.param


def test_c6_a_simulation_is_that_of_the_scene_stepped_in_order(kind: str, temporal: bool, exports: Exports, tmp_path: Path) -> None:
    render(new_scene(kind, temporal=temporal), tmp_path)
    check(kind, exports.of["ViewLayer"], range(1, LAST + 1))


def test_c6_a_later_first_frame_and_persistent_data_change_nothing(kind: str, temporal: bool, exports: Exports, tmp_path: Path) -> None:
    scene = new_scene(kind, first=4, temporal=temporal)
    scene.render.use_persistent_data = True
    render(scene, tmp_path)
    check(kind, exports.of["ViewLayer"], range(4, LAST + 1), starts_at=4 if kind == "simulation zone" else 1)


def test_c6_layers_and_frames_around_for_vectors_change_nothing(kind: str, temporal: bool, exports: Exports, tmp_path: Path) -> None:
    scene = new_scene(kind, temporal=temporal)
    scene.gradus.window_size, scene.gradus.window_overlap = 4, 2  # so that frames are looked for ahead more than once
    scene.view_layers.new("Second")
    for layer in scene.view_layers:
        layer.use_pass_vector = True
    render(scene, tmp_path)
    found = dict(exports.of)
    for name in ("ViewLayer", "Second"):
        check(kind, found[name], range(1, LAST + 1))


def test_caches_are_the_users_again_after_the_render(exports: Exports, tmp_path: Path) -> None:
    scene = new_scene("cloth", last=3)
    render(scene, tmp_path)
    cache = bpy.data.objects["Cloth"].modifiers[0].point_cache
    assert not cache.is_baked
    assert scene.frame_current == 1


def test_a_baked_simulation_is_left_alone(tmp_path: Path) -> None:
    scene = new_scene("cloth", last=3)
    cache = bpy.data.objects["Cloth"].modifiers[0].point_cache
    cache.frame_end = 3
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.bake(bake=True)
    assert simulation.Simulations(scene).names == []
    render(scene, tmp_path)
    assert cache.is_baked
