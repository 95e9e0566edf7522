"""Runs inside Blender: renders frames of the open file, each once to both a multilayer EXR file and a PNG file.

render.py starts it and passes GRADUS_RENDER_OUT (path without frame number) and GRADUS_RENDER_FRAMES (JSON: [[first,
last], …]). It uses the operator instead of -f or -a, because only the operator makes the image that is saved as a PNG.
"""

from __future__ import annotations

import json
import os
import sys
import traceback

import bpy


def use_exr(settings: bpy.types.ImageFormatSettings) -> None:
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"


def use_png(settings: bpy.types.ImageFormatSettings, transparent: bool) -> None:
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format = "PNG"
    settings.color_mode = "RGBA" if transparent else "RGB"
    settings.color_depth = "8"


def save_png(scene: bpy.types.Scene, *_: object) -> None:
    """Saves the frame that was just written as a PNG file, too, with the scene's display transform."""
    path = os.path.splitext(scene.render.frame_path(frame=scene.frame_current))[0] + ".png"
    settings = scene.render.image_settings
    use_png(settings, scene.render.film_transparent)
    try:
        bpy.data.images["Render Result"].save_render(path, scene=scene)
    except Exception:  # Blender drops exceptions of handlers; render.py reports the missing file
        traceback.print_exc()
    finally:
        use_exr(settings)


def main() -> None:
    scene = bpy.context.scene
    render = scene.render
    render.filepath = os.environ["GRADUS_RENDER_OUT"]
    render.use_file_extension = render.use_overwrite = True
    render.use_placeholder = False
    scene.frame_step = 1
    use_exr(render.image_settings)
    bpy.app.handlers.render_write.append(save_png)
    for first, last in json.loads(os.environ["GRADUS_RENDER_FRAMES"]):
        scene.frame_start, scene.frame_end = first, last
        bpy.ops.render.render(animation=True)


try:
    main()
except RuntimeError as error:  # the engine reported an error, whose message is in the log already
    print(f"render: {str(error).strip()}", flush=True)
    sys.exit(1)
