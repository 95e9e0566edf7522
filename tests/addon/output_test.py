"""Files that Blender writes: free space, the previous frame, stats and paths of the frame store."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest
from gradus import file_check, frame_store, output, passes, stats
from gradus.failure import Failure, user_text
from support import images


def test_f7_space(tmp_path: Path) -> None:
    output.require_space(str(tmp_path / "new" / "folder" / "a.exr"), 1)
    with pytest.raises(Failure, match="not enough space"):
        output.require_space(str(tmp_path / "a.exr"), 1 << 60)


def test_f7_a_folder_that_cannot_be_created_is_reported_as_such() -> None:
    """Regression: the free space of the nearest existing folder was reported: "not enough space in /proc"."""
    with pytest.raises(Failure, match="output folder /proc/nope cannot be created"):
        output.require_space("/proc/nope/c_0001.exr", 1)


def test_f7_a_folder_that_cannot_be_written_is_noticed_before_rendering(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        output.os, "access", lambda path, mode: not mode & output.os.W_OK
    )  # root can write to all folders
    with pytest.raises(Failure, match="cannot be written to"):
        output.require_space(str(tmp_path / "a.exr"), 1)


def test_f7_the_frame_before(tmp_path: Path) -> None:
    render = SimpleNamespace(
        frame_path=lambda frame: str(tmp_path / f"{frame}.png"), is_movie_format=False, use_multiview=False
    )
    files = output.FrameFiles()
    files.before_frame(render, 1, 1)
    files.after_frame(render, 1)
    (tmp_path / "1.png").write_bytes(b"another format")
    files.before_frame(render, 2, 1)
    files.after_frame(render, 2)
    (tmp_path / "2.png").write_bytes(b"")
    with pytest.raises(Failure, match="is truncated"):
        files.before_frame(render, 3, 1)
    files.after_frame(render, 7)
    files.before_frame(render, 8, 1)  # as if a script had moved it


def test_f7_a_truncated_frame_is_found(tmp_path: Path, scene: bpy.types.Scene) -> None:
    """Regression: only empty files were found, but a full disk may truncate files anywhere."""
    image = bpy.data.images.new("noise", 61, 47, float_buffer=True)
    image.pixels.foreach_set([(7 * i % 101) / 100 for i in range(61 * 47 * 4)])
    codecs = ("ZIP", "ZIPS", "PIZ", "RLE", "NONE", "DWAA")
    formats = [("PNG", None), ("JPEG", None), *(("OPEN_EXR", codec) for codec in codecs)]
    for name, codec in formats:
        scene.render.image_settings.file_format = name
        if codec:
            scene.render.image_settings.exr_codec = codec
        path = tmp_path / f"{name}.{codec}"
        image.save_render(str(path), scene=scene)
        data = path.read_bytes()
        assert file_check.is_complete(path), (name, codec)
        for length in (0, 5, 20, len(data) // 3, len(data) - 1):
            path.write_bytes(data[:length])
            assert not file_check.is_complete(path), (name, codec, length)
        if codec:
            path.write_bytes(data[:400] + bytes(len(data) - 400))  # only zeros after the header
            assert not file_check.is_complete(path), (name, codec)


def test_f7_a_multilayer_file_is_complete(tmp_path: Path, scene: bpy.types.Scene) -> None:
    scene.collection.objects.link(camera := bpy.data.objects.new("camera", bpy.data.cameras.new("camera")))
    scene.camera = camera
    path = tmp_path / "frame.exr"
    images.use_exr(scene, path)
    bpy.ops.render.render(write_still=True)
    assert file_check.is_complete(path)
    path.write_bytes(path.read_bytes()[:-7])
    assert not file_check.is_complete(path)


def test_stats_are_one_line_with_all_phases(tmp_path: Path) -> None:
    clock = stats.Clock()
    with clock.phase("export"):
        pass
    with clock.phase("export"):
        pass
    native = json.dumps({"schema": 2, "seconds": {"sample": 2.0}, "warnings": ["a"], "samples": 4})
    full = stats.complete(native, {"frame": 3, "layer": "L", "scene": "S", "view": ""}, clock, ["a", "b"])
    assert full["warnings"] == ["a", "b"]
    assert {"sample", "export", "total"} <= full["seconds"].keys()
    assert full["peak_memory_bytes"] > 1 << 20
    path = tmp_path / "stats.jsonl"
    stats.append(str(path), full)
    stats.append(str(path), {**full, "frame": 4})
    assert [json.loads(line)["frame"] for line in path.read_text().splitlines()] == [3, 4]


def test_frame_store_names_are_escaped_and_differ() -> None:
    assert (
        str(frame_store.frame_path("/s", "My Scene", "View/Layer", "left", -5))
        == "/s/My%20Scene/View%2FLayer.left/f-0000005.exr"
    )
    assert frame_store.frame_path("/s", "a", "b", "", 1048574).name == "f+1048574.exr"
    assert frame_store.escape("a%20b") != frame_store.escape("a b")


def test_texts_for_people_are_one_line_and_never_empty() -> None:
    assert user_text(Failure("what\nfailed")) == "what failed"
    assert user_text(MemoryError()) == "out of memory"
    assert user_text(ValueError()) == "ValueError"
    assert user_text(KeyError("x")) == "KeyError: 'x'"


@pytest.mark.parametrize(
    ("layer", "views", "version", "lost"),
    [
        (20, ("",), (4, 5, 0), 0),
        (21, ("",), (4, 5, 0), 1),
        (21, ("",), (5, 0, 0), 0),
        (20, ("left", "right"), (4, 5, 0), 1),
        (63, ("",), (3, 4, 1), len(passes.COMPONENT_TABLE)),
    ],
)
def test_names_that_blender_truncates_are_reported(
    layer: int, views: tuple[str, ...], version: tuple[int, ...], lost: int
) -> None:
    """Regression: channels were lost without a warning if both a view layer and a component had long names."""
    parts = [part.of("Abcdefghijklmnopqrstuvwx") for part in passes.COMPONENT_TABLE]
    settings = SimpleNamespace(file_format="OPEN_EXR_MULTILAYER", views_format="MULTIVIEW")
    longest = [info for info in parts if info.name.endswith("Reflectance")] if lost < 2 else parts
    found = output.truncated_names(settings, "L" * layer, views, longest, version)
    others = f" and {lost - 1} others" if lost > 1 else ""
    assert [others in text and f"'{'L' * layer}'" in text for text in found] == [True] * min(lost, 1)
    assert (
        output.truncated_names(
            SimpleNamespace(file_format="PNG", views_format="MULTIVIEW"), "L" * layer, views, longest, version
        )
        == []
    )
