"""J1: late frames need no more memory than early ones. 400 frames with every change, 1000 in the full run."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from support.application import Outcome
from support.memory import SAMPLES, check_memory

# An animated scene: a cube rotates, so that every frame is exported again; memory is counted after each frame.
TURNING = """
cube = scene.objects["Cube"]
cube.keyframe_insert("rotation_euler", frame=1)
cube.rotation_euler = (1.0, 2.0, 3.0)
cube.keyframe_insert("rotation_euler", frame=1000)
bpy.app.handlers.render_post.append(lambda scene, *_: count(scene.frame_current))
"""
FRAMES = 1000 if os.environ.get("GRADUS_TEST_FULL") == "1" else 400


@SAMPLES
def test_j1_memory_does_not_grow_with_frames(blender: Callable[..., Outcome], tmp_path: Path, samples: int) -> None:
    check_memory(blender, tmp_path, TURNING, FRAMES, samples, "-s", "1", "-e", str(FRAMES), "-a")
