"""Renders jobs of the benchmark inside the Python module bpy: one process per scene, so that modes interleave in one run.

Reads one JSON job per line from standard input, answers with one JSON line prefixed by RESULT:
  {"mode": "gradient-l2", "samples": 16, "seed": 3, "out": "x.npy"}  ->  {"cpu": 1.2, "wall": 0.7, "peak_memory_bytes": …, "stats": {…}}
  {"twin": "x.npz"}  ->  {} once the scene is written as arrays (twin.py)
A job with "error" stores in its file the pass Error besides the image, whose time then counts for nothing, as a fourth channel.
A job with "frame" stores its raw frame in that file, too (samples, differences and features in halves).
A job with "bounces" replaces all bounce limits of the file. What cannot be done is answered by {"error": "why"}.
The image is stored as float32 (height, width, 3), top row first. CPU seconds are those of the whole process during the operator:
export, build, sampling, reconstruction or denoising, and writing a small file.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import memory
import modes
import numpy as np
import twin
from answers import Answers

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
import gradus  # noqa: E402
from gradus import store  # noqa: E402

BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces")
STATS = ("cpu_seconds", "rays", "frame_memory_bytes", "shifts", "unbiased", "reconstruction")


def prepare(path: str, width: int, height: int) -> dict[str, int]:
    """Opens the file and returns its bounce limits."""
    bpy.ops.wm.open_mainfile(filepath=path)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_persistent_data = False
    render.use_compositing = render.use_sequencer = False
    render.use_motion_blur = False
    return {name: getattr(bpy.context.scene.cycles, name) for name in BOUNCES}


def choose_file(layers: bool) -> None:
    """With all layers of the view, or the image alone."""
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE" if layers else "IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER" if layers else "OPEN_EXR"
    settings.color_mode, settings.color_depth = "RGB", "32"


def render(job: dict, folder: Path, bounces: dict[str, int]) -> dict:
    scene = bpy.context.scene
    modes.apply(scene, modes.MODES[job["mode"]], job["samples"], job["seed"])
    is_gradus = scene.render.engine == modes.GRADUS
    for name, limit in bounces.items():
        setattr(scene.gradus if is_gradus else scene.cycles, name, job.get("bounces", limit))
    wants_error = job.get("error", False)
    bpy.context.view_layer.gradus.use_pass_error = wants_error
    choose_file(layers=wants_error)
    target = folder / "image.exr"
    scene.render.filepath = str(target.with_suffix(""))
    scene.gradus.frame_store = str(folder / "frames") if "frame" in job else ""
    memory.reset_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    bpy.ops.render.render(write_still=True)
    answer = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall, "peak_memory_bytes": memory.peak_bytes()}
    if is_gradus:
        stats = store.summaries[(scene.name, bpy.context.view_layer.name)]
        answer["stats"] = {name: stats[name] for name in STATS}
    if "frame" in job:
        shutil.move(next((folder / "frames").rglob("*.exr")), job["frame"])
    layer = bpy.context.view_layer.name
    channels = [f"{layer}.Combined.{c}" for c in "RGB"] + [f"{layer}.Error.X"] if wants_error else list("RGB")
    np.save(job["out"], read_exr(target, channels))
    return answer


def read_exr(path: Path, names: list[str]) -> np.ndarray:
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.channels()
        return np.stack([np.asarray(channels[name].pixels, dtype=np.float32) for name in names], axis=2)


def write_twin(job: dict) -> dict:
    twin.write(job["twin"])
    return {}


def serve(description: str | None, open_scene: Callable[[str, int, int], Callable[[dict, Path], dict]]) -> None:
    """Answers jobs, a line each, until there are no more. `open_scene` opens a file at a size, and gives what answers a job."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scene")
    parser.add_argument("width", type=int)
    parser.add_argument("height", type=int)
    arguments = parser.parse_args()
    answers = Answers()
    gradus.register()
    answer_job = open_scene(arguments.scene, arguments.width, arguments.height)
    with tempfile.TemporaryDirectory() as folder:
        for line in sys.stdin:
            job = json.loads(line)
            try:
                answer = answer_job(job, Path(folder))
            except Exception as error:  # one failed job must not end the others
                answer = {"error": str(error).strip()}
            answers.send(answer)
    gradus.unregister()
    os._exit(0)  # the 4.5 module can hang at exit


def open_scene(path: str, width: int, height: int) -> Callable[[dict, Path], dict]:
    bounces = prepare(path, width, height)
    return lambda job, folder: write_twin(job) if "twin" in job else render(job, folder, bounces)


if __name__ == "__main__":
    serve(__doc__, open_scene)
