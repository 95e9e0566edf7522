"""Shots that are edited and rendered again into their frame store have the bits of a render into an empty store."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images, recording
from support.animation import key, step

WIDTH, HEIGHT = 32, 18
LAST = 13
Scene = bpy.types.Scene
Pictures = dict[int, np.ndarray]
Lines = Callable[[], list[dict[str, Any]]]


@pytest.fixture
def shot(scene: Scene, tmp_path: Path) -> Scene:
    """Returns a scene in which a square moves under a light, with a frame store."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    square = recording.add(recording.grid(2), "Square")
    key(square, "location", {0: (-1.0, 0.0, 0.0), 40: (1.0, 0.0, 0.0)})
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.frame_start, scene.frame_end = 1, LAST
    scene.gradus.reconstruction, scene.gradus.samples = "REGULARIZED", 4
    scene.gradus.frame_store = str(tmp_path / "store")
    return scene


@pytest.fixture(params=["REGULARIZED", "L2"])
def any_shot(shot: Scene, request: pytest.FixtureRequest) -> Scene:
    """Returns the same scene for each kind of reconstruction: one joins frames, the other solves windows."""
    shot.gradus.reconstruction = request.param
    return shot


def scale_square(frames: dict[int, float]) -> None:
    """Edits the shot: gives the square a size in each range of frames that begins at a key of `frames`."""
    step(bpy.data.objects["Square"], "scale", {frame: (value, value, 1.0) for frame, value in frames.items()})


def animate(scene: Scene, folder: Path, first: int = 1, last: int = LAST) -> Pictures:
    scene.frame_start, scene.frame_end = first, last
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    return {int(path.stem[2:]): images.read(path)["Combined"] for path in sorted(folder.glob("f_*.exr"))}


def in_new_store(scene: Scene, tmp_path: Path, first: int = 1, last: int = LAST) -> Pictures:
    """Renders the shot into an empty store, and returns to the store of the scene."""
    own, scene.gradus.frame_store = scene.gradus.frame_store, str(tmp_path / f"new store {first} {last}")
    pictures = animate(scene, tmp_path / f"new {first} {last}", first, last)
    scene.gradus.frame_store = own
    return pictures


def require_equal(found: Pictures, expected: Pictures, first: int = 1, last: int = LAST) -> None:
    frames = range(first, last + 1)
    assert [frame for frame in frames if not np.array_equal(found[frame], expected[frame])] == []


def sampled(lines: list[dict[str, Any]]) -> list[int]:
    """Returns the frames that were sampled, at least in part."""
    return [line["frame"] for line in lines if line["stopped"] != "stored"]


def warnings(lines: list[dict[str, Any]]) -> list[str]:
    """Returns the warnings about stored frames."""
    return [text for line in lines for text in line["warnings"] if "stored frame" in text]


def stored(scene: Scene, frame: int, kind: str) -> Path:
    return Path(scene.gradus.frame_store, "Scene", "ViewLayer", f"f{frame:+08d}.{kind}.exr")


# -------------------------------------------------------------------------------- edits


