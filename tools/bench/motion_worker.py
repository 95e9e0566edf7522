"""Renders ranges of frames with passes of components inside the Python module bpy: one process for each scene.

Reads one JSON job per line from standard input and answers each with one JSON line, prefixed by RESULT:
  {"mode": "windows-components-l2", "samples": 16, "seed": 3, "frames": [8, 13], "shutter": 0.0, "passes": [],
   "out": "x.npy"}
    -> {"cpu": 9.1, "wall": 4.7, "peak_memory_bytes": ..., "seconds": [{"sample": 0.9, ...}, ...]}
Frames are stored as float32 (frames, height, width, 3), top row first; "seconds" are CPU seconds of each frame by
phases. A job with "passes" (some of SWITCHES) stores the picture and these passes by name in an .npz file, with one to
four channels; their time counts, too. A job with "scene" instead of "mode" saves the frame "frame" for the tool. A job
that cannot be done is answered by {"error": "why"}.
"""

from __future__ import annotations

import sys
from collections.abc import Collection
from pathlib import Path

import animation_worker
import bpy
import modes
import motion_modes
import numpy as np
import worker  # makes the add-on importable
from gradus import passes
from paths import HERE
from worker import Answer, AnswerJob, Job

sys.path.insert(0, str(HERE.parent))
import component_sheet  # noqa: E402

VECTOR = "vector"
PREFIX = "use_pass_"
COMPONENT_SWITCHES = tuple(name.removeprefix(PREFIX) for name in passes.COMPONENT_SWITCHES)
SWITCHES = (VECTOR, *COMPONENT_SWITCHES)
FOLLOWED = (
    "vector",
    "components",
    "component_reflectance",
    "component_motion",
)  # passes of a frame that is saved for the tool


def set_passes(layer: bpy.types.ViewLayer, wanted: Collection[str]) -> None:
    """Switches these passes on and all others off."""
    if unknown := set(wanted) - set(SWITCHES):
        raise ValueError(f"no passes: {', '.join(sorted(unknown))}")
    layer.use_pass_vector = VECTOR in wanted
    for name in COMPONENT_SWITCHES:
        setattr(layer.gradus, PREFIX + name, name in wanted)
    worker.choose_file(with_passes=bool(wanted))


def set_up(job: Job) -> None:
    scene, layer = bpy.context.scene, bpy.context.view_layer
    for name in motion_modes.ALONG_SURFACES:
        scene.gradus.property_unset(name)
    modes.apply(scene, motion_modes.MODES[job["mode"]], job["samples"], job["seed"])
    animation_worker.set_motion_blur(scene, layer, job["shutter"])
    scene.gradus.vector_with_motion_blur = True
    set_passes(layer, job.get("passes", ()))


def render(job: Job, folder: Path) -> Answer:
    set_up(job)
    answer, files, seconds = animation_worker.render_timed(job["frames"], folder)
    if job.get("passes"):
        np.savez(job["out"], **passes_of(files))
    else:
        np.save(job["out"], np.stack([worker.read_exr(file, list("RGB")) for file in files]))
    animation_worker.remove(files)
    return answer | {"seconds": seconds}


def passes_of(files: list[Path]) -> dict[str, np.ndarray]:
    """Returns the picture, Vector, and all passes of components."""
    frames = [component_sheet.read(file) for file in files]
    names = [name for name in frames[0] if name in ("Combined", "Vector") or name.startswith("Path ")]
    stacked = {name: np.stack([frame[name] for frame in frames]) for name in names}
    return {name: pixels[..., : 4 if has_two_vectors(name) else 3] for name, pixels in stacked.items()}


def has_two_vectors(name: str) -> bool:
    return name == "Vector" or name.endswith(" Motion")


def save_scene(job: Job, folder: Path) -> Answer:
    """Renders one sample, which also saves the scene for the tool."""
    set_up({"mode": "components", "samples": 1, "seed": 0, "shutter": job["shutter"], "passes": FOLLOWED})
    with animation_worker.options(save_scene=job["scene"]):
        answer, files = animation_worker.render_range((job["frame"], job["frame"]), folder)
    animation_worker.remove(files)
    return answer


def open_scene(path: str, width: int, height: int) -> AnswerJob:
    animation_worker.open_scene(path, width, height)
    bpy.context.scene.use_nodes = False
    return lambda job, folder: save_scene(job, folder) if "scene" in job else render(job, folder)


if __name__ == "__main__":
    worker.serve(__doc__, open_scene)
