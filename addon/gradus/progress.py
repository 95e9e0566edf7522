"""What the user sees of a render that runs in the library, and how it is waited for."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import byref
from typing import Any

import bpy

from . import compat, native, passes
from .failure import Failure
from .native import Error, GradusError, Phase
from .store import POLL_SECONDS

_SHOWN = frozenset((passes.Pass.COMBINED, passes.Pass.NOISY_IMAGE))


def is_watched() -> bool:
    return not bpy.app.background


def wait(job: Any, handle: int, display: Display, result: Any = None) -> None:
    """Until the library is done; a cancelled render ends well, too: what it has so far is there. result: where the picture grows."""
    library = job.session.library
    picture = LivePicture(job, handle, result) if result is not None and is_watched() else None
    progress = native.Progress()
    running = True
    while running:
        try:
            running = library.render_wait(handle, POLL_SECONDS) == Error.TIMEOUT
        except GradusError as error:
            if error.code != Error.CANCELLED:
                raise
            job.cancelled = True
            running = False
        if running and not job.cancelled and job.stop():
            job.cancelled = True
            library.render_cancel(handle)
        library.render_poll(handle, byref(progress))
        display.show(progress)
        if picture is not None:
            picture.show(progress)


class Display:
    """Progress text and bar, of one render after the other: often enough to be lively, seldom enough to cost nothing."""

    TEXT_SECONDS = 1.0

    def __init__(self, job: Any) -> None:
        self.job = job
        self.next_text = time.monotonic()
        self.follow()

    def follow(self, label: str = "", done: float = 0.0, share: float = 1.0) -> None:
        """The render to come: what its text begins with, where the bar is, and how much of the bar is its."""
        self.label, self.done, self.share = label, done, share

    def show(self, progress: native.Progress) -> None:
        engine, now = self.job.engine, time.monotonic()
        engine.update_progress(self.done + self.share * progress.fraction)
        if now >= self.next_text:
            self.next_text = now + self.TEXT_SECONDS
            engine.update_stats("", f"Gradus: {self.label}{self._text(progress)}")
            engine.update_memory_stats(memory_used=progress.memory_bytes / 2**20, memory_peak=progress.peak_memory_bytes / 2**20)

    def _text(self, progress: native.Progress) -> str:
        if progress.phase == Phase.RECONSTRUCTING:
            return "reconstructing"
        return f"sample {progress.samples_done}/{self.job.shot.settings.samples}, {100.0 * progress.fraction:.0f} %"


class LivePicture:
    """The picture so far of a render, where somebody looks."""

    FIRST_REFRESH, LONGEST_REFRESH = 0.5, 16.0  # s between pictures; each one waits longer than the one before

    def __init__(self, job: Any, handle: int, result: Any) -> None:
        self.job, self.handle, self.result = job, handle, result
        self.start = time.monotonic()
        self.refresh = self.FIRST_REFRESH
        self.next_refresh = self.start + self.refresh
        self.version = 0
        job.read(handle, frozenset((passes.Pass.COMBINED,)))  # there is nothing yet, but the library knows then that somebody looks

    def show(self, progress: native.Progress) -> None:
        now = time.monotonic()
        if progress.version != self.version and now >= self.next_refresh:
            self.version = progress.version
            self._draw()
            self.next_refresh = time.monotonic() + self.refresh
            if now - self.start > 5.0:
                self.refresh = min(2.0 * self.refresh, self.LONGEST_REFRESH)

    def _draw(self) -> None:
        self.job.read(self.handle, _SHOWN)
        self.job.buffer.upload(self.result.layers[0])
        self.job.engine.update_result(self.result)


@contextmanager
def open_result(job: Any, view: str, is_kept: bool = True) -> Iterator[Any]:
    """Blender's picture of the job's shot, with the job's buffer laid out for it.

    is_kept: what is in it in the end is the frame's. After a cancel it always is: what was seen last stays.
    """
    engine, settings = job.engine, job.shot.settings
    result = engine.begin_result(0, 0, settings.width, settings.height, layer=job.layer.name, view=view)
    if result is None:
        raise Failure("the render border leaves nothing to render")
    try:
        width, height = result.resolution_x, result.resolution_y
        x0, y0, x1, y1 = settings.region
        if job.animation is not None and (width, height) != (x1 - x0, y1 - y0):
            raise Failure("the size of the picture changes in the animation: switch Temporal off")
        settings.region[:] = [x0, y0, x0 + width, y0 + height]
        job.buffer.prepare(result.layers[0].passes, passes.by_name(job.filled(), compat.VERSION), width, height)
        yield result
    finally:
        # Also after a failure, which the caller reports: an open result would stay in memory.
        is_kept = is_kept or job.cancelled
        engine.end_result(result, cancel=not is_kept)
        job.has_result = job.has_result or is_kept
