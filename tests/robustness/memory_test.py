"""J1: frame 1000 needs the memory of frame 100. A tenth of the frames with every change, all of them in the full run."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from support.application import Outcome

# An animated scene: a cube that turns, so that every frame is exported anew; what a frame leaves behind is counted after it.
SCRIPT = """
import bpy, os
from pathlib import Path
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
scene.gradus.samples = 1
scene.objects["Cube"].keyframe_insert("rotation_euler", frame=1)
scene.objects["Cube"].rotation_euler = (1.0, 2.0, 3.0)
scene.objects["Cube"].keyframe_insert("rotation_euler", frame=1000)
page = os.sysconf("SC_PAGESIZE")

def count(scene, *_):
    resident = int(Path("/proc/self/statm").read_text().split()[1]) * page
    threads, files = len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))
    print(f"MEMORY {scene.frame_current} {resident} {threads} {files}", flush=True)

bpy.app.handlers.render_post.append(count)
"""
FRAMES = 1000 if os.environ.get("GRADUS_TEST_FULL") == "1" else 100
WARM_UP = FRAMES // 5
MEGABYTE = 1 << 20


def test_j1_memory_does_not_grow_with_frames(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    head = ["--addons", "gradus", "-E", "GRADUS", "--python-expr", SCRIPT, "-o", f"{tmp_path}/f_####", "-F", "PNG"]
    outcome = blender(*head, "-s", "1", "-e", str(FRAMES), "-a", limit=1800)
    assert outcome.code == 0, outcome.output
    lines = [line.split()[1:] for line in outcome.output.splitlines() if line.startswith("MEMORY ")]
    found = {int(frame): (int(resident), int(threads), int(files)) for frame, resident, threads, files in lines}
    assert len(found) == FRAMES
    early, late = found[WARM_UP], found[FRAMES]
    assert late[0] - early[0] <= 8 * MEGABYTE, f"{(late[0] - early[0]) / MEGABYTE:.1f} MB in {FRAMES - WARM_UP} frames"
    assert late[1] <= early[1]
    assert late[2] <= early[2]
