"""J1: late frames need the memory of early ones. 400 frames with every change, 1000 in the full run.

What is allocated is counted, which Blender's allocator (jemalloc) tells: the same within 0.3 MB. Resident memory says less: every render
has a thread of its own, these take turns in jemalloc's arenas, and it keeps pages of each for some seconds: 5 MB up and down on a quiet
machine, 30 MB on a busy one, 0.4 MB with one arena. It still shows what is mapped past the allocator, so its least of the last quarter may
be no more than that above its least of the second.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from support.application import Outcome

# An animated scene: a cube that turns, so that every frame is exported anew; what a frame leaves behind is counted after it.
SCRIPT = """
import bpy, ctypes, os
from pathlib import Path
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
scene.gradus.samples = SAMPLES
scene.objects["Cube"].keyframe_insert("rotation_euler", frame=1)
scene.objects["Cube"].rotation_euler = (1.0, 2.0, 3.0)
scene.objects["Cube"].keyframe_insert("rotation_euler", frame=1000)
page = os.sysconf("SC_PAGESIZE")

jemalloc = ctypes.CDLL(None)

def allocated():
    # By the statistics as of now.
    epoch, value, size = ctypes.c_uint64(1), ctypes.c_size_t(), ctypes.c_size_t(8)
    assert jemalloc.mallctl(b"epoch", None, None, ctypes.byref(epoch), size) == 0
    assert jemalloc.mallctl(b"stats.allocated", ctypes.byref(value), ctypes.byref(size), None, 0) == 0
    return value.value

def count(scene, *_):
    resident = int(Path("/proc/self/statm").read_text().split()[1]) * page
    threads, files = len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))
    print(f"MEMORY {scene.frame_current} {allocated()} {resident} {threads} {files}", flush=True)

bpy.app.handlers.render_post.append(count)
"""
FRAMES = 1000 if os.environ.get("GRADUS_TEST_FULL") == "1" else 400
WARM_UP = FRAMES // 4
MEGABYTE = 1 << 20
GROWTH, SWING = 1 * MEGABYTE, 48 * MEGABYTE


@pytest.mark.parametrize("samples", [1, 2], ids=["frame by frame", "over windows"])
def test_j1_memory_does_not_grow_with_frames(blender: Callable[..., Outcome], tmp_path: Path, samples: int) -> None:
    script = SCRIPT.replace("SAMPLES", str(samples))
    head = ["--addons", "gradus", "-E", "GRADUS", "--python-expr", script, "-o", f"{tmp_path}/f_####", "-F", "PNG"]
    outcome = blender(*head, "-s", "1", "-e", str(FRAMES), "-a", limit=1800)
    assert outcome.code == 0, outcome.output
    lines = [line.split()[1:] for line in outcome.output.splitlines() if line.startswith("MEMORY ")]
    found = {int(frame): tuple(map(int, counts)) for frame, *counts in lines}
    assert len(found) == FRAMES
    early, late = found[WARM_UP], found[FRAMES]
    for what, limit in ((0, GROWTH), (1, SWING)):
        before = min(found[frame][what] for frame in range(WARM_UP, FRAMES // 2))
        after = min(found[frame][what] for frame in range(FRAMES - WARM_UP, FRAMES + 1))
        assert after - before <= limit, f"{(after - before) / MEGABYTE:.1f} MB in {FRAMES // 2} frames"
    assert late[2] <= early[2]
    assert late[3] <= early[3]
