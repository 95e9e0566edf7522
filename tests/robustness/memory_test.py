"""J1: late frames need the memory of early ones. 400 frames with every change, 1000 in the full run.

Resident memory swings by up to 30 MB over hundreds of frames and comes back, as allocators keep and return pages: the least of the last
quarter may be that much more than the least of the second. (What a render itself leaves behind is counted exactly in tests/memory.)
"""

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
FRAMES = 1000 if os.environ.get("GRADUS_TEST_FULL") == "1" else 400
WARM_UP = FRAMES // 4
MEGABYTE = 1 << 20
SWING = 48 * MEGABYTE


def test_j1_memory_does_not_grow_with_frames(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    head = ["--addons", "gradus", "-E", "GRADUS", "--python-expr", SCRIPT, "-o", f"{tmp_path}/f_####", "-F", "PNG"]
    outcome = blender(*head, "-s", "1", "-e", str(FRAMES), "-a", limit=1800)
    assert outcome.code == 0, outcome.output
    lines = [line.split()[1:] for line in outcome.output.splitlines() if line.startswith("MEMORY ")]
    found = {int(frame): (int(resident), int(threads), int(files)) for frame, resident, threads, files in lines}
    assert len(found) == FRAMES
    early, late = found[WARM_UP], found[FRAMES]
    before = min(found[frame][0] for frame in range(WARM_UP, FRAMES // 2))
    after = min(found[frame][0] for frame in range(FRAMES - WARM_UP, FRAMES + 1))
    assert after - before <= SWING, f"{(after - before) / MEGABYTE:.1f} MB in {FRAMES // 2} frames"
    assert late[1] <= early[1]
    assert late[2] <= early[2]
