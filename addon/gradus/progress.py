"""What the user sees of a render that runs in the library, and how it is waited for."""

from __future__ import annotations

import time
from ctypes import byref
from typing import Any

import bpy

from . import native, passes
from .native import Error, GradusError, Phase
from .store import POLL_SECONDS

_SHOWN = frozenset((passes.Pass.COMBINED, passes.Pass.NOISY_IMAGE))


def wait(job: Any, handle: int, display: Display) -> None:
    """Until the library is done; a cancelled render ends well, too: what it has so far is there."""
    library = job.session.library
    progress = native.Progress()
    running = True
    while running:
        try:
            library.render_wait(handle, POLL_SECONDS)
            running = False
        except GradusError as error:
            if error.code == Error.CANCELLED:
                job.cancelled = True
                running = False
            elif error.code != Error.INVALID_OPERATION:
                raise
        if running and not job.cancelled and job.stop():
            job.cancelled = True
            library.render_cancel(handle)
        library.render_poll(handle, byref(progress))
        display.show(progress)


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


class PictureDisplay(Display):
    """Also the picture so far, where somebody looks."""

    FIRST_REFRESH, LONGEST_REFRESH = 0.5, 16.0  # s between pictures; each one waits longer than the one before

    def __init__(self, job: Any, handle: int, result: Any) -> None:
        super().__init__(job)
        self.handle, self.result = handle, result
        self.start = self.next_text
        self.refresh = self.FIRST_REFRESH
        self.next_refresh = self.start + self.refresh
        self.version = 0
        self.is_watched = not bpy.app.background
        if self.is_watched:
            job.read(handle, frozenset((passes.Pass.COMBINED,)))  # there is nothing yet, but the library knows then that somebody looks

    def show(self, progress: native.Progress) -> None:
        super().show(progress)
        now = time.monotonic()
        if self.is_watched and progress.version != self.version and now >= self.next_refresh:
            self.version = progress.version
            self._picture()
            self.next_refresh = time.monotonic() + self.refresh
            if now - self.start > 5.0:
                self.refresh = min(2.0 * self.refresh, self.LONGEST_REFRESH)

    def _picture(self) -> None:
        self.job.read(self.handle, _SHOWN)
        self.job.buffer.upload(self.result.layers[0])
        self.job.engine.update_result(self.result)
