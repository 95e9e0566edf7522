"""Times renders of the room in one host: `blender -b --python speed_worker.py -- ROOM WIDTH HEIGHT`, or a Python that has bpy.

Reads one JSON job per line, answers each with a line "RESULT " and JSON. Nothing is written: the pictures do not count here.
  {"mode": "path", "samples": 4, "seed": 0}  ->  {"cpu": 1.2, "wall": 0.7, "stages": {"export": …}, "rays": {…}, "peak_memory_bytes": …}
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "addon")]
import gradus  # noqa: E402
import memory  # noqa: E402
import modes  # noqa: E402
import room  # noqa: E402
from answers import Answers  # noqa: E402
from gradus import store  # noqa: E402
from rooms import ROOMS  # noqa: E402


def render(job: dict, bounces: int) -> dict:
    scene = bpy.context.scene
    modes.apply(scene, modes.MODES[job["mode"]], job["samples"], job["seed"])
    set_bounces(scene.gradus if scene.render.engine == modes.GRADUS else scene.cycles, bounces)
    memory.reset_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    bpy.ops.render.render()
    answer = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}
    answer["peak_memory_bytes"] = memory.peak_bytes()
    if scene.render.engine == modes.GRADUS:
        stats = store.summaries[(scene.name, scene.view_layers[0].name)]
        answer |= {"stages": stats["cpu_seconds"], "rays": stats["rays"]}
    return answer


def set_bounces(target: bpy.types.PropertyGroup, bounces: int) -> None:
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
        setattr(target, name, bounces)


def main() -> None:
    name, width, height = sys.argv[sys.argv.index("--") + 1 :]
    answers = Answers()
    gradus.register()
    triangles = room.build(ROOMS[name], int(width), int(height))
    answers.send({"blender": bpy.app.version_string, "triangles": triangles})
    for line in sys.stdin:
        try:
            answer = render(json.loads(line), ROOMS[name].bounces)
        except (ValueError, RuntimeError) as error:  # one failed job must not end the others
            answer = {"error": str(error)}
        answers.send(answer)
    os._exit(0)  # the 4.5 module can hang at exit


main()
