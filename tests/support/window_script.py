"""Drives Blender's window from a timer, like a user: viewport, F12, Escape, previews.

tests/robustness/window_test.py starts it.

Arguments after "--": folder of the add-on, folder for screenshots and answers.json.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

ADDON, OUT = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1 :][:2])
sys.path.insert(0, str(ADDON))
del sys.argv[sys.argv.index("--") :]
import gradus  # noqa: E402

PATIENCE = 60.0  # s; the window is drawn in software
answers: dict[str, Any] = {}
events: list[str] = []


def shoot(name: str) -> None:
    subprocess.run(["import", "-window", "root", str(OUT / f"{name}.png")], check=True)


def press(key: str) -> None:
    subprocess.run(["xdotool", "mousemove", "300", "400", "key", key], check=True)


def wait(condition: Any) -> Iterator[float]:
    begin = time.monotonic()
    while not condition() and time.monotonic() - begin < PATIENCE:
        yield 0.1


def views() -> list[Any]:
    """Returns the engine's viewports. Blender does not list its engines, so that the garbage collector is asked."""
    import gc

    from gradus.viewport import View

    return [item for item in gc.get_objects() if type(item) is View and item.session.scene]


def shoot_when_done(name: str) -> Iterator[float]:
    """Takes a screenshot when the first viewport has finished the picture of a change."""
    yield 0.5
    yield from wait(lambda: views()[0].done)
    yield 1.0
    shoot(name)


def prepare() -> None:
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.view.render_display_type = "NONE"
    gradus.register()
    scene = bpy.context.scene
    scene.render.engine = "GRADUS"
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    scene.view_settings.view_transform = "Standard"
    scene.gradus.samples, scene.gradus.preview_samples, scene.gradus.noise_threshold = 4, 4, 0.0
    light = bpy.data.objects["Light"]
    light.data.type, light.data.energy, light.rotation_euler = "SUN", 5.0, (0.5, 0.3, 0.0)
    bpy.app.handlers.render_complete.append(lambda *_: events.append("complete"))
    bpy.app.handlers.render_cancel.append(lambda *_: events.append("cancel"))


def steps() -> Iterator[float]:
    window = bpy.context.window_manager.windows[0]
    area = next(item for item in window.screen.areas if item.type == "VIEW_3D")
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    yield 1.0
    shoot("solid")
    space.shading.type = "RENDERED"
    yield from wait(lambda: views() and views()[0].done)
    yield 1.0
    shoot("rendered")
    bpy.data.objects["Cube"].location.z = 1.5
    yield from shoot_when_done("moved")

    # Local View of the light alone hides the cube; Edit Mode does not.
    with bpy.context.temp_override(window=window, area=area, region=area.regions[-1]):
        for item in bpy.context.view_layer.objects:
            item.select_set(item.type == "LIGHT")
        bpy.ops.view3d.localview(frame_selected=False)
    yield from shoot_when_done("local")
    with bpy.context.temp_override(window=window, area=area, region=area.regions[-1]):
        bpy.ops.view3d.localview(frame_selected=False)
        bpy.context.view_layer.objects.active = bpy.data.objects["Cube"]
        bpy.ops.object.mode_set(mode="EDIT")
    yield from shoot_when_done("edited")
    with bpy.context.temp_override(window=window, area=area, region=area.regions[-1]):
        bpy.ops.object.mode_set(mode="OBJECT")
    yield 0.5
    yield from wait(lambda: views()[0].done)

    # Opens a second viewport, and presses F12 while both sample.
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    yield 0.5
    answers["areas"] = 0
    for item in window.screen.areas:
        if item.type == "VIEW_3D":
            item.spaces.active.shading.type = "RENDERED"
            answers["areas"] += 1
    bpy.data.objects["Cube"].location.z = 0.0
    yield 0.3
    press("F12")
    yield from wait(lambda: bool(events))
    answers["f12"] = events.copy()
    events.clear()
    yield from wait(lambda: all(view.done for view in views()))
    answers["views"] = len(views())
    yield 1.0
    shoot("two")
    bpy.data.images["Render Result"].save_render(str(OUT / "f12.png"))

    bpy.context.scene.gradus.samples = 100000
    press("F12")
    yield 2.0
    begin = time.monotonic()
    press("Escape")
    yield from wait(lambda: bool(events))
    answers["escape"], answers["escape_seconds"] = events.copy(), time.monotonic() - begin
    events.clear()
    yield 0.5
    bpy.data.images["Render Result"].save_render(str(OUT / "escape.png"))

    material = bpy.data.materials[0]
    with bpy.context.temp_override(window=window, area=area, id=material):
        bpy.ops.ed.lib_id_generate_preview()
    yield from wait(lambda: material.preview is not None and any(material.preview.image_pixels_float))
    answers["preview"] = max(material.preview.image_pixels_float, default=0.0)
    for item in window.screen.areas:
        if item.type == "VIEW_3D":
            item.spaces.active.shading.type = "SOLID"
    yield 1.0
    answers["views_left"] = len(views())


def run() -> float | None:
    try:
        return next(RUNNING)
    except StopIteration:
        answers["finished"] = True
    except Exception:
        answers["error"] = traceback.format_exc()
    (OUT / "answers.json").write_text(json.dumps(answers))
    bpy.ops.wm.quit_blender()
    return None


prepare()
RUNNING = steps()
bpy.app.timers.register(run, first_interval=2.0)
