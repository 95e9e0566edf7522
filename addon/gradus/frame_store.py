"""Where the raw frames of a scene are kept: STORE/<scene>/<layer>[.<view>]/f<frame>.exr of a frame on its own, and .base.exr and
.offset.exr of one of an animation, which the library writes (contract 7.2). None takes the place of another."""

from __future__ import annotations

import ctypes
from ctypes import byref
from pathlib import Path
from typing import Any

from . import native
from .failure import Failure

_SAFE = frozenset("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-")


def escape(name: str) -> str:
    """A name as one folder name: other bytes as %XX, so that two names never meet."""
    return "".join(chr(byte) if chr(byte) in _SAFE else f"%{byte:02X}" for byte in name.encode("utf-8", "surrogateescape"))


def folder_of(folder: str, scene: str, layer: str, view: str) -> Path:
    last = f"{escape(layer)}.{escape(view)}" if view else escape(layer)
    return Path(folder) / escape(scene) / last


def frame_path(folder: str, scene: str, layer: str, view: str, frame: int) -> Path:
    return folder_of(folder, scene, layer, view) / f"f{frame:+08d}.exr"


def save(library: native.Library, render: int, folder: str, scene: Any, layer: Any, view: str) -> None:
    """The library writes under a temporary name and renames: a file is whole or absent."""
    path = frame_path(folder, scene.name, layer.name, view, scene.frame_current)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Failure(f"frame store {path.parent}: {error.strerror}") from error
    frame = ctypes.c_uint64()
    library.render_frame(render, byref(frame))
    try:
        library.frame_save(frame.value, native.text(str(path)))
    finally:
        library.frame_release(frame.value)
