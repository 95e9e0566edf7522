"""Render Animation in a window: frames are sampled ahead on the render thread while the interface responds."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path

import pytest
from support import glow, window

pytestmark = pytest.mark.application

SCENE = """
import sys
import bpy

sys.argv += ["--", "--gradus-stats", "FOLDER/stats.jsonl"]
scene = bpy.context.scene
scene.render.engine = "GRADUS"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
scene.gradus.samples, scene.gradus.noise_threshold = SAMPLES, 0
scene.frame_start, scene.frame_end = 1, 12
scene.render.filepath = "FOLDER/f_####"
cube = bpy.data.objects["Cube"]
for frame in (1, 12):
    cube.location.x = 0.1 * frame
    cube.keyframe_insert("location", frame=frame)
preferences = bpy.context.preferences.view
preferences.render_display_type, preferences.show_splash = "NONE", False
EXTRA

def tell(text):
    def handler(*_):
        print(text, scene.frame_current, flush=True)
    return handler

bpy.app.handlers.render_init.append(tell("RENDER-STARTED"))
bpy.app.handlers.render_complete.append(tell("RENDER-COMPLETE"))
bpy.app.handlers.render_cancel.append(tell("RENDER-CANCELLED"))

def start():
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        bpy.ops.render.render("INVOKE_DEFAULT", animation=True)

def tick():
    from gradus import animation
    print("TICK", len(animation._running), flush=True)
    return 0.2

