"""Renders jobs of the benchmark inside the Python module bpy: one process per scene, so that modes interleave in one run.

Reads one JSON job per line from standard input, answers with one JSON line prefixed by RESULT:
  {"mode": "gradient-l2", "samples": 16, "seed": 3, "out": "x.npy"}  ->  {"cpu": 1.2, "wall": 0.7}
A job with "bounces" replaces all bounce limits of the file.
The image is stored as float32 (height, width, 3), top row first. CPU seconds are those of the whole process during the operator:
export, build, sampling, reconstruction, and writing a small file.
"""

from __future__ import annotations

import argparse
import atexit
import json
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "addon"))
import gradus  # noqa: E402

GRADUS_MODES = {
    "path": ("PATH", "NONE"),
    "gradient-none": ("GRADIENT", "NONE"),
    "gradient-l2": ("GRADIENT", "L2"),
    "gradient-l1": ("GRADIENT", "L1"),
}
CYCLES_DEFAULTS = (
    "use_adaptive_sampling", "adaptive_threshold", "use_guiding", "use_light_tree", "blur_glossy", "sample_clamp_direct",
    "sample_clamp_indirect", "pixel_filter_type", "filter_width",
)  # fmt: skip
BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces")


def prepare(path: str, width: int, height: int) -> None:
    bpy.ops.wm.open_mainfile(filepath=path)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_persistent_data = False
    render.use_compositing = render.use_sequencer = False
    render.use_motion_blur = False
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"


def set_cycles(scene: bpy.types.Scene, job: dict) -> None:
    cycles = scene.cycles
    scene.render.engine = "CYCLES"
    cycles.samples, cycles.seed = job["samples"], job["seed"]
    cycles.use_denoising = job["mode"] == "cycles-denoised"
    if cycles.use_denoising:
        cycles.denoiser, cycles.denoising_prefilter, cycles.denoising_input_passes = "OPENIMAGEDENOISE", "ACCURATE", "RGB_ALBEDO_NORMAL"
    for name in CYCLES_DEFAULTS:
        cycles.property_unset(name)
    if job["mode"] != "cycles-default":
        cycles.use_adaptive_sampling = cycles.use_guiding = False
        cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    set_bounces(cycles, scene.cycles, job)


def set_gradus(scene: bpy.types.Scene, job: dict) -> None:
    settings = scene.gradus
    scene.render.engine = "GRADUS"
    settings.samples, settings.seed, settings.noise_threshold = job["samples"], job["seed"], 0.0
    settings.integrator, settings.reconstruction = GRADUS_MODES[job["mode"]]
    set_bounces(settings, scene.cycles, job)


def set_bounces(target: bpy.types.PropertyGroup, cycles: bpy.types.PropertyGroup, job: dict) -> None:
    """The limits of the file, or the job's one limit for all kinds."""
    for name in BOUNCES:
        stored = FILE_BOUNCES.setdefault(name, getattr(cycles, name))
        setattr(target, name, job.get("bounces", stored))


FILE_BOUNCES: dict[str, int] = {}  # as the file has them, before the first job


def render(job: dict, folder: Path) -> dict:
    scene = bpy.context.scene
    (set_cycles if job["mode"].startswith("cycles") else set_gradus)(scene, job)
    target = folder / "image.exr"
    scene.render.filepath = str(target.with_suffix(""))
    wall, cpu = time.perf_counter(), time.process_time()
    bpy.ops.render.render(write_still=True)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    np.save(job["out"], read_exr(target))
    return {"cpu": cpu, "wall": wall}


def read_exr(path: Path) -> np.ndarray:
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.channels()
        return np.stack([np.asarray(channels[c].pixels, dtype=np.float32) for c in "RGB"], axis=2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("width", type=int)
    parser.add_argument("height", type=int)
    arguments = parser.parse_args()
    gradus.register()
    atexit.register(gradus.unregister)
    prepare(arguments.scene, arguments.width, arguments.height)
    with tempfile.TemporaryDirectory() as folder:
        for line in sys.stdin:
            job = json.loads(line)
            try:
                answer = render(job, Path(folder))
            except Exception as error:  # one failed job must not end the others
                answer = {"error": str(error)}
            print("RESULT " + json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
