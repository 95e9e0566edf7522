"""J2: 200 frames whose meshes and objects change, and 200 cancelled animations, leak no memory."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from support.application import Outcome
from support.memory import SAMPLES, check_memory

# The triangles change in every frame, as do the number of objects, which is one or two, and their names.
CHANGING = """
cube = scene.objects["Cube"]
cube.modifiers.new("Copies", "ARRAY")
guest = cube.copy()
scene.collection.objects.link(guest)
guest.location.x = 3.0
for frame in range(1, FRAMES + 1):
    cube.modifiers[0].count = 1 + frame % 5
    cube.modifiers[0].keyframe_insert("count", frame=frame)
    guest.hide_render = frame % 3 == 0
    guest.keyframe_insert("hide_render", frame=frame)

def rename(scene, *_):
    guest.name = f"Guest {scene.frame_current}"
    count(scene.frame_current)

bpy.app.handlers.render_post.append(rename)
"""
# Animations of three frames that are cancelled at different polls, which follow each other sooner than usual, so that
# they fall into builds and into sampling.
CANCELLED = """
from gradus import progress, renderer, store
progress.POLL_SECONDS = store.POLL_SECONDS = 0.005
scene.frame_start, scene.frame_end = 1, 3
scene.gradus.noise_threshold = 0.0
cube = scene.objects["Cube"]
cube.keyframe_insert("location", frame=1)
cube.location.x = 1.0
cube.keyframe_insert("location", frame=3)
asked = allowed = 0

def stop_requested(engine):
    global asked
    asked += 1
    return asked > allowed

renderer.stop_requested = stop_requested
for step in range(1, FRAMES + 1):
    asked, allowed = 0, step % 12
    scene.gradus.samples = SAMPLES if allowed < 10 else 100000  # the last ones end while they are sampled
    bpy.ops.render.render(animation=True)
    count(step)
"""


@SAMPLES
def test_j2_memory_does_not_grow_with_changes(blender: Callable[..., Outcome], tmp_path: Path, samples: int) -> None:
    check_memory(blender, tmp_path, CHANGING, 200, samples, "-s", "1", "-e", "200", "-a")


@SAMPLES
def test_j2_memory_does_not_grow_with_cancels(blender: Callable[..., Outcome], tmp_path: Path, samples: int) -> None:
    check_memory(blender, tmp_path, CANCELLED, 200, samples)
