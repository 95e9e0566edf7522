"""Animations that continue from a frame store have the bits of uninterrupted ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images, recording
from support.animation import key

WIDTH, HEIGHT = 32, 18
Scene = bpy.types.Scene


@pytest.fixture
def square(scene: Scene) -> Scene:
    """Returns a scene with a square in a grey world, and twenty frames."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    recording.add(recording.grid(2), "Square")
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.frame_start, scene.frame_end = 1, 20
    scene.gradus.reconstruction, scene.gradus.samples = "L2", 2
    return scene


def animate(scene: Scene, folder: Path, first: int = 0, last: int = 0) -> None:
    if last:
        scene.frame_start, scene.frame_end = first, last
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)


def pictures(folder: Path) -> dict[int, np.ndarray]:
    return {int(path.stem.removeprefix("f_")): images.read(path)["Combined"] for path in sorted(folder.glob("f_*.exr"))}


def require_equal(found: dict[int, np.ndarray], whole: dict[int, np.ndarray], frames: range) -> None:
    differing = [frame for frame in frames if not np.array_equal(found[frame], whole[frame])]
    assert differing == []


# -------------------------------------------------------------------------------- what changes


def deform(_scene: Scene, _folder: Path) -> None:
    """Gives a mesh other positions in each frame."""
    square = bpy.data.objects["Square"]
    square.shape_key_add(name="Basis")
    shape = square.shape_key_add(name="Bent")
    shape.data[0].co.z += 1.0
    for frame, value in ((0, 0.0), (21, 1.0)):
        shape.value = value
        shape.keyframe_insert("value", frame=frame)


def show_a_film(_scene: Scene, folder: Path) -> None:
    """Gives a material another image in each frame."""
    for number in range(21):
        picture = images.oiio.ImageBuf(images.oiio.ImageSpec(2, 2, 3, "uint8"))
        images.oiio.ImageBufAlgo.fill(picture, (number / 21.0, 0.5, 0.2))
        assert picture.write(str(folder / f"film_{number:04d}.png"))
    square = bpy.data.objects["Square"]
    material = bpy.data.materials.new("Film")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.load(str(folder / "film_0000.png"))
    texture.image.source = "SEQUENCE"
    texture.image_user.frame_duration, texture.image_user.frame_start = 20, 1
    texture.image_user.use_auto_refresh = True
    links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    square.data.materials.append(material)


def let_objects_appear(_scene: Scene, _folder: Path) -> None:
    """Adds objects before and after the square in the order of the scene, of which some are visible for some frames
    only."""
    for name, first, last in (("A", 3, 9), ("Z", 5, 30), ("B", 12, 30)):
        material = bpy.data.materials.new(name)
        material.diffuse_color = (0.2, 0.4, 0.6, 1.0)
        found = recording.add(recording.grid(3), name)
        found.data.materials.append(material)
        found.scale = (0.3, 0.3, 0.3)
        found.location.z = 0.5
        for frame in range(31):
            found.hide_render = not first <= frame <= last
            found.keyframe_insert("hide_render", frame=frame)


def bind_other_cameras(scene: Scene, _folder: Path) -> None:
    """Binds cameras to markers at the frames 4 and 15."""
    first = scene.camera
    key(first, "location", {0: (-0.5, 0.0, 5.0), 21: (0.5, 0.0, 5.0)})
    second = recording.add_camera(type="ORTHO", ortho_scale=3.0)
    second.rotation_euler = (0.0, 1.0, 0.0)
    second.location = (5.0, 0.0, 3.0)
    for frame, camera in ((1, first), (4, second), (15, first)):
        scene.timeline_markers.new(f"cut {frame}", frame=frame).camera = camera


@pytest.mark.parametrize("persistent", [False, True])
@pytest.mark.parametrize("change", [deform, show_a_film, let_objects_appear, bind_other_cameras])
def test_c7_an_animation_goes_on_where_it_ended(
    square: Scene, tmp_path: Path, change: Callable[[Scene, Path], None], persistent: bool
) -> None:
    """Regression: keys depend on the order in which meshes, images and objects appear.

    Stored frames were refused as those of another scene.
    """
    whole, rest = tmp_path / "whole", tmp_path / "rest"
    for folder in (whole, rest):
        folder.mkdir()
    change(square, tmp_path)
    square.render.use_persistent_data = persistent
    square.gradus.frame_store = str(tmp_path / "store")
    animate(square, whole)
    square.render.use_overwrite = False
    expected = pictures(whole)
    for frame in range(1, 17):
        (rest / f"f_{frame:04d}.exr").write_bytes((whole / f"f_{frame:04d}.exr").read_bytes())
    animate(square, rest)
    assert not np.array_equal(expected[5], expected[16]), "the scene changes"
    require_equal(pictures(rest), expected, range(1, 21))


