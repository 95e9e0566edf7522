"""Animations from the command line: their frames, the files left after a fault, and the end by SIGINT."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from support import application

SETUP = """
import bpy
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 18, 100
scene.gradus.reconstruction, scene.gradus.samples = 'L2', {samples}
cube = bpy.data.objects['Cube']
for frame in (1, 20):
    cube.location.x = 0.1 * frame
    cube.keyframe_insert('location', frame=frame)
print('SETUP DONE', flush=True)
"""
FAULT = """
from gradus import store
sync = store.Session.sync
def fail(session, depsgraph, *arguments):
    if depsgraph.scene_eval.frame_current == 5:
        raise RuntimeError('a fault')
    return sync(session, depsgraph, *arguments)
store.Session.sync = fail
"""


def arguments(folder: Path, *more: str, samples: int = 2, script: str = "") -> list[str]:
    expression = SETUP.format(samples=samples) + script
    return [
        "--addons",
        "gradus",
        "-E",
        "GRADUS",
        "--python-expr",
        expression,
        "-o",
        f"{folder}/f_####",
        "-F",
        "PNG",
        *more,
    ]


@pytest.mark.parametrize(
    ("asked", "frames", "follows"),
    [
        (("-s", "2", "-e", "9", "-j", "3", "-a"), [2, 5, 8], True),
        (("-s", "1", "-e", "9", "-f", "3"), [3], False),
        (("-f", "6,2..3"), [6, 2, 3], False),
    ],
)
def test_c3_frames_of_the_command_line(
    blender: Callable[..., application.Outcome],
    tmp_path: Path,
    asked: tuple[str, ...],
    frames: list[int],
    follows: bool,
) -> None:
    stats = tmp_path / "stats.jsonl"
    replaying = "bpy.context.scene.gradus.reconstruction = 'L2'\n"  # so that the stats show which frames follow others
    outcome = blender(*arguments(tmp_path, *asked, script=replaying), "--", "--gradus-stats", str(stats))
    assert outcome.code == 0, outcome.output
    assert [path.name for path in sorted(tmp_path.glob("f_*.png"))] == [
        f"f_{frame:04d}.png" for frame in sorted(frames)
    ]
    lines = [json.loads(line) for line in stats.read_text().splitlines()]
    assert [line["frame"] for line in lines] == frames
    assert all((line.get("samples_replayed", 0) > 0) == follows for line in lines)


def test_i2_a_fault_in_frame_5_ends_with_code_1_after_frame_4(
    blender: Callable[..., application.Outcome], tmp_path: Path
) -> None:
    outcome = blender(*arguments(tmp_path, "-s", "1", "-e", "10", "-a", script=FAULT))
    assert outcome.code == 1, outcome.output
    assert "a fault" in outcome.output
    assert [path.name for path in sorted(tmp_path.glob("f_*.png"))] == [f"f_{frame:04d}.png" for frame in range(1, 5)]


HANDLER = """
cube.animation_data_clear()
def place(scene, *_):
    cube.location.x = 0.5 * scene.frame_current - 2.0
bpy.app.handlers.render_pre.append(place)
"""


def pixels(path: Path) -> bytes:
    """Returns the compressed pixels of a PNG file, without its metadata."""
    data, place, found = path.read_bytes(), 8, b""
    while place < len(data):
        size = int.from_bytes(data[place : place + 4], "big")
        if data[place + 4 : place + 8] == b"IDAT":
            found += data[place + 8 : place + 8 + size]
        place += size + 12
    return found


def test_c9_what_render_pre_sets_is_in_each_frame(blender: Callable[..., application.Outcome], tmp_path: Path) -> None:
    whole, single = tmp_path / "whole", tmp_path / "single"
    outcome = blender(*arguments(whole, "-s", "1", "-e", "4", "-a", script=HANDLER))
    assert outcome.code == 0, outcome.output
    assert outcome.output.count("From frame 2 on, frames are rendered by themselves") == 1, outcome.output
    assert "(render_pre: place in " in outcome.output
    outcome = blender(*arguments(single, "-f", "2..4", script=HANDLER))
    assert outcome.code == 0, outcome.output
    found = [pixels(whole / f"f_{frame:04d}.png") for frame in (2, 3, 4)]
    assert found == [pixels(single / f"f_{frame:04d}.png") for frame in (2, 3, 4)]
    assert len(set(found)) == 3


@pytest.mark.alone
@pytest.mark.application
@pytest.mark.parametrize("seconds", [0.1, 0.6, 1.5])
def test_k1_sigint_ends_the_frames_ahead_within_a_second(tmp_path: Path, seconds: float) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    asked = arguments(
        tmp_path, "-s", "1", "-e", "20", "-a", samples=20000, script="scene.gradus.noise_threshold = 0.0\n"
    )
    process = application.start(*asked, folder=tmp_path / "home", env={"TMPDIR": str(temporary)})
    for line in process.stdout:
        if b"SETUP DONE" in line:
            break
    time.sleep(seconds)
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    try:
        output, _ = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 1, output
    assert time.monotonic() - begin < 1.0
    assert list(tmp_path.glob("f_*.png")) == []
    assert os.listdir(temporary) == [], "frames that were kept for their neighbours are released"
