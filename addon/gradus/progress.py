"""Waits for renders of the library, and shows their progress and their images."""

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
    """Waits until a render of the library ends. After a cancel, its samples so far can be read.

    result: Blender's result in which the current image is shown if Blender has a window.
    """
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
        if running and not job.cancelled and job.is_stop_requested():
            job.cancelled = True
            library.render_cancel(handle)
        library.render_poll(handle, byref(progress))
        display.show(progress)
        if picture is not None:
            picture.show(progress)


class Display:
    """Shows progress text and bar of consecutive renders. The text changes once per second at most."""

    TEXT_SECONDS = 1.0

    def __init__(self, job: Any) -> None:
        self.job = job
        self.next_text = time.monotonic()
        self.begin()

    def begin(self, label: str = "", done: float = 0.0, share: float = 1.0) -> None:
        """Begins a render. Its text starts with `label`, and its bar covers a `share` of the whole bar after `done`."""
        self.label, self.done, self.share = label, done, share

    def show(self, progress: native.Progress) -> None:
        engine, now = self.job.engine, time.monotonic()
        engine.update_progress(self.done + self.share * progress.fraction)
        if now >= self.next_text:
            self.next_text = now + self.TEXT_SECONDS
            engine.update_stats("", f"Gradus: {self.label}{self._text(progress)}")
            used, peak = progress.memory_bytes / 2**20, progress.peak_memory_bytes / 2**20
            engine.update_memory_stats(memory_used=used, memory_peak=peak)

    def _text(self, progress: native.Progress) -> str:
        if progress.phase == Phase.RECONSTRUCTING:
            return "reconstructing"
        if progress.phase == Phase.DONE and progress.samples_done == 0:
            return "reconstructed"  # the frame was sampled ahead
        return f"sample {progress.samples_done}/{self.job.current.settings.samples}, {100.0 * progress.fraction:.0f} %"


class LivePicture:
    """Shows the current image of a render in Blender's window."""

    FIRST_REFRESH, LONGEST_REFRESH = 0.5, 16.0  # s between images; the interval grows

    def __init__(self, job: Any, handle: int, result: Any) -> None:
        self.job, self.handle, self.result = job, handle, result
        self.start = time.monotonic()
        self.refresh = self.FIRST_REFRESH
        self.next_refresh = self.start + self.refresh
        self.version = 0
        job.read(handle, frozenset((passes.Pass.COMBINED,)))  # requests a first image from the library at once

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


def upload_last_picture(job: Any, view: str, result: Any) -> None:
    """Uploads the picture of the frame before, if there is one, after the cancel of an animation.

    Blender begins each frame with an empty result, and the window would lose the picture that the user saw.
    """
    pictures = job.session.pictures if job.session is not None and job.engine.is_animation else {}
    if view in pictures and pictures[view].fits(result):
        pictures[view].upload(result.layers[0])


@contextmanager
def open_result(job: Any, view: str, is_kept: bool = True) -> Iterator[Any]:
    """Opens Blender's result for the job's current view, and lays out the job's buffer for it.

    is_kept: whether the content of the result is that of the frame. After a cancel it always is, so that the last image
    stays visible.
    """
    engine, settings = job.engine, job.current.settings
    result = engine.begin_result(0, 0, settings.width, settings.height, layer=job.layer.name, view=view)
    if result is None:
        raise Failure("the render border leaves nothing to render")
    try:
        width, height = result.resolution_x, result.resolution_y
        x0, y0, x1, y1 = settings.region
        if job.animation is not None and (width, height) != (x1 - x0, y1 - y0):
            raise Failure("the size of the picture changes in the animation: switch Temporal off")
        settings.region[:] = [x0, y0, x0 + width, y0 + height]
        requested = passes.by_name(job.requested_passes(), compat.VERSION)
        job.buffer.prepare(result.layers[0].passes, requested, width, height)
        yield result
    finally:
        # Also after an exception, because Blender never frees a result that stays open.
        is_kept = is_kept or job.cancelled
        if job.cancelled:
            upload_last_picture(job, view, result)
        engine.end_result(result, cancel=not is_kept)
        job.has_result = job.has_result or is_kept
