"""Animations whose frames are sampled ahead: their results in Blender, and their errors."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import animation, native, renderer, store
from gradus.export import ExportError
from support import images, recording, simulations
from support.animation import key, step
from support.exports import Exports

WIDTH, HEIGHT = 32, 18


@pytest.fixture
def moving(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a square that moves in a grey world, and ten frames."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    key(recording.add(recording.grid(2), "Moving"), "location", {0: (-1.0, 0.0, 0.0), 20: (1.0, 0.0, 0.0)})
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.frame_start, scene.frame_end = 1, 10
    scene.gradus.reconstruction, scene.gradus.samples = "L2", 4
    scene.view_layers[0].gradus.use_pass_gradients = True
    return scene


def animate(scene: bpy.types.Scene, folder: Path) -> None:
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)


def frames_in(folder: Path) -> list[int]:
    return sorted(int(path.stem.removeprefix("f_")) for path in folder.glob("f_*.exr"))


def combined(folder: Path, frame: int) -> np.ndarray:
    return images.read(folder / f"f_{frame:04d}.exr")["Combined"]


def require_nothing_kept() -> None:
    assert animation._running == {}


# -------------------------------------------------------------------------------- every frame


@pytest.mark.parametrize("persistent", [False, True])
def test_c3_every_frame_is_delivered_and_exported_once(
    moving: bpy.types.Scene, exports: Exports, lines: Any, tmp_path: Path, persistent: bool
) -> None:
    moving.frame_end = 17
    moving.render.use_persistent_data = persistent
    animate(moving, tmp_path)
    assert frames_in(tmp_path) == exports.frames() == [line["frame"] for line in lines()] == list(range(1, 18))
    pictures = [combined(tmp_path, frame) for frame in range(1, 18)]
    assert all(np.isfinite(picture).all() for picture in pictures)
    assert all(not np.array_equal(a, b) for a, b in zip(pictures, pictures[1:], strict=False))
    places = [places["Moving [0]"][0] for _, places in exports.of["ViewLayer"]]
    assert np.allclose(np.diff(places), 0.1, atol=1e-5), "each is the square where it is in its frame"
    require_nothing_kept()


@pytest.mark.parametrize(("first", "last", "step"), [(7, 16, 3), (7, 15, 3), (0, 4, 1), (9, 11, 2)])
def test_c3_any_range_and_step(
    moving: bpy.types.Scene, exports: Exports, lines: Any, tmp_path: Path, first: int, last: int, step: int
) -> None:
    moving.frame_start, moving.frame_end, moving.frame_step = first, last, step
    animate(moving, tmp_path)
    assert frames_in(tmp_path) == exports.frames() == list(range(first, last + 1, step))
    assert all(line["samples_replayed"] == 2 for line in lines())


def test_c2_a_job_of_one_frame_is_a_still(
    moving: bpy.types.Scene, render: Callable[..., images.Passes], tmp_path: Path
) -> None:
    still = render(moving, frame=5)["Combined"]
    moving.frame_start = moving.frame_end = 5
    animate(moving, tmp_path)
    assert np.array_equal(combined(tmp_path, 5), still)


def test_c2_without_temporal_all_frames_are_stills(
    moving: bpy.types.Scene, render: Callable[..., images.Passes], tmp_path: Path
) -> None:
    still = render(moving, frame=5)["Combined"]
    moving.gradus.use_temporal = False
    moving.frame_end = 6
    animate(moving, tmp_path)
    assert np.array_equal(combined(tmp_path, 5), still)
    plan = store.summaries["Scene", "ViewLayer"]["plan"]
    assert plan["frame_by_frame"] == "temporal is off"


def test_a_small_window_limits_its_overlap(moving: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: windows of fewer than ten frames ended in an error, unless the overlap was lowered, too."""
    moving.frame_end = 4
    for size in (2, 3, 9):
        moving.gradus.window_size = size
        animate(moving, tmp_path / str(size))
        assert frames_in(tmp_path / str(size)) == [1, 2, 3, 4]


