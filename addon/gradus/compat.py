"""Differences between Blender's versions that are neither passes nor geometry, by feature probe."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from typing import Any

import bpy

VERSION: tuple[int, int, int] = tuple(bpy.app.version)
"""Of the running Blender."""


def color_config_path() -> str:
    """OpenColorIO configuration that this Blender uses: the variable OCIO if it is set, else the one that came with it."""
    chosen = os.environ.get("OCIO")
    if chosen:
        return chosen
    for kind in ("LOCAL", "SYSTEM"):
        folder = bpy.utils.resource_path(kind)
        path = Path(folder) / "datafiles" / "colormanagement" / "config.ocio"
        if folder and path.is_file():
            return str(path)
    return ""


def bundled_python_packages() -> str:
    """Folder of the Python packages inside the bpy module (PyOpenColorIO among them); "" in the application, where they are on the path."""
    if not getattr(bpy.app, "module", False):
        return ""
    root = Path(bpy.utils.resource_path("LOCAL")) / "python" / "lib"
    found = sorted(root.glob("python3.*/site-packages"))
    return str(found[-1]) if found else ""


def bundled_libraries() -> str:
    """Folder of the libraries that Blender brings along; "" where it uses the system's."""
    resources = bpy.utils.resource_path("LOCAL")
    folder = Path(resources).parent / "lib"
    return str(folder) if resources and folder.is_dir() else ""


def image_color_spaces() -> set[str]:
    """Names of the colour spaces of all images but Blender's own viewers, which have none: 5.2 warns when theirs is read."""
    return {image.colorspace_settings.name for image in bpy.data.images if image.source != "VIEWER"}


def default_surface_is_principled() -> bool:
    """Faces without a material are an untouched Principled BSDF; before 5.0 a grey diffuse."""
    return VERSION >= (5, 0, 0)


def fixed_threads(render: Any) -> int:
    """Threads that the scene asks for; 0 = all."""
    return render.threads if render.threads_mode == "FIXED" else 0


def as_float32(value: float) -> float:
    """Rounds like a C float, in which Blender computes borders."""
    return ctypes.c_float(value).value


def view_names(render: Any) -> list[str]:
    """Names of the views to render, [""] without multi-view."""
    if not render.use_multiview:
        return [""]
    views = [view.name for view in render.views if view.use]
    if render.views_format == "STEREO_3D":
        views = [name for name in views if name in ("left", "right")]
    return views or [""]


def action_curves(action: Any) -> list[Any]:
    """F-curves of an action, whoever it moves; none of none. From 4.4 on they lie in channel bags."""
    if action is None:
        return []
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    return [curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves]
