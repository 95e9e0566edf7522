"""Renders stills inside the Python module bpy: one process for each scene, so that modes can take turns.

Reads one JSON job per line from standard input and answers each with one JSON line, prefixed by RESULT:
  {"mode": "gradient-l2", "samples": 16, "seed": 3, "out": "x.npy"}
    -> {"cpu": 1.2, "wall": 0.7, "peak_memory_bytes": ..., "stats": {...}}
  {"mitsuba_scene": "x.npz"} -> {} once the scene is written for Mitsuba (mitsuba_scene.py)
The image is stored as float32 (height, width, 3), top row first. CPU seconds are those of the whole process during the
operator: export, build, sampling, reconstruction or denoising, and writing a small file. A job may also have
  "bounces": a number that replaces all bounce limits of the file;
  "error": true, which stores the pass Error as a fourth channel (the time of such a job is not used);
  "film": a file that gets the film: samples, differences and features in half-buffers;
  "scene": a file that gets the scene as it is exported, for the tool of the build.
A job that cannot be done is answered by {"error": "why"}.
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
from typing import Any

import bpy
import mitsuba_scene
import modes
import numpy as np
from paths import ROOT

sys.path.insert(0, str(ROOT / "addon"))
import gradus  # noqa: E402
from gradus import store  # noqa: E402
from worker_process import Answers, peak_bytes, reset_peak  # noqa: E402

Job = dict[str, Any]
Answer = dict[str, Any]
AnswerJob = Callable[[Job, Path], Answer]

BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces")
STATS = ("cpu_seconds", "rays", "film_memory_bytes", "shifts", "unbiased", "reconstruction")


def prepare(path: str, width: int, height: int) -> dict[str, int]:
    """Opens the file at a size and returns its bounce limits."""
    bpy.ops.wm.open_mainfile(filepath=path)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_persistent_data = False
    render.use_compositing = render.use_sequencer = False
    render.use_motion_blur = False
    return {name: getattr(bpy.context.scene.cycles, name) for name in BOUNCES}


def choose_file(with_passes: bool) -> None:
    """Sets the file format: a multilayer OpenEXR file with all passes, or the image alone."""
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):  # since Blender 5.0
        settings.media_type = "MULTI_LAYER_IMAGE" if with_passes else "IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER" if with_passes else "OPEN_EXR"
    settings.color_mode, settings.color_depth = "RGB", "32"


def timed(operator: Callable[[], object]) -> Answer:
    """Calls an operator and returns the CPU and wall seconds and the peak memory of the process meanwhile."""
    reset_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    operator()
    seconds = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}
    return seconds | {"peak_memory_bytes": peak_bytes()}


def render(job: Job, folder: Path, bounces: dict[str, int]) -> Answer:
    scene = bpy.context.scene
    modes.apply(scene, modes.MODES[job["mode"]], job["samples"], job["seed"])
    is_gradus = scene.render.engine == modes.GRADUS
    for name, limit in bounces.items():
        setattr(scene.gradus if is_gradus else scene.cycles, name, job.get("bounces", limit))
    wants_error = job.get("error", False)
    bpy.context.view_layer.gradus.use_pass_error = wants_error
    choose_file(with_passes=wants_error)
    target = folder / "image.exr"
    scene.render.filepath = str(target.with_suffix(""))
    scene.gradus.frame_store = str(folder / "films") if "film" in job else ""
    sys.argv[1:] = ["--", "--gradus-save-scene", job["scene"]] if "scene" in job else []
    answer = timed(lambda: bpy.ops.render.render(write_still=True))
    layer = bpy.context.view_layer.name
    if is_gradus:
        stats = store.summaries[(scene.name, layer)]
        answer["stats"] = {name: stats[name] for name in STATS}
    if "film" in job:
        shutil.move(next((folder / "films").rglob("*.exr")), job["film"])
    channels = [f"{layer}.Combined.{c}" for c in "RGB"] + [f"{layer}.Error.X"] if wants_error else list("RGB")
    np.save(job["out"], read_exr(target, channels))
    return answer


def read_exr(path: Path, names: list[str]) -> np.ndarray:
    """Returns the named channels (height, width, channels) of an OpenEXR file."""
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.channels()
        return np.stack([np.asarray(channels[name].pixels, dtype=np.float32) for name in names], axis=2)


def serve(description: str | None, open_scene: Callable[[str, int, int], AnswerJob]) -> None:
    """Answers jobs until there are no more. `open_scene` opens a file at a size and returns the function that answers a
    job.
    """
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
            try:
                answer = answer_job(json.loads(line), Path(folder))
            except Exception as error:  # one failed job must not end the others
                answer = {"error": str(error).strip()}
            answers.send(answer)
    gradus.unregister()
    os._exit(0)  # the module can hang at exit


def open_scene(path: str, width: int, height: int) -> AnswerJob:
    bounces = prepare(path, width, height)

    def answer(job: Job, folder: Path) -> Answer:
        if "mitsuba_scene" in job:
            mitsuba_scene.write(Path(job["mitsuba_scene"]))
            return {}
        return render(job, folder, bounces)

    return answer


if __name__ == "__main__":
    serve(__doc__, open_scene)
