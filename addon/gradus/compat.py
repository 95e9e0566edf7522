"""Differences between Blender's versions that concern neither passes nor geometry."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from typing import Any

import bpy

VERSION: tuple[int, int, int] = tuple(bpy.app.version)
"""The version of the running Blender."""


def color_config_path() -> str:
    """Returns Blender's OpenColorIO configuration: the environment variable OCIO, else the bundled file."""
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
    """Returns the folder of the Python packages inside the bpy module, such as PyOpenColorIO.

    Returns "" in the application, where they are on the path.
    """
    if not getattr(bpy.app, "module", False):
        return ""
    root = Path(bpy.utils.resource_path("LOCAL")) / "python" / "lib"
    found = sorted(root.glob("python3.*/site-packages"))
    return str(found[-1]) if found else ""


def bundled_libraries() -> str:
    """Returns the folder of Blender's bundled libraries, or "" if it uses those of the system."""
    resources = bpy.utils.resource_path("LOCAL")
    folder = Path(resources).parent / "lib"
    return str(folder) if resources and folder.is_dir() else ""


def image_color_spaces() -> set[str]:
    """Returns the names of the colour spaces of all images.

    Blender's own viewer images are left out: they have no colour space, and reading it causes a warning in 5.2.
    """
    return {image.colorspace_settings.name for image in bpy.data.images if image.source != "VIEWER"}


def working_space() -> str:
    """Returns the colour space that the file renders in, or "" if it is always that of the configuration."""
    settings = getattr(bpy.data, "colorspace", None)
    return settings.working_space if settings is not None else ""


def has_other_working_space() -> bool:
    """Returns whether the file renders in another space than linear Rec. 709, which Blender can do since 5.0."""
    return working_space() not in {"", "Linear Rec.709"}


def is_data(settings: Any) -> bool:
    """Returns whether Cycles takes an image of these colour space settings as data.

    Cycles asks the OpenColorIO configuration. Blender 3.4 says so of its Non-Color only.
    """
    return settings.is_data or settings.name in {"Raw", "Utility - Raw"}


def default_surface_is_principled() -> bool:
    """Returns whether faces without a material are an unchanged Principled BSDF.

    Before 5.0 they are grey and diffuse.
    """
    return VERSION >= (5, 0, 0)


def has_one_more_transparent() -> bool:
    """Returns whether paths of Cycles pass one transparent surface more than its setting says, as before 5.0."""
    return VERSION < (5, 0, 0)


def has_background_motion() -> bool:
    """Returns whether the pass Vector of Cycles has the motion of the background, as from 5.2 on."""
    return VERSION >= (5, 2, 0)


def fixed_threads(render: Any) -> int:
    """Returns the number of threads that the scene sets, or 0 for all."""
    return render.threads if render.threads_mode == "FIXED" else 0


def as_float32(value: float) -> float:
    """Rounds to a C float, which Blender uses for borders."""
    return ctypes.c_float(value).value


def view_names(render: Any) -> list[str]:
    """Returns the names of the views to render, or [""] without multi-view."""
    if not render.use_multiview:
        return [""]
    views = [view.name for view in render.views if view.use]
    if render.views_format == "STEREO_3D":
        views = [name for name in views if name in ("left", "right")]
    return views or [""]


def action_curves(action: Any) -> list[Any]:
    """Returns all F-curves of an action, which may be None. From 4.4 on they are stored in channel bags."""
    if action is None:
        return []
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
    return [curve for bag in bags for curve in bag.fcurves]
