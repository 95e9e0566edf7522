"""Times renders of a room of rooms.py in the Python module bpy: speed_worker.py ROOM WIDTH HEIGHT

Sends {"triangles": n} at first, then reads one JSON job per line and answers each with a line "RESULT " and JSON. No
file is written.
  {"mode": "path", "samples": 4, "seed": 0}
    -> {"cpu": 1.2, "wall": 0.7, "stages": {...}, "rays": {...}, "peak_memory_bytes": ...}
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

import bpy
import modes
import room
import worker
from rooms import ROOMS
from worker_process import Answers


def render(job: dict[str, Any], bounces: int) -> dict[str, Any]:
    scene = bpy.context.scene
    modes.apply(scene, modes.MODES[job["mode"]], job["samples"], job["seed"])
    is_gradus = scene.render.engine == modes.GRADUS
    for name in worker.BOUNCES:
        setattr(scene.gradus if is_gradus else scene.cycles, name, bounces)
    answer = worker.timed(bpy.ops.render.render)
    if is_gradus:
        stats = worker.store.summaries[(scene.name, scene.view_layers[0].name)]
        answer |= {"stages": stats["cpu_seconds"], "rays": stats["rays"]}
    return answer


def main() -> None:
    name, width, height = sys.argv[1:]
    answers = Answers()
    worker.gradus.register()
    answers.send({"triangles": room.build(ROOMS[name], int(width), int(height))})
    for line in sys.stdin:
        try:
            answer = render(json.loads(line), ROOMS[name].bounces)
        except (ValueError, RuntimeError) as error:  # one failed job must not end the others
            answer = {"error": str(error)}
        answers.send(answer)
    os._exit(0)  # the module can hang at exit


main()
