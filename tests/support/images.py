"""Rendering to a 32-bit multilayer EXR and reading all of its passes, in every Blender version."""

from __future__ import annotations

import uuid
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import OpenImageIO as oiio

# Pass name → array (height, width, channels), row 0 at the bottom, float32. Passes of all layers also by "Layer.Pass".
Passes = dict[str, np.ndarray]

# Place of a channel in its pass by the last part of its name: RGBA, XYZW, UVA, or one Z, V or X.
_PLACE = {"R": 0, "X": 0, "U": 0, "G": 1, "Y": 1, "V": 1, "B": 2, "Z": 2, "A": 3, "W": 4}


def prepare(scene: bpy.types.Scene) -> None:
    """Sets up a small and fast render with the Standard view transform."""
    render = scene.render
    render.engine = "GRADUS"
    render.resolution_x, render.resolution_y, render.resolution_percentage = 64, 36, 100
    render.use_compositing = render.use_sequencer = False
    scene.view_settings.view_transform = "Standard"
    for name, value in {"samples": 4, "noise_threshold": 0.0}.items():
        if hasattr(scene, "gradus") and hasattr(scene.gradus, name):
            setattr(scene.gradus, name, value)


def use_exr(scene: bpy.types.Scene, path: Path) -> None:
    """Sets the output to one 32-bit multilayer EXR."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
    scene.render.use_file_extension = False
    scene.render.filepath = str(path)


def render(scene: bpy.types.Scene, folder: Path, frame: int | None = None, **settings: Any) -> Passes:
    """Renders one frame; `settings` are set on scene.gradus first. Raises RuntimeError if Blender reports an error."""
    for name, value in settings.items():
        setattr(scene.gradus, name, value)
    if frame is not None:
        scene.frame_set(frame)
    path = folder / f"{uuid.uuid4().hex}.exr"
    use_exr(scene, path)
    bpy.ops.render.render(write_still=True, scene=scene.name)
    assert path.exists(), "Blender wrote no file"
    passes = read(path)
    path.unlink()
    return passes


def read(path: Path) -> Passes:
    """Returns all passes of a multilayer EXR: one part with all channels (3.4, 4.5) or one part per pass (5.0)."""
    channels: dict[str, list[tuple[int, np.ndarray]]] = {}
    file = oiio.ImageInput.open(str(path))
    if file is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    part = 0
    while file.seek_subimage(part, 0):
        spec = file.spec()
        pixels = np.asarray(file.read_image("float"), np.float32).reshape(spec.height, spec.width, spec.nchannels)
        for index, name in enumerate(spec.channelnames):
            pass_name, _, letter = name.rpartition(".")
            channels.setdefault(pass_name, []).append((_PLACE.get(letter.upper(), 5), np.flipud(pixels[:, :, index])))
        part += 1
    file.close()
    passes: Passes = {}
    for full_name, planes in channels.items():
        image = np.stack([plane for _, plane in sorted(planes, key=lambda plane: plane[0])], axis=2)
        passes[full_name] = image
        passes.setdefault(full_name.partition(".")[2], image)
    return passes
