"""Renders ranges of frames inside the Python module bpy, as `blender -b -a` does: one process for each scene, so that
modes can take turns.

Reads one JSON job per line from standard input and answers each with one JSON line, prefixed by RESULT:
  {"mode": "path", "samples": 16, "seed": 3, "frames": [8, 17], "shutter": 0.5, "out": "x.npy"}
    -> {"cpu": 9.1, "wall": 4.7, "peak_memory_bytes": ..., "sampling": 6.2}
Frames are stored as float32 (frames, height, width, 3), top row first. CPU seconds are those of the whole process
during the operator: export, build, sampling, reconstruction or denoising, and writing a small file for every frame.
"sampling" are those that Gradus sampled for. A job that cannot be done is answered by {"error": "why"}.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import animation_modes
import bpy
import modes
import numpy as np
import worker
from worker import Answer, AnswerJob, Job


def render(job: Job, folder: Path) -> Answer:
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.gradus.use_temporal = False  # modes frame by frame do not set it
    modes.apply(scene, animation_modes.MODES[job["mode"]], job["samples"], job["seed"])
    set_motion_blur(scene, layer, job["shutter"])
    worker.choose_file(with_passes=False)
    answer, files, seconds = render_timed(job["frames"], folder)
    np.save(job["out"], np.stack([worker.read_exr(file, list("RGB")) for file in files]))
    remove(files)
    return answer | ({"sampling": sum(frame["sample"] for frame in seconds)} if seconds else {})


def render_timed(frames: tuple[int, int], folder: Path) -> tuple[Answer, list[Path], list[dict[str, float]]]:
    """Renders a range of frames; returns also the CPU seconds of each frame by phases, none for other engines."""
    stats = folder / "stats.jsonl"
    stats.unlink(missing_ok=True)
    with options(stats=str(stats)):
        answer, files = render_range(frames, folder)
    lines = stats.read_text().splitlines() if stats.exists() else []
    return answer, files, [json.loads(line)["cpu_seconds"] for line in lines]


@contextmanager
def options(**values: str) -> Iterator[None]:
    """Sets options of the add-on, as after `--` on the command line."""
    before = list(sys.argv)
    pairs = ((f"--gradus-{name.replace('_', '-')}", value) for name, value in values.items())
    sys.argv += ["--", *(text for pair in pairs for text in pair)]
    try:
        yield
    finally:
        sys.argv[:] = before


def render_range(frames: tuple[int, int], folder: Path) -> tuple[Answer, list[Path]]:
    """Renders a range of frames; returns times and memory, and the files of the frames."""
    scene = bpy.context.scene
    first, last = frames
    scene.frame_start, scene.frame_end, scene.frame_step = first, last, 1
    scene.render.filepath = str(folder / "frame")
    answer = worker.timed(lambda: bpy.ops.render.render(animation=True))
    return answer, [Path(scene.render.frame_path(frame=frame)) for frame in range(first, last + 1)]


def remove(files: list[Path]) -> None:
    """Removes the files, so that a frame that the next job fails to write is missing."""
    for file in files:
        file.unlink()


def set_motion_blur(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, shutter: float) -> None:
    """Switches motion blur on or off for all engines. Position, curve and steps stay those of the file."""
    scene.render.use_motion_blur = layer.use_motion_blur = shutter > 0.0
    if shutter > 0.0:
        scene.render.motion_blur_shutter = shutter


def open_scene(path: str, width: int, height: int) -> AnswerJob:
    for name, limit in worker.prepare(path, width, height).items():
        setattr(bpy.context.scene.gradus, name, limit)  # all engines have the bounce limits of the file
    bpy.context.scene.render.use_overwrite, bpy.context.scene.render.use_placeholder = True, False
    return render


if __name__ == "__main__":
    worker.serve(__doc__, open_scene)
