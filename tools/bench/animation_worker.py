"""Renders ranges of frames inside the Python module bpy, as `blender -b -a` does: one process per scene, so that modes interleave.

Reads one JSON job per line from standard input, answers with one JSON line prefixed by RESULT:
  {"mode": "path", "samples": 16, "seed": 3, "frames": [8, 17], "shutter": 0.5, "out": "x.npy"}
  ->  {"cpu": 9.1, "wall": 4.7, "peak_memory_bytes": …}
A job with "vectors" stores the pass Vector in place of the picture. What cannot be done is answered by {"error": "why"}.
Stored is float32 (frames, height, width, channels), top row first. CPU seconds are those of the whole process during the operator: of
every frame export, build, sampling, reconstruction or denoising, and writing a small file.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import animation_modes
import bpy
import memory
import modes
import numpy as np
import worker


def render(job: dict, folder: Path) -> dict:
    scene, layer = bpy.context.scene, bpy.context.view_layer
    if "use_temporal" in scene.gradus.bl_rna.properties:
        scene.gradus.use_temporal = False
    modes.apply(scene, animation_modes.MODES[job["mode"]], job["samples"], job["seed"])
    set_motion_blur(scene, layer, job["shutter"])
    wants_vectors = job.get("vectors", False)
    layer.use_pass_vector = wants_vectors
    worker.choose_file(layers=wants_vectors)
    answer, files = render_range(job["frames"], folder)
    channels = [f"{layer.name}.Vector.{c}" for c in "XYZW"] if wants_vectors else list("RGB")
    np.save(job["out"], np.stack([worker.read_exr(file, channels) for file in files]))
    remove(files)
    return answer


def render_range(frames: tuple[int, int], folder: Path) -> tuple[dict, list[Path]]:
    """What it took, and the files of the frames."""
    scene = bpy.context.scene
    first, last = frames
    scene.frame_start, scene.frame_end, scene.frame_step = first, last, 1
    scene.render.filepath = str(folder / "frame")
    memory.reset_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    bpy.ops.render.render(animation=True)
    answer = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall, "peak_memory_bytes": memory.peak_bytes()}
    return answer, [Path(scene.render.frame_path(frame=frame)) for frame in range(first, last + 1)]


def remove(files: list[Path]) -> None:
    """A frame that the next job does not write must be missed."""
    for file in files:
        file.unlink()


def set_motion_blur(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, shutter: float) -> None:
    """For all engines alike; position, curve and steps are the file's."""
    scene.render.use_motion_blur = layer.use_motion_blur = shutter > 0.0
    if shutter > 0.0:
        scene.render.motion_blur_shutter = shutter


def open_scene(path: str, width: int, height: int) -> Callable[[dict, Path], dict]:
    for name, limit in worker.prepare(path, width, height).items():
        setattr(bpy.context.scene.gradus, name, limit)  # the same work for all engines
    bpy.context.scene.render.use_overwrite, bpy.context.scene.render.use_placeholder = True, False
    return render


if __name__ == "__main__":
    worker.serve(__doc__, open_scene)
