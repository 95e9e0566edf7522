"""Renders ranges of frames inside the Python module bpy, as `blender -b -a` does: one process per scene, so that modes interleave.

Reads one JSON job per line from standard input, answers with one JSON line prefixed by RESULT:
  {"mode": "path", "samples": 16, "seed": 3, "frames": [8, 17], "out": "x.npy"}  ->  {"cpu": 9.1, "wall": 4.7, "peak_memory_bytes": …}
A job with "vectors" stores the pass Vector in place of the picture. What cannot be done is answered by {"error": "why"}.
Stored is float32 (frames, height, width, channels), top row first. CPU seconds are those of the whole process during the operator: of
every frame export, build, sampling, reconstruction or denoising, and writing a small file.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import animation_modes
import bpy
import memory
import modes
import numpy as np
import worker
from answers import Answers

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
import gradus  # noqa: E402


def render(job: dict, folder: Path) -> dict:
    scene, layer = bpy.context.scene, bpy.context.view_layer
    if "use_temporal" in scene.gradus.bl_rna.properties:
        scene.gradus.use_temporal = False
    modes.apply(scene, animation_modes.MODES[job["mode"]], job["samples"], job["seed"])
    wants_vectors = job.get("vectors", False)
    layer.use_pass_vector = wants_vectors
    worker.choose_file(layers=wants_vectors)
    first, last = job["frames"]
    scene.frame_start, scene.frame_end, scene.frame_step = first, last, 1
    scene.render.filepath = str(folder / "frame")
    memory.reset_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    bpy.ops.render.render(animation=True)
    answer = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall, "peak_memory_bytes": memory.peak_bytes()}
    channels = [f"{layer.name}.Vector.{c}" for c in "XYZW"] if wants_vectors else list("RGB")
    files = [Path(scene.render.frame_path(frame=frame)) for frame in range(first, last + 1)]
    np.save(job["out"], np.stack([worker.read_exr(file, channels) for file in files]))
    for file in files:
        file.unlink()  # a frame that the next job does not write must be missed
    return answer


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("width", type=int)
    parser.add_argument("height", type=int)
    arguments = parser.parse_args()
    answers = Answers()
    gradus.register()
    worker.prepare(arguments.scene, arguments.width, arguments.height)
    bpy.context.scene.render.use_overwrite, bpy.context.scene.render.use_placeholder = True, False
    with tempfile.TemporaryDirectory() as folder:
        for line in sys.stdin:
            try:
                answer = render(json.loads(line), Path(folder))
            except Exception as error:  # one failed job must not end the others
                answer = {"error": str(error).strip()}
            answers.send(answer)
    gradus.unregister()
    os._exit(0)  # the 4.5 module can hang at exit


if __name__ == "__main__":
    main()
