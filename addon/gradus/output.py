"""Checks of the files that Blender writes.

On a full disk Blender writes truncated files and still exits with code 0.
"""

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
"""Free space that is required beyond the size of the passes, for metadata and other writers."""

MAX_CHANNEL_BYTES = 64
"""Bytes of a channel's name that Blender before 5.0 writes into an OpenEXR file.

Channels of equal truncated names replace each other.
"""


def make_folder(path: str) -> Path:
    """Creates and returns the folder of `path`.

    Raises Failure if that is impossible, which Blender would not report.
    """
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
        required = (needed + MARGIN_BYTES) >> 20
        raise Failure(f"not enough space in {folder}: {free >> 20} MiB free, {required} MiB needed")


def truncated_names(
    settings: Any, layer: str, views: Iterable[str], infos: Iterable[PassInfo], version: tuple[int, ...]
) -> list[str]:
    """Returns a warning if a file with these image settings will lose passes whose names are too long."""
    if version >= (5, 0, 0) or settings.file_format != "OPEN_EXR_MULTILAYER":
        return []
    has_views = settings.views_format == "MULTIVIEW"
    longest_view = max((len(f".{view}".encode()) for view in views if view and has_views), default=0)
    room = MAX_CHANNEL_BYTES - longest_view - len(".X")
    names = (info.blender_name(version) for info in infos)
    lost = [name for name in names if len(f"{layer}.{name}".encode()) > room]
    if not lost:
        return []
    others = f" and {len(lost) - 1} others" if len(lost) > 1 else ""
    return [f"OpenEXR files of this Blender lose pass '{lost[0]}'{others} of layer '{layer}': their names are too long"]


def require_complete(path: str) -> None:
    """Raises Failure if the file of the previous frame is truncated.

    A file that is missing may have been moved by a script.
    """
    try:
        complete = file_check.is_complete(Path(path))
    except OSError:
        return
    if not complete:
        raise Failure(f"the file of the previous frame is truncated: {path}")


@dataclass
class FrameFiles:
    """Checks the files of one animation. `previous` is the file that must be complete when the next frame starts."""

    previous: str = ""

    def before_frame(self, render: Any, frame: int, frame_bytes: int) -> None:
        """Checks the previous frame's file and the free space.

        frame_bytes: size of the passes in memory, which is the maximum for all formats that Blender writes.
        """
        previous, self.previous = self.previous, ""
        if previous:
            require_complete(previous)
        path = render.frame_path(frame=frame)
        if path:
            require_space(path, frame_bytes)

    def after_frame(self, render: Any, frame: int) -> None:
        if not render.is_movie_format and not render.use_multiview:
            self.previous = render.frame_path(frame=frame)