bpy.app.timers.register(start, first_interval=0.1)
bpy.app.timers.register(tick, first_interval=0.1)
"""


@pytest.fixture(autouse=True)
def tools() -> None:
    if not all(shutil.which(name) for name in ("Xvfb", "xdotool")):
        pytest.skip("needs the packages of tools/setup/debian-window.txt")


def script(folder: Path, samples: int, extra: str = "") -> str:
    return SCENE.replace("SAMPLES", str(samples)).replace("EXTRA", extra).replace("FOLDER", str(folder))


def wait_for_file(path: Path, limit: float = 120) -> None:
    end = time.monotonic() + limit
    while not path.exists():
        assert time.monotonic() < end, f"no {path.name} after {limit} s"
        time.sleep(0.1)


def lines(folder: Path) -> list[dict]:
    return [json.loads(line) for line in (folder / "stats.jsonl").read_text().splitlines()]


def frame_by_frame(line: dict) -> str:
    """Returns why a frame was rendered independently, or ""."""
    return line.get("plan", {}).get("frame_by_frame", "")


def test_c3_an_animation_in_a_window_has_every_frame(tmp_path: Path) -> None:
    with window.blender(script(tmp_path, 16), window.SMALL) as blender:
        blender.wait_for("RENDER-COMPLETE 1\n", limit=90)
        blender.wait_for("TICK 0", limit=5)
        assert "TICK 1" in blender.log, "the interface responds meanwhile"
    assert [line["frame"] for line in lines(tmp_path)] == list(range(1, 13))
    samples = [line["samples"] for line in lines(tmp_path)]
    assert len(samples) == 12 and all(16 <= count <= 24 for count in samples)  # edges have more
    assert not any(map(frame_by_frame, lines(tmp_path)))
    assert len(list(tmp_path.glob("f_*.png"))) == 12


MOVES = """
bpy.data.objects["Cube"].keyframe_insert("location", frame=1)
bpy.data.objects["Cube"].location.x += 1
bpy.data.objects["Cube"].keyframe_insert("location", frame=LAST)
scene.frame_end = LAST
scene.render.filepath = "FOLDER/f_####"
"""


def moves(folder: Path, last: int) -> str:
    """Returns a script that moves the cube up to frame `last` and writes pictures into `folder`."""
    return MOVES.replace("LAST", str(last)).replace("FOLDER", str(folder))


def test_frames_ahead_are_shown_while_they_are_sampled(tmp_path: Path) -> None:
    """Regression: until the frames ahead of the first one were sampled, the window was black."""
    script = glow.SCENE.replace("SAMPLES", "1000000") + moves(tmp_path, 12)
    with window.blender(script, window.SMALL) as blender:
        blender.wait_for("WINDOW-READY")
        blender.press("ctrl+F12")
        blender.wait_for("RENDER-STARTED")
        glow.wait_for_picture(blender)
        blender.press("Escape")
        blender.wait_for("RENDER-CANCELLED", limit=3)
    assert list(tmp_path.glob("f_*.png")) == []


def press_escape_after(frame: int, script: str, folder: Path, limit: float) -> None:
    """Renders 40 frames, presses Escape after one of them, and requires that the window keeps its picture."""
    with window.blender(script, window.SMALL) as blender:
        blender.wait_for("WINDOW-READY")
        blender.press("ctrl+F12")
        wait_for_file(folder / f"f_{frame:04d}.png")
        glow.wait_for_picture(blender)
        blender.press("Escape")
        blender.wait_for("RENDER-CANCELLED", limit=limit)
        glow.wait_for_picture(blender)
    assert not (folder / "f_0040.png").exists()


def test_escape_between_frames_keeps_the_shown_picture(tmp_path: Path) -> None:
    """Regression: the frames ahead of a later frame were cancelled, and the shown picture was empty."""
    press_escape_after(5, glow.SCENE.replace("SAMPLES", "64") + moves(tmp_path, 40), tmp_path, limit=3)


def test_escape_while_a_frame_is_set_keeps_the_shown_picture(tmp_path: Path) -> None:
    """Regression: the window lost its picture if Escape was pressed before the first sample of a frame."""
    slow = "\nimport time\nbpy.app.handlers.frame_change_post.append(lambda *_: time.sleep(0.5))\n"
    press_escape_after(3, glow.SCENE.replace("SAMPLES", "1") + moves(tmp_path, 40) + slow, tmp_path, limit=5)


def test_escape_ends_the_frames_ahead_in_a_window(tmp_path: Path) -> None:
    with window.blender(script(tmp_path, 100000), window.SMALL) as blender:
        blender.wait_for("TICK 1", limit=60)
        blender.press("Escape")
        blender.wait_for("RENDER-CANCELLED", limit=3)
        blender.wait_for("RENDER-CANCELLED 1\nTICK 0", limit=5)  # nothing is kept
    assert list(tmp_path.glob("f_*.png")) == []


def test_simulations_that_are_not_baked_are_named_and_make_frames_independent(tmp_path: Path) -> None:
    # Unless the interface is locked, it draws the rigid body while the render steps to the next frame, and Blender 3.4
    # itself may crash.
    falling = (
        "bpy.context.view_layer.objects.active = cube; bpy.ops.rigidbody.object_add(); "
        "scene.render.use_lock_interface = True"
    )
    with window.blender(script(tmp_path, 2, falling + "; scene.frame_end = 3"), window.SMALL) as blender:
        blender.wait_for("RENDER-COMPLETE 1\n", limit=90)
    assert all(map(frame_by_frame, lines(tmp_path)))
    warnings = [text for line in lines(tmp_path) for text in line["warnings"] if "not baked" in text]
    assert len(warnings) == 1
    assert "Rigid Body World" in warnings[0]


def test_invisible_simulations_leave_temporal_on(tmp_path: Path) -> None:
    """Regression: with an empty rigid-body world or a cloth hidden for render, all frames were stills."""
    hidden = """
bpy.ops.rigidbody.world_add()
bpy.ops.mesh.primitive_grid_add()
cloth = bpy.context.object
cloth.modifiers.new("Cloth", "CLOTH")
cloth.hide_render = True
scene.frame_end = 3
"""
    with window.blender(script(tmp_path, 2, hidden), window.SMALL) as blender:
        blender.wait_for("RENDER-COMPLETE 1\n", limit=90)
    assert not any(map(frame_by_frame, lines(tmp_path)))
    assert not [text for line in lines(tmp_path) for text in line["warnings"] if "not baked" in text]
