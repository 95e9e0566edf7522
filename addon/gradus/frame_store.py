"""Paths of raw frames: STORE/<scene>/<layer>[.<view>]/f<frame>.exr for a frame that is rendered independently.

The frames of an animation are stored in the same folder as f<frame>.fresh.exr and f<frame>.replayed.exr, which the
library writes.
"""

from __future__ import annotations

import ctypes
from ctypes import byref
from pathlib import Path
from typing import Any

from . import native
from .failure import Failure

_SAFE = frozenset("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-")


def escape(name: str) -> str:
    """Returns a name as a folder name.

    Bytes that are not safe in file names become %XX, so that different names stay different.
    """
    encoded = name.encode("utf-8", "surrogateescape")
    return "".join(chr(byte) if chr(byte) in _SAFE else f"%{byte:02X}" for byte in encoded)


def folder_of(folder: str, scene: str, layer: str, view: str) -> Path:
    last = f"{escape(layer)}.{escape(view)}" if view else escape(layer)
    return Path(folder) / escape(scene) / last


def frame_path(folder: str, scene: str, layer: str, view: str, frame: int) -> Path:
    return folder_of(folder, scene, layer, view) / f"f{frame:+08d}.exr"


def written_at(folder: Path, frame: int) -> int:
    """Returns when the samples of a frame of an animation were written, in nanoseconds, or 0 if there are none."""
    try:
        return (folder / f"f{frame:+08d}.fresh.exr").stat().st_mtime_ns
    except OSError:
        return 0


def drop(folder: Path, frame: int) -> None:
    """Deletes the films of a frame of an animation."""
    for ending in ("fresh.exr", "replayed.exr", "json"):
        (folder / f"f{frame:+08d}.{ending}").unlink(missing_ok=True)


def save(library: native.Library, render: int, folder: str, scene: Any, layer: Any, view: str) -> None:
    """Saves the raw frame of a render.

    The library writes to a temporary file first, so that a file is complete or absent.
    """
    path = frame_path(folder, scene.name, layer.name, view, scene.frame_current)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Failure(f"frame store {path.parent}: {error.strerror}") from error
    frame = ctypes.c_uint64()
    library.render_film(render, byref(frame))
    try:
        library.film_save(frame.value, native.text(str(path)))
    finally:
        library.film_release(frame.value)
