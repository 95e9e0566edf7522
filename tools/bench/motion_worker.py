"""Renders ranges of frames with the passes of their components inside the Python module bpy: one process per scene, as animation_worker.py.

Reads one JSON job per line from standard input, answers with one JSON line prefixed by RESULT:
  {"mode": "windows-parts-l2", "samples": 16, "seed": 3, "frames": [8, 13], "shutter": 0.0, "passes": [], "out": "x.npy"}
  ->  {"cpu": 9.1, "wall": 4.7, "peak_memory_bytes": …, "seconds": [{"sample": 0.9, …}, …]}
Stored is float32 (frames, height, width, 3), top row first; "seconds" are CPU seconds of each frame by phases. A job with "passes"
(some of SWITCHES) stores in an .npz the picture and these by their names, of one to four channels; their time counts, too. A job with
"scene" in place of "mode" saves the frame "frame" for the tool, with vectors. What cannot be done is {"error": "why"}.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import animation_worker
import bpy
import modes
import motion_modes
import numpy as np
import worker

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import component_sheet  # noqa: E402

VECTOR = "vector"
OF_COMPONENTS = (
    "components", "component_reflectance", "component_irradiance", "component_normal", "component_depth", "component_uv",
    "component_index", "component_emit", "component_motion", "component_irradiance_motion",
)  # fmt: skip
SWITCHES = (VECTOR, *OF_COMPONENTS)
FOLLOWED = ("vector", "components", "component_reflectance", "component_motion")  # what the tool's scenes are of


@contextmanager
def options(**values: str) -> Iterator[None]:
    """Options of the add-on, as after `--`."""
    before = list(sys.argv)
    sys.argv += ["--", *(text for name, value in values.items() for text in (f"--gradus-{name.replace('_', '-')}", value))]
    try:
        yield
    finally:
        sys.argv[:] = before


def set_passes(layer: bpy.types.ViewLayer, wanted: Collection[str]) -> None:
    """These and no others."""
    if unknown := set(wanted) - set(SWITCHES):
        raise ValueError(f"no passes: {', '.join(sorted(unknown))}")
    layer.use_pass_vector = VECTOR in wanted
    for name in OF_COMPONENTS:
        setattr(layer.gradus, f"use_pass_{name}", name in wanted)
    worker.choose_file(layers=bool(wanted))


def set_up(job: dict) -> None:
    scene, layer = bpy.context.scene, bpy.context.view_layer
    for name in motion_modes.ALONG_SURFACES.keys() & scene.gradus.bl_rna.properties.keys():
        scene.gradus.property_unset(name)
    modes.apply(scene, motion_modes.MODES[job["mode"]], job["samples"], job["seed"])
    animation_worker.set_motion_blur(scene, layer, job["shutter"])
    scene.gradus.vector_with_motion_blur = True
    set_passes(layer, job.get("passes", ()))


def render(job: dict, folder: Path) -> dict:
    set_up(job)
    stats = folder / "stats.jsonl"
    stats.unlink(missing_ok=True)
    with options(stats=str(stats)):
        answer, files = animation_worker.render_range(job["frames"], folder)
    if job.get("passes"):
        np.savez(job["out"], **passes_of(files))
    else:
        np.save(job["out"], np.stack([worker.read_exr(file, list("RGB")) for file in files]))
    animation_worker.remove(files)
    return answer | {"seconds": [json.loads(line)["cpu_seconds"] for line in stats.read_text().splitlines()]}


def passes_of(files: list[Path]) -> dict[str, np.ndarray]:
    """The picture, Vector, and all of components."""
    frames = [component_sheet.read(file) for file in files]
    names = [name for name in frames[0] if name in ("Combined", "Vector") or name.startswith("Path ")]
    return {name: np.stack([passes[name] for passes in frames])[..., : 4 if is_of_two_steps(name) else 3] for name in names}


def is_of_two_steps(name: str) -> bool:
    return name == "Vector" or name.endswith(" Motion")


def save_scene(job: dict, folder: Path) -> dict:
    """By a render of one sample: what is saved is what is rendered."""
    set_up({"mode": "parts", "samples": 1, "seed": 0, "shutter": job["shutter"], "passes": FOLLOWED})
    with options(save_scene=job["scene"]):
        answer, files = animation_worker.render_range((job["frame"], job["frame"]), folder)
    animation_worker.remove(files)
    return answer


def open_scene(path: str, width: int, height: int) -> Callable[[dict, Path], dict]:
    animation_worker.open_scene(path, width, height)
    bpy.context.scene.use_nodes = False
    return lambda job, folder: save_scene(job, folder) if "scene" in job else render(job, folder)


if __name__ == "__main__":
    worker.serve(__doc__, open_scene)
