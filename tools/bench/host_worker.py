"""Times export and upload in one Blender: `blender -b --python host_worker.py`, or a Python that has bpy.

Prints "RESULT " and a JSON object with the seconds of each repetition: "export" of a million triangles into a new
native scene, "upload" of one 1920×1080 RGBA pass into a new render result, and "refresh", a second upload into the same
result.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
import gradus  # noqa: E402
from gradus import store  # noqa: E402
from gradus.pixels import PassBuffer  # noqa: E402

REPETITIONS = 9
CELLS = 707  # of a grid, which has 2 · 707² triangles
WIDTH, HEIGHT = 1920, 1080


def export_seconds() -> float:
    """Times the export of a scene that was never exported before, so that everything is read and copied."""
    key = store.Key(store.FINAL, "bench", "bench", 0)
    session = store.acquire(key)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    start = time.perf_counter()
    session.sync(depsgraph, None, None, False, None)
    seconds = time.perf_counter() - start
    store.release(key)
    return seconds


class UploadEngine(bpy.types.RenderEngine):
    """Uploads one picture several times and times the last upload.

    The first one touches memory that Blender has not used yet.
    """

    bl_idname = "GRADUS_BENCH_UPLOAD"
    bl_label = "Upload"
    times = 1
    seconds = 0.0

    def render(self, _depsgraph: bpy.types.Depsgraph) -> None:
        result = self.begin_result(0, 0, WIDTH, HEIGHT)
        buffer = PassBuffer()
        buffer.prepare(result.layers[0].passes, {}, WIDTH, HEIGHT)
        for _ in range(UploadEngine.times):
            start = time.perf_counter()
            buffer.upload(result.layers[0])
            UploadEngine.seconds = time.perf_counter() - start
        self.end_result(result)


def upload_seconds(times: int) -> float:
    UploadEngine.times = times
    bpy.ops.render.render()
    return UploadEngine.seconds


def prepare() -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    gradus.register()
    bpy.utils.register_class(UploadEngine)
    scene = bpy.context.scene
    scene.render.engine = UploadEngine.bl_idname
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=CELLS, y_subdivisions=CELLS)


def main() -> None:
    prepare()
    measures = {"export": export_seconds, "upload": lambda: upload_seconds(1), "refresh": lambda: upload_seconds(2)}
    for measure in measures.values():  # the first call loads libraries and is not counted
        measure()
    seconds = {name: [measure() for _ in range(REPETITIONS)] for name, measure in measures.items()}
    print("RESULT " + json.dumps({"host": bpy.app.version_string, **seconds}), flush=True)
    os._exit(0)  # the module can hang at exit


main()