def test_differences_over_time_follow_the_surface(moving: bpy.types.Scene, tmp_path: Path) -> None:
    moving.frame_end = 3
    animate(moving, tmp_path)
    passes = [images.read(tmp_path / f"f_{frame:04d}.exr") for frame in (1, 3)]
    correspondences = passes[0]["Gradient T Correspondence"]
    found = correspondences[..., 2] == 1.0
    moves = 0.1 * WIDTH / 4.0  # pixels per frame, so that correspondences are exact
    assert found.mean() > 0.8
    assert set(np.unique(correspondences[found][:, 0])) <= {0.0, np.round(moves)}
    assert (correspondences[found][:, 0] == np.round(moves)).any()
    assert not passes[1]["Gradient T"].any(), "the last frame has none after it"


def test_c6_correspondences_remain_when_other_objects_appear_and_are_renamed(
    moving: bpy.types.Scene, exports: Exports, tmp_path: Path
) -> None:
    """The square is the last object: the number of objects before it and its name change from frame to frame."""
    square = bpy.data.objects["Moving"]
    guest = recording.add(recording.grid(1, 0.5, name="Guest"), "Guest", (1.5, 0.0, 0.0))
    row = recording.add(recording.grid(1, 0.2, name="Row"), "Row", (0.0, 0.0, -1.0))  # behind the square
    for frame in range(1, 5):
        guest.hide_render = frame == 2
        guest.keyframe_insert("hide_render", frame=frame)
    copies = row.modifiers.new("Copies", "ARRAY")
    key(copies, "count", {1: 1, 4: 4})
    part = recording.add(recording.grid(1, 0.1, name="Part"), "Part")
    part.parent, row.instance_type = row, "VERTS"
    moving.collection.objects.unlink(square)
    moving.collection.objects.link(square)
    exports.before = lambda frame: setattr(square, "name", f"Name {frame}")
    moving.frame_end = 4
    animate(moving, tmp_path)
    files = {frame: tmp_path / f"f_{frame:04d}.exr" for frame in range(1, 5)}
    correspondences = {frame: images.read(file)["Gradient T Correspondence"] for frame, file in files.items()}
    on_square, on_guest = (HEIGHT // 2, WIDTH // 4), (HEIGHT // 2, 28)
    assert all(correspondences[frame][on_square][2] == 1.0 for frame in (1, 2, 3)), "it stays"
    assert correspondences[1][on_guest][2] == 0.0, "it goes"
    assert correspondences[2][on_guest][2] == 0.0, "hidden pixels have no correspondence where the row appears"
    assert correspondences[3][on_guest][2] == 1.0, "it stays"
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    for found in correspondences.values():
        x, y = columns + found[..., 0], rows - found[..., 1]
        assert ((x >= 0) & (x < WIDTH) & (y >= 0) & (y < HEIGHT)).all(), "no correspondence leads out of the picture"


def test_i9_the_files_of_an_animation_say_how_they_were_made(moving: bpy.types.Scene, tmp_path: Path) -> None:
    moving.frame_end = 3
    moving.gradus.seed = 7
    animate(moving, tmp_path)
    for frame in (1, 2, 3):
        spec = images.oiio.ImageInput.open(str(tmp_path / f"f_{frame:04d}.exr")).spec()
        found = {
            name: spec.getattribute(f"gradus.{name}") for name in ("integrator", "reconstruction", "samples", "seed")
        }
        assert found == {"integrator": "gradient", "reconstruction": "l2", "samples": "4.0", "seed": "7"}
        assert re.match(r"\d+\.\d+\.\d+", spec.getattribute("gradus.version"))


def test_samples_are_those_of_the_frames_own_settings(moving: bpy.types.Scene, lines: Any, tmp_path: Path) -> None:
    for frame, samples in ((4, 4), (5, 8)):
        moving.gradus.samples = samples
        moving.keyframe_insert("gradus.samples", frame=frame)
    moving.frame_end = 6
    animate(moving, tmp_path)
    assert [line["samples"] for line in lines()] == [4, 4, 4, 4, 8, 8]


def test_i8_unchanged_frames_are_sampled_once(moving: bpy.types.Scene, lines: Any, tmp_path: Path) -> None:
    bpy.data.objects["Moving"].animation_data_clear()
    animate(moving, tmp_path)
    assert [line["stopped"] for line in lines()] == ["samples", *["unchanged"] * 9]


def test_layers_have_animations_of_their_own(
    moving: bpy.types.Scene, exports: Exports, lines: Any, tmp_path: Path
) -> None:
    moving.view_layers.new("Second").samples = 2
    moving.frame_end = 6
    animate(moving, tmp_path)
    for layer in ("ViewLayer", "Second"):
        assert exports.frames(layer) == list(range(1, 7))
    assert [(line["frame"], line["layer"], line["samples"]) for line in lines()] == [
        (frame, layer, samples) for frame in range(1, 7) for layer, samples in (("ViewLayer", 4), ("Second", 2))
    ]


def test_views_have_sequences_of_their_own_and_share_the_export(
    moving: bpy.types.Scene, exports: Exports, lines: Any, tmp_path: Path
) -> None:
    moving.render.use_multiview = True
    moving.frame_end = 6
    moving.camera.location.z = 5.0
    animate(moving, tmp_path)
    assert exports.frames() == list(range(1, 7))
    assert [(line["frame"], line["view"]) for line in lines()] == [
        (frame, view) for frame in range(1, 7) for view in ("left", "right")
    ]


def test_a_border_is_the_part_of_the_whole(moving: bpy.types.Scene, lines: Any, tmp_path: Path) -> None:
    moving.frame_end = 4
    moving.render.film_transparent = True
    whole, part = tmp_path / "whole", tmp_path / "part"
    animate(moving, whole)
    moving.render.use_border = moving.render.use_crop_to_border = True
    moving.render.border_min_x, moving.render.border_max_x, moving.render.border_min_y, moving.render.border_max_y = (
        0.25,
        0.75,
        0.5,
        1.0,
    )
    animate(moving, part)
    cropped, expected = combined(part, 3), combined(whole, 3)[HEIGHT // 2 :, WIDTH // 4 : WIDTH * 3 // 4]
    assert np.allclose(cropped, expected, atol=1e-3)
    assert [line["frame"] for line in lines()] == [1, 2, 3, 4] * 2


def test_motion_blur_returns_to_the_frame(moving: bpy.types.Scene, exports: Exports, tmp_path: Path) -> None:
    moving.render.use_motion_blur = True
    moving.view_layers[0].use_pass_vector = True
    moving.gradus.vector_with_motion_blur = True
    moving.frame_end = 6
    animate(moving, tmp_path)
    assert exports.frames() == list(range(1, 7))
    assert np.allclose(
        [places["Moving [0]"][0] for _, places in exports.of["ViewLayer"]],
        [-0.9, -0.8, -0.7, -0.6, -0.5, -0.4],
        atol=1e-5,
    )
    vector = images.read(tmp_path / "f_0004.exr")["Vector"]
    assert np.allclose(vector[HEIGHT // 2, int(WIDTH * 0.35), [0, 2]], -0.1 * WIDTH / 4.0, atol=0.01)


def test_the_files_of_frames_are_saved_as_the_scene_is_in_them(moving: bpy.types.Scene, tmp_path: Path) -> None:
    """Blender reads the exposure of saved images from the scene, which is not evaluated."""
    simulations.rigid_body()  # so that the scene is stepped
    for frame, exposure in ((1, 0.0), (6, -5.0)):
        moving.view_settings.exposure = exposure
        moving.keyframe_insert("view_settings.exposure", frame=frame)
    moving.frame_end = 6
    brightness = {}
    for ahead in (True, False):
        moving.gradus.use_temporal = ahead
        moving.render.image_settings.file_format = "PNG"
        moving.render.filepath = str(tmp_path / f"{ahead}_####")
        bpy.ops.render.render(animation=True, scene=moving.name)
        files = sorted(tmp_path.glob(f"{ahead}_*"))
        brightness[ahead] = [images.oiio.ImageBuf(str(path)).get_pixels()[..., :3].mean() for path in files]
    assert len(brightness[True]) == 6
    assert np.allclose(brightness[True], brightness[False], atol=0.01)
    assert brightness[True][0] > 2.0 * brightness[True][5]


# ----------------------------------------------------------------------------- frames that differ from their neighbours


def animate_with_store(scene: bpy.types.Scene, folder: Path) -> Path:
    """Renders a range with a frame store, so that the frame before the range is exported."""
    folder.mkdir()
    scene.gradus.frame_store = str(folder / "store")
    animate(scene, folder)
    return folder


def expect_ranges_alone(scene: bpy.types.Scene, whole: Path, ranges: list[tuple[int, int]]) -> None:
    """Requires that the frames of each range equal those of an animation of that range."""
    for first, last in ranges:
        scene.frame_start, scene.frame_end = first, last
        part = animate_with_store(scene, whole.with_name(f"{first}"))
        for frame in range(first, last + 1):
            assert np.array_equal(combined(whole, frame), combined(part, frame)), frame


def key_film(scene: bpy.types.Scene) -> None:
    step(scene, "render.film_transparent", {1: False, 5: True})


def key_holdout(_scene: bpy.types.Scene) -> None:
    step(bpy.data.objects["Moving"], "is_holdout", {1: False, 5: True})


def key_reconstruction(scene: bpy.types.Scene) -> None:
    step(scene, "gradus.reconstruction", {1: "L2", 5: "REGULARIZED"})  # AUTO then uses path tracing


@pytest.mark.parametrize("change", [key_film, key_holdout, key_reconstruction])
def test_c8_frames_with_other_channels_or_planes_are_a_shot_change(
    moving: bpy.types.Scene, exports: Exports, tmp_path: Path, change: Callable[..., None]
) -> None:
    """Regression: such frames ended the animation."""
    moving.view_layers[0].gradus.use_pass_gradients = False
    change(moving)
    whole = animate_with_store(moving, tmp_path / "whole")
    assert frames_in(whole) == list(range(1, 11))
    assert exports.frames() == list(range(11)), "the frame before the first one is exported"
    expect_ranges_alone(moving, whole, [(1, 4), (5, 10)])


@pytest.mark.parametrize(
    ("path", "usual", "alone", "why"),
    [
        ("gradus.samples", 4, 1, "there is one sample per pixel"),
        ("gradus.integrator", "GRADIENT", "PATH", "the integrator is path"),
        ("gradus.reconstruction", "L2", "NONE", "reconstruction is none"),
        ("gradus.use_temporal", True, False, "temporal is off"),
    ],
)
def test_c8_an_independent_frame_is_a_still_and_a_shot_change(
    moving: bpy.types.Scene,
    render: Callable[..., images.Passes],
    exports: Exports,
    lines: Any,
    tmp_path: Path,
    path: str,
    usual: Any,
    alone: Any,
    why: str,
) -> None:
    """Regression: such a frame ended the animation with an error."""
    moving.view_layers[0].gradus.use_pass_gradients = False
    if path == "gradus.integrator":
        moving.gradus.reconstruction = "AUTO"  # the noisy image with Path
    step(moving, path, {1: usual, 5: alone, 6: usual})
    whole = animate_with_store(moving, tmp_path / "whole")
    assert frames_in(whole) == list(range(1, 11))
    assert sorted(exports.frames()) == [0, 1, 2, 3, 4, 5, 5, 6, 7, 8, 9, 10], (
        "the frame is exported for the next one and when it is rendered"
    )
    assert [line["frame"] for line in lines() if line["plan"].get("frame_by_frame") == why] == [5]
    assert np.array_equal(combined(whole, 5), render(moving, frame=5)["Combined"])
    expect_ranges_alone(moving, whole, [(1, 4), (6, 10)])
    require_nothing_kept()


def test_c7_an_independent_frame_does_not_disturb_a_frame_store(moving: bpy.types.Scene, tmp_path: Path) -> None:
    moving.gradus.frame_store = str(tmp_path / "store")
    step(moving, "gradus.samples", {0: 1, 2: 4, 5: 1, 6: 4})
    whole, again = tmp_path / "whole", tmp_path / "again"
    for folder in (whole, again):
        folder.mkdir()
        animate(moving, folder)
    for frame in range(1, 11):
        assert np.array_equal(combined(whole, frame), combined(again, frame)), frame


# -------------------------------------------------------------------------------- parts of an animation


def test_existing_files_split_the_animation(
    moving: bpy.types.Scene, exports: Exports, lines: Any, tmp_path: Path
) -> None:
    moving.render.use_overwrite = False
    for frame in (4, 7, 8):
        (tmp_path / f"f_{frame:04d}.exr").write_bytes(b"mine")
    animate(moving, tmp_path)
    assert exports.frames() == [1, 2, 3, 5, 6, 9, 10]
    assert all(line["samples_replayed"] == 2 for line in lines())
    assert (tmp_path / "f_0004.exr").read_bytes() == b"mine"


@pytest.mark.parametrize(
    ("reconstruction", "ahead", "before"), [("REGULARIZED", 6, 18), ("L2", 9, 15)], ids=["joined", "windows"]
)
def test_skipped_frames_are_not_sampled_for_the_frame_store(
    moving: bpy.types.Scene, exports: Exports, tmp_path: Path, reconstruction: str, ahead: int, before: int
) -> None:
    """Regression: all frames between two missing ones were sampled, though neither needs them."""
    moving.gradus.reconstruction, moving.gradus.frame_store = reconstruction, str(tmp_path / "store")
    moving.render.use_overwrite, moving.frame_end = False, 24
    for frame in range(3, 22):
        (tmp_path / f"f_{frame:04d}.exr").write_bytes(b"mine")
    animate(moving, tmp_path)
    assert exports.frames() == [0, *range(1, ahead + 1), *range(before - 1, 25)]
    again = tmp_path / "again"
    again.mkdir()
    moving.gradus.frame_store, moving.render.use_overwrite = str(tmp_path / "another store"), True
    animate(moving, again)
    for frame in (1, 2, 22, 24):
        assert np.array_equal(combined(tmp_path, frame), combined(again, frame)), frame


def test_a_frame_that_fails_ends_no_later_part(
    moving: bpy.types.Scene, exports: Exports, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Regression: the error of a neighbour that Blender skips was raised for a later frame that does not need it."""
    moving.gradus.reconstruction, moving.gradus.frame_store = "REGULARIZED", str(tmp_path / "store")
    moving.render.use_overwrite, moving.frame_end = False, 24
    for frame in range(3, 22):
        (tmp_path / f"f_{frame:04d}.exr").write_bytes(b"mine")
    raise_in_export(5, exports, monkeypatch)
    animate(moving, tmp_path)
    assert {1, 2, 22, 23, 24} <= set(frames_in(tmp_path))
    assert np.isfinite(combined(tmp_path, 22)).all()


def test_files_of_several_views_split_the_animation(moving: bpy.types.Scene, exports: Exports, tmp_path: Path) -> None:
    """Blender skips a frame if one view has a file.

    Regression: the suffix of the view was ignored, and frames with files were sampled.
    """
    moving.render.use_multiview, moving.render.use_overwrite = True, False
    images.use_exr(moving, tmp_path / "f_####")
    moving.render.use_file_extension, moving.render.image_settings.views_format = True, "INDIVIDUAL"
    (tmp_path / "f_0004_R.exr").write_bytes(b"mine")
    moving.frame_end = 6
    bpy.ops.render.render(animation=True, scene=moving.name)
    assert exports.frames() == [1, 2, 3, 5, 6]
    assert sorted(path.name for path in tmp_path.glob("*_L.exr")) == [
        f"f_{frame:04d}_L.exr" for frame in (1, 2, 3, 5, 6)
    ]


def test_frames_that_processes_share_by_placeholders_are_independent(
    moving: bpy.types.Scene, lines: Any, tmp_path: Path
) -> None:
    moving.render.use_overwrite, moving.render.use_placeholder = False, True
    moving.frame_end = 3
    animate(moving, tmp_path)
    assert [line.get("samples_replayed", 0) for line in lines()] == [0, 0, 0]


def test_c7_parts_that_share_a_frame_store_are_the_whole(
    moving: bpy.types.Scene, exports: Exports, tmp_path: Path
) -> None:
    whole, parts, again = (tmp_path / name for name in ("whole", "parts", "again"))
    for folder in (whole, parts, again):
        folder.mkdir()
    moving.gradus.frame_store = str(tmp_path / "store of the whole")
    animate(moving, whole)
    assert exports.frames() == list(range(11)), "the frame before the first one is exported"
    moving.gradus.frame_store = str(tmp_path / "store")
    for first, last in ((1, 5), (6, 10)):
        moving.frame_start, moving.frame_end = first, last
        animate(moving, parts)
    for frame in range(6, 11):
        assert np.array_equal(combined(parts, frame), combined(whole, frame))
    # The first range was rendered before the second. With all frames in the store, it is unchanged.
    moving.frame_start, moving.frame_end = 1, 5
    animate(moving, again)
    for frame in range(1, 6):
        assert np.array_equal(combined(again, frame), combined(whole, frame))


# -------------------------------------------------------------------------------- faults


def raise_in_export(frame: int, exports: Exports, _monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(number: int) -> None:
        if number == frame:
            raise ExportError("the camera is gone")

    exports.before = fail


def raise_in_library(frame: int, _exports: Exports, monkeypatch: pytest.MonkeyPatch) -> None:
    library = native.load()
    sample = library.sequence_sample

    def fail(sequence: int, scene: int, settings: Any, render: Any) -> int:
        if settings._obj.frame == frame:
            raise native.GradusError(native.Error.UNKNOWN, "the camera is gone")
        return sample(sequence, scene, settings, render)

    monkeypatch.setattr(library, "sequence_sample", fail)


@pytest.mark.parametrize("fault", [raise_in_export, raise_in_library])
def test_i2_an_error_is_raised_at_its_frame(
    moving: bpy.types.Scene,
    exports: Exports,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    fault: Callable[..., None],
) -> None:
    with monkeypatch.context() as patched:
        fault(5, exports, patched)
        with pytest.raises(RuntimeError, match="the camera is gone"):
            animate(moving, tmp_path)
    assert frames_in(tmp_path) == [1, 2, 3, 4]
    assert all(np.isfinite(combined(tmp_path, frame)).all() for frame in range(1, 5))
    require_nothing_kept()
    # Without the error, a rerun renders the remaining frames.
    exports.before = lambda _frame: None
    moving.render.use_overwrite = False
    animate(moving, tmp_path)
    assert frames_in(tmp_path) == list(range(1, 11))


def test_i2_with_a_frame_store_the_rerun_gives_what_an_undisturbed_render_does(
    moving: bpy.types.Scene, exports: Exports, tmp_path: Path
) -> None:
    whole, rest = tmp_path / "whole", tmp_path / "rest"
    whole.mkdir()
    rest.mkdir()
    moving.gradus.frame_store = str(tmp_path / "undisturbed")
    animate(moving, whole)
    moving.gradus.frame_store = str(tmp_path / "disturbed")
    raise_in_export(5, exports, None)
    with pytest.raises(RuntimeError):
        animate(moving, rest)
    assert frames_in(rest) == [1, 2, 3, 4]
    exports.before = lambda _frame: None
    moving.render.use_overwrite = False
    animate(moving, rest)
    for frame in range(5, 11):
        assert np.array_equal(combined(rest, frame), combined(whole, frame))


@pytest.mark.parametrize(("frame", "samples"), [(1, 100000), (4, 2)])
def test_escape_ends_the_frames_ahead(
    moving: bpy.types.Scene, exports: Exports, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, frame: int, samples: int
) -> None:
    moving.gradus.samples = samples  # 100000 samples would take minutes
    moving.frame_end = 6
    delivered: list[int] = []
    deliver = animation.Animation.deliver
    monkeypatch.setattr(animation.Animation, "deliver", lambda *given: (delivered.append(given[2]), deliver(*given))[1])
    monkeypatch.setattr(renderer, "stop_requested", lambda _engine: exports.frames()[-1:] == [frame])
    begin = time.monotonic()
    animate(moving, tmp_path)
    assert time.monotonic() - begin < 30.0
    assert 1 not in delivered, "the cancel came while frames ahead of the first one were sampled"
    require_nothing_kept()


# Regression: the files of a frame were read to their end before a cancel was noticed.
def test_k5_a_frame_that_is_cancelled_while_it_is_read_ends_well(
    moving: bpy.types.Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    deliver = animation.Animation.deliver
    delivered: list[int] = []

    def cancelled(self: animation.Animation, view: str, frame: int, settings: Any) -> int:
        handle = deliver(self, view, frame, settings)
        self.library.render_cancel(handle)
        delivered.append(frame)
        return handle

    moving.frame_end = 2
    monkeypatch.setattr(animation.Animation, "deliver", cancelled)
    animate(moving, tmp_path)
    assert delivered
    require_nothing_kept()


# -------------------------------------------------------------------------------- the command line


def test_single_frames_are_detected_on_the_command_line() -> None:
    assert animation._asks_for_single_frames(["blender", "-b", "a.blend", "-f", "1"])
    assert animation._asks_for_single_frames(["blender", "--render-frame", "1..5"])
    assert not animation._asks_for_single_frames(["blender", "-s", "1", "-a"])
    assert not animation._asks_for_single_frames(["blender", "-a", "--", "-f"])
    assert not animation._asks_for_single_frames(["python3"])