def test_c8_markers_with_other_cameras_are_shot_changes(square: Scene, tmp_path: Path) -> None:
    bind_other_cameras(square, tmp_path)
    square.view_layers[0].gradus.use_pass_gradients = True
    animate(square, tmp_path, 1, 6)
    passes = {frame: images.read(tmp_path / f"f_{frame:04d}.exr") for frame in range(1, 6)}
    corresponds = {frame: found["Gradient T Correspondence"][..., 2].any() for frame, found in passes.items()}
    assert corresponds == {1: True, 2: True, 3: False, 4: True, 5: True}


# -------------------------------------------------------------------------------- one store for several jobs


def test_c7_a_still_beside_an_animation_leaves_its_frames(
    square: Scene, render: Callable[..., images.Passes], tmp_path: Path
) -> None:
    """Regression: the file of the still replaced a half of a frame, which was then mixed with the still."""
    deform(square, tmp_path)
    square.gradus.frame_store = str(tmp_path / "store")
    before, after = tmp_path / "before", tmp_path / "after"
    animate(square, before, 1, 6)
    render(square, frame=3)
    animate(square, after, 1, 6)
    require_equal(pictures(after), pictures(before), range(1, 7))


def test_c7_two_steps_in_one_store_have_correspondences(
    square: Scene, lines: Callable[[], list[dict[str, Any]]], tmp_path: Path
) -> None:
    """With a frame step of two, frames replay the frame two before.

    Regression: half of the pairs had no correspondences.
    """
    deform(square, tmp_path)
    square.view_layers[0].gradus.use_pass_gradients = True
    square.gradus.frame_store = str(tmp_path / "store")
    square.frame_step = 2
    animate(square, tmp_path / "second", 1, 7)
    square.frame_step = 1
    both, whole = tmp_path / "both", tmp_path / "whole"
    animate(square, both, 1, 7)
    square.gradus.frame_store = str(tmp_path / "another store")
    animate(square, whole, 1, 7)
    require_equal(pictures(both), pictures(whole), range(1, 8))


def test_c7_parts_of_an_unchanged_range_equal_the_whole(square: Scene, tmp_path: Path) -> None:
    """The later range is rendered first, when it is not yet known that its frames equal those of the earlier range."""
    key(bpy.data.objects["Square"], "location", {6: (0.0, 0.0, 0.0), 9: (1.0, 0.0, 0.0)})
    parts, again, whole = (tmp_path / name for name in ("parts", "again", "whole"))
    square.gradus.frame_store = str(tmp_path / "store")
    for first, last in ((5, 8), (1, 4)):
        animate(square, parts, first, last)
    animate(square, again, 1, 8)
    square.gradus.frame_store = str(tmp_path / "another store")
    animate(square, whole, 1, 8)
    require_equal(pictures(again), pictures(whole), range(1, 9))


def test_c7_another_seed_samples_an_unchanged_range_again(square: Scene, tmp_path: Path) -> None:
    """Regression: the stored frame before the range was used, although its seed was another one."""
    square.gradus.frame_store = str(tmp_path / "store")
    animate(square, tmp_path / "old", 1, 4)
    found, expected = tmp_path / "found", tmp_path / "expected"
    square.gradus.seed = 7
    animate(square, found, 5, 8)
    square.gradus.frame_store = str(tmp_path / "another store")
    animate(square, expected, 5, 8)
    require_equal(pictures(found), pictures(expected), range(5, 9))
    assert not np.array_equal(pictures(found)[5], pictures(tmp_path / "old")[4])


def test_c7_an_unchanged_range_that_noise_ended_is_found_again(
    square: Scene, lines: Callable[[], list[dict[str, Any]]], tmp_path: Path
) -> None:
    """Regression: pixel blocks with little noise had fewer samples than requested, and the rerun was refused."""
    square.gradus.samples, square.gradus.noise_threshold = 256, 0.1
    square.gradus.frame_store = str(tmp_path / "store")
    for run in ("once", "again"):
        animate(square, tmp_path / run, 1, 4)
    require_equal(pictures(tmp_path / "again"), pictures(tmp_path / "once"), range(1, 5))
    assert [stats["stopped"] for stats in lines()] == ["noise", *["unchanged"] * 3, *["stored"] * 4]


def test_c7_an_unchanged_range_of_an_older_scene_is_not_mixed_in(square: Scene, tmp_path: Path) -> None:
    """Regression: new frames were considered equal to neighbouring old ones of the store."""
    store = tmp_path / "store"
    square.gradus.frame_store = str(store)
    animate(square, tmp_path / "old", 1, 6)
    square.camera.location.x += 0.3
    for frame in range(1, 4):
        for stored in list(store.rglob(f"f+{frame:07d}.*")):
            stored.unlink()
    found, expected = tmp_path / "found", tmp_path / "expected"
    animate(square, found, 1, 3)
    square.gradus.frame_store = str(tmp_path / "another store")
    animate(square, expected, 1, 3)
    require_equal(pictures(found), pictures(expected), range(1, 4))
