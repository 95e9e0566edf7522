"""Checks around the files that Blender writes itself: a full disk gives short files and exit code 0 there (contract 9.3)."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import file_check
from .failure import Failure
from .passes import PassInfo

MARGIN_BYTES = 1 << 20
"""Metadata, and what else writes to the disk meanwhile."""

LONGEST_CHANNEL = 64
"""Bytes of a channel's name that Blender before 5.0 writes into an OpenEXR file: of channels that are called the same then, one is left."""


def make_folder(path: str) -> Path:
    """The folder of `path`. Blender makes a missing one only when it writes, and forgets to tell."""
    folder = Path(path).absolute().parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Failure(f"output folder {folder} cannot be created: {error.strerror}") from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise Failure(f"output folder {folder} cannot be written to")
    return folder


def require_space(path: str, needed: int) -> None:
    """Raises Failure if the file system of `path` has less than `needed` bytes free."""
    folder = make_folder(path)
    try:
        free = shutil.disk_usage(folder).free
    except OSError as error:
        raise Failure(f"output folder {folder}: {error.strerror}") from error
    if free < needed + MARGIN_BYTES:
        raise Failure(f"not enough space in {folder}: {free >> 20} MiB free, {(needed + MARGIN_BYTES) >> 20} MiB needed")


def cut_names(settings: Any, layer: str, views: Iterable[str], infos: Iterable[PassInfo], version: tuple[int, ...]) -> list[str]:
    """A warning about the passes of a layer that a file of these image settings will lose."""
    if version >= (5, 0, 0) or settings.file_format != "OPEN_EXR_MULTILAYER":
        return []
    longest_view = max((len(f".{view}".encode()) for view in views if view and settings.views_format == "MULTIVIEW"), default=0)
    room = LONGEST_CHANNEL - longest_view - len(".X")
    cut = [name for name in (info.blender_name(version) for info in infos) if len(f"{layer}.{name}".encode()) > room]
    if not cut:
        return []
    others = f" and {len(cut) - 1} others" if len(cut) > 1 else ""
    return [f"OpenEXR files of this Blender lose pass '{cut[0]}'{others} of layer '{layer}': their names are too long"]


def require_whole(path: str) -> None:
    """Raises Failure if the file of the frame before is cut short. One that is gone was moved by a script: that is no fault."""
    try:
        whole = file_check.is_whole(Path(path))
    except OSError:
        return
    if not whole:
        raise Failure(f"the frame before was not written as a whole: {path}")


@dataclass
class FrameFiles:
    """Follows the frames of one animation. `previous`: the file that must be whole when the next frame starts."""

    previous: str = ""

    def before_frame(self, render: Any, frame: int, frame_bytes: int) -> None:
        """`frame_bytes`: size of the passes in memory; no format that Blender writes needs more."""
        previous, self.previous = self.previous, ""
        if previous:
            require_whole(previous)
        path = render.frame_path(frame=frame)
        if path:
            require_space(path, frame_bytes)

    def after_frame(self, render: Any, frame: int) -> None:
        if not render.is_movie_format and not render.use_multiview:
            self.previous = render.frame_path(frame=frame)