def test_c10_an_edited_shot_is_sampled_again_from_the_edit_on(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    """Regression: the frames before the edit were delivered as if the shot ended there, and the next one failed."""
    before = animate(any_shot, tmp_path / "before")
    scale_square({0: 1.0, 8: 0.5})
    found = animate(any_shot, tmp_path / "found")
    assert sampled(lines()[LAST:]) == list(range(8, LAST + 1))
    assert warnings(lines()) == [f"{LAST - 7} stored frames sampled again: 8 to {LAST} (another scene)"]
    require_equal(found, in_new_store(any_shot, tmp_path))
    if any_shot.gradus.reconstruction == "REGULARIZED":
        assert np.array_equal(found[1], before[1]), "it is joined with four frames on each side"
    assert not np.array_equal(found[7], before[7]), "its neighbours are new"


def test_c10_nothing_is_sampled_again_without_an_edit(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    require_equal(animate(any_shot, tmp_path / "once"), animate(any_shot, tmp_path / "again"))
    assert sampled(lines()[LAST:]) == [] == warnings(lines())


def test_c10_a_part_that_covers_the_edit_is_that_of_the_whole(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    """Frames beside the part are not stale, but the first one after it replays a frame that has changed."""
    animate(any_shot, tmp_path / "before")
    scale_square({0: 1.0, 7: 0.5, 10: 1.0})
    part = animate(any_shot, tmp_path / "part", 5, 9)
    assert sampled(lines()[LAST:]) == [7, 8, 9]
    assert [text.partition(":")[0] for text in warnings(lines())] == ["3 stored frames sampled again"]
    require_equal(part, in_new_store(any_shot, tmp_path), 5, 9)


def test_c10_stale_frames_beside_a_part_are_not_used(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    animate(any_shot, tmp_path / "before")
    scale_square({0: 1.0, 7: 0.5})
    part = animate(any_shot, tmp_path / "part", 5, 9)
    again, beside = warnings(lines())
    assert again == "3 stored frames sampled again: 7 to 9 (another scene)"
    assert beside == f"{LAST - 9} stored frames beside the rendered ones not used: 10 to {LAST} (another scene)"
    expected = in_new_store(any_shot, tmp_path, 1, 9)
    if any_shot.gradus.reconstruction == "REGULARIZED":
        require_equal(part, expected, 5, 9)
    assert all(np.allclose(part[frame], expected[frame], atol=0.03) for frame in range(5, 10)), "windows end at frame 9"
    # The rest of the shot makes the store whole.
    animate(any_shot, tmp_path / "rest", 10, LAST)
    require_equal(animate(any_shot, tmp_path / "all"), in_new_store(any_shot, tmp_path))


def test_c10_a_stale_frame_before_a_part_is_not_used(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    """Frame 4 was edited, so that the part is that of a shot that begins at frame 5."""
    animate(any_shot, tmp_path / "before")
    scale_square({0: 1.0, 4: 0.5, 5: 1.0})
    part = animate(any_shot, tmp_path / "part", 5, 9)
    assert warnings(lines()) == ["1 stored frame beside the rendered ones not used: 4 (another scene)"]
    require_equal(part, in_new_store(any_shot, tmp_path, 5, LAST), 5, 9)


@pytest.mark.parametrize("arguments", [["-s", "8", "-e", "8", "-a"], ["-f", "8"]], ids=["range", "single"])
def test_c10_one_frame_is_that_of_the_whole(
    any_shot: Scene, lines: Lines, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: list[str]
) -> None:
    """Regression: a single frame was rendered as a still."""
    animate(any_shot, tmp_path / "before")
    scale_square({0: 1.0, 8: 0.5, 9: 1.0})
    with monkeypatch.context() as patched:
        patched.setattr(sys, "argv", [sys.argv[0], *arguments, *sys.argv[1:]])
        one = animate(any_shot, tmp_path / "one", 8, 8)
    assert sampled(lines()[LAST:]) == [8]
    require_equal(one, in_new_store(any_shot, tmp_path), 8, 8)


def test_c10_missing_pictures_are_those_of_the_whole(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    """With Overwrite off, Blender asks for the missing pictures alone."""
    folder = tmp_path / "before"
    animate(any_shot, folder)
    scale_square({0: 1.0, 8: 0.5})
    for frame in (6, 7, 8, 9):
        (folder / f"f_{frame:04d}.exr").unlink()
    any_shot.render.use_overwrite = False
    found = animate(any_shot, folder)
    any_shot.render.use_overwrite = True
    assert [line["frame"] for line in lines()[LAST:]] == [6, 7, 8, 9]
    require_equal(found, in_new_store(any_shot, tmp_path), 6, 9)


# -------------------------------------------------------------------------------- settings


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [("seed", 3, "seed is 0, not 3"), ("max_bounces", 1, "max_bounces is"), ("samples", 8, "")],
)
def test_c10_other_settings_sample_the_shot_again(
    any_shot: Scene,
    lines: Lines,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    value: int,
    why: str,
) -> None:
    monkeypatch.setattr(sys, "argv", [*sys.argv, "--", "--gradus-net-samples", "8"])
    animate(any_shot, tmp_path / "before")
    setattr(any_shot.gradus, name, value)
    found = animate(any_shot, tmp_path / "found")
    assert sampled(lines()[LAST:]) == list(range(1, LAST + 1))
    expected = f"{LAST} stored frames sampled again: 1 to {LAST} (other settings: {why}"
    assert all(text.startswith(expected) for text in warnings(lines()))
    assert len(warnings(lines())) == (1 if why else 0), "more samples are added to those of the store"
    require_equal(found, in_new_store(any_shot, tmp_path))


def test_c10_another_size_samples_the_shot_again(any_shot: Scene, lines: Lines, tmp_path: Path) -> None:
    animate(any_shot, tmp_path / "before")
    any_shot.render.resolution_x = WIDTH + 8
    require_equal(animate(any_shot, tmp_path / "found"), in_new_store(any_shot, tmp_path))
    assert len(warnings(lines())) == 1


def test_c10_a_store_without_the_features_of_the_reconstruction_is_replaced(
    any_shot: Scene, lines: Lines, tmp_path: Path
) -> None:
    """Regression: the store was refused."""
    any_shot.gradus.reconstruction = "L2"
    animate(any_shot, tmp_path / "sampled", 1, 4)
    any_shot.gradus.reconstruction = "REGULARIZED"
    any_shot.gradus.integrator = "GRADIENT"
    require_equal(animate(any_shot, tmp_path / "again", 1, 4), in_new_store(any_shot, tmp_path, 1, 4), 1, 4)
    assert "without the features" in warnings(lines())[0]


# -------------------------------------------------------------------------------- files


def damage(path: Path) -> None:
    """Changes bytes in the middle of a file, which its header does not show."""
    content = bytearray(path.read_bytes())
    middle = len(content) * 3 // 4
    content[middle : middle + 16] = bytes(255 - byte for byte in content[middle : middle + 16])
    path.write_bytes(content)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path: Path) -> None:
    path.write_bytes(b"")


@pytest.mark.parametrize("kind", ["fresh", "replayed"])
@pytest.mark.parametrize("harm", [damage, cut, empty])
def test_c10_a_damaged_film_is_sampled_again(
    shot: Scene, lines: Lines, tmp_path: Path, kind: str, harm: Callable[[Path], None]
) -> None:
    """Regression: a damaged film ended the render."""
    once = animate(shot, tmp_path / "once")
    harm(stored(shot, 6, kind))
    require_equal(animate(shot, tmp_path / "again"), once)
    assert sampled(lines()[LAST:]) == [6]
    (warning,) = warnings(lines())
    assert warning.startswith("1 stored frame sampled again: 6 (cannot load film ")
    assert stored(shot, 6, kind).name in warning


def test_c10_a_damaged_film_beside_a_part_is_not_used(shot: Scene, lines: Lines, tmp_path: Path) -> None:
    animate(shot, tmp_path / "once")
    cut(stored(shot, 10, "fresh"))
    part = animate(shot, tmp_path / "part", 5, 9)
    assert len(warnings(lines())) == 1
    require_equal(part, in_new_store(shot, tmp_path, 1, 9), 5, 9)


def test_c10_a_kill_between_the_files_of_a_frame_leaves_nothing_stale(any_shot: Scene, tmp_path: Path) -> None:
    """The render after the edit had replaced one of the two files of frame 9 when it was killed."""
    animate(any_shot, tmp_path / "before")
    old = {frame: stored(any_shot, frame, "fresh").read_bytes() for frame in range(9, LAST + 1)}
    replayed = {frame: stored(any_shot, frame, "replayed").read_bytes() for frame in range(10, LAST + 1)}
    scale_square({0: 1.0, 7: 0.5})
    expected = animate(any_shot, tmp_path / "expected")
    for frame, content in old.items():
        stored(any_shot, frame, "fresh").write_bytes(content)
    for frame, content in replayed.items():
        stored(any_shot, frame, "replayed").write_bytes(content)
    require_equal(animate(any_shot, tmp_path / "again"), expected)
