"""Renders jobs of worker.py with Mitsuba 3, from a scene of mitsuba_scene.py. Runs in .venv/bench.

The path tracer is vectorized if LLVM is installed (tools/setup/debian-bench.txt), which is about three times as fast as
its scalar variant. Loading the scene counts, as export and build do in Blender. The pixel filter is a box, because
Mitsuba has no Blackman-Harris filter.
"""

from __future__ import annotations

import argparse
import glob
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

PASS_SAMPLES = 64  # maximum of one pass, whose paths are all in memory at the same time

for library in sorted(glob.glob("/usr/lib/*/libLLVM.so.19.1")):
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", library)
import mitsuba as mi  # noqa: E402
from worker_process import Answers, peak_bytes, reset_peak  # noqa: E402


def set_variant() -> str:
    """Selects the vectorized variant, or the scalar one if that does not load."""
    for variant in ("llvm_ad_rgb", "scalar_rgb"):
        try:
            mi.set_variant(variant)
            return variant
        except ImportError:
            continue
    raise RuntimeError("Mitsuba has none of its variants here")


def load(path: str, width: int, height: int) -> mi.Scene:
    stored = np.load(path)
    facts = json.loads(str(stored["facts"]))
    scene = {
        "type": "scene",
        "integrator": {
            "type": "path",
            "max_depth": facts["max_bounces"] + 2,
        },  # counts the segments to camera and light
    }
    scene["sensor"] = sensor(facts["camera"], width, height)
    if max(facts["world"]) > 0.0:
        scene["world"] = {"type": "constant", "radiance": {"type": "rgb", "value": facts["world"]}}
    for i, material in enumerate(facts["meshes"]):
        scene[f"mesh{i}"] = mesh(f"mesh{i}", stored[f"vertices{i}"], stored[f"triangles{i}"], material)
    return mi.load_dict(scene)


def sensor(camera: dict[str, Any], width: int, height: int) -> dict[str, Any]:
    matrix = np.array(camera["matrix"])
    origin = matrix[:3, 3]
    to_world = mi.ScalarTransform4f().look_at(
        origin.tolist(), (origin - matrix[:3, 2]).tolist(), matrix[:3, 1].tolist()
    )
    film = {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb", "component_format": "float32"}
    film["rfilter"] = {"type": "box"}
    return {
        "type": "perspective", "to_world": to_world, "fov": float(np.degrees(camera["angle_x"])), "fov_axis": "x",
        "near_clip": camera["clip_start"], "far_clip": camera["clip_end"],
        "film": film, "sampler": {"type": "multijitter"},
    }  # fmt: skip


def mesh(name: str, vertices: np.ndarray, triangles: np.ndarray, material: dict[str, Any]) -> mi.Mesh:
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf(material))
    if material["kind"] == "emission":
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": {"type": "rgb", "value": material["color"]}})
    made = mi.Mesh(name, len(vertices), len(triangles), props=properties)
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = vertices.ravel()
    parameters["faces"] = triangles.ravel()
    parameters.update()
    return made


def bsdf(material: dict[str, Any]) -> dict[str, Any]:
    color = {"type": "rgb", "value": material["color"]}
    if material["kind"] == "glass":
        return {
            "type": "dielectric",
            "int_ior": material["ior"],
            "ext_ior": 1.0,
            "specular_reflectance": color,
            "specular_transmittance": color,
        }
    if material["kind"] == "mirror":
        return {"type": "twosided", "bsdf": {"type": "conductor", "material": "none", "specular_reflectance": color}}
    if material["kind"] == "emission":
        color = {"type": "rgb", "value": [0.0, 0.0, 0.0]}
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color}}


def render(job: dict[str, Any], path: str, width: int, height: int) -> dict[str, Any]:
    reset_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    scene = load(path, width, height)
    image = np.zeros((height, width, 3))
    for start in range(0, job["samples"], PASS_SAMPLES):
        count = min(PASS_SAMPLES, job["samples"] - start)
        image += np.array(mi.render(scene, spp=count, seed=(job["seed"] << 16) + start)) * (count / job["samples"])
    answer = {
        "cpu": time.process_time() - cpu,
        "wall": time.perf_counter() - wall,
        "peak_memory_bytes": peak_bytes(),
    }
    np.save(job["out"], image.astype(np.float32))
    return answer


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("width", type=int)
    parser.add_argument("height", type=int)
    arguments = parser.parse_args()
    answers = Answers()
    set_variant()
    for line in sys.stdin:
        try:
            answer = render(json.loads(line), str(arguments.scene), arguments.width, arguments.height)
        except Exception as error:  # one failed job must not end the others
            answer = {"error": str(error)}
        answers.send(answer)


if __name__ == "__main__":
    main()
