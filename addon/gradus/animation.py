"""Animations: frames are sampled ahead of the one that Blender asks for, since those next to each other are reconstructed together.

What was found in 3.4, 4.5 and 5.0, and is relied on here:
- Blender calls an engine for one frame and one view layer, with a depsgraph of that layer, and goes on from `scene.frame_current`.
  `engine.frame_set` moves that counter and evaluates the engine's depsgraph alone (handlers of frame changes run); after a return to the
  frame everything else (file names, the compositor, the next frame) is as if nothing had been.
- So each layer looks ahead for itself, over its own depsgraph, in render(): update() would keep the interface locked all the time.
- The range is the scene's; -s, -e and -j change it. `render.render(frame_start=…)` of 5.0 does not, and is not seen: frames beyond the
  scene's range are rendered one by one. -f is an animation of one frame, with the scene's range untouched: only the command line tells.
- Files that are there already are not asked for where Overwrite is off.
"""

from __future__ import annotations

import ctypes
import logging
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import byref
from dataclasses import dataclass
from typing import Any

import bpy

from . import compat, frame_store, native, passes, simulation, store
from .export import Cancelled as ExportCancelled
from .progress import Display, is_watched, open_result, wait
from .store import Cancelled


@dataclass(frozen=True)
class Frames:
    """Frames that are rendered: first, first + step, … last."""

    first: int
    last: int
    step: int

    def up_to(self, last: int) -> range:
        return range(self.first, last + 1, self.step)


def frames_of_job(scene: Any, has_store: bool) -> Frames | None:
    """Those of the animation that Blender renders; None where frames are on their own."""
    if _asks_for_single_frames(sys.argv):
        return None
    frame, first, step = scene.frame_current, scene.frame_start, max(scene.frame_step, 1)
    if not first <= frame <= scene.frame_end or (frame - first) % step:
        return None
    last = scene.frame_end - (scene.frame_end - first) % step
    if scene.render.use_placeholder and not scene.render.use_overwrite:
        return None  # other processes take frames away in between
    if not has_store:
        # Without one, frames that are not asked for would be sampled for their neighbours alone.
        first, last = frame, _last_without_a_file(scene.render, frame, last, step)
    return Frames(first, last, step) if first < last else None


def last_of_job(scene: Any) -> int:
    """The last frame that Blender asks for, as far as that can be told."""
    frame = scene.frame_current
    is_single = _asks_for_single_frames(sys.argv) or not scene.frame_start <= frame <= scene.frame_end
    return frame if is_single else scene.frame_end


def _asks_for_single_frames(arguments: list[str]) -> bool:
    own = arguments[: arguments.index("--")] if "--" in arguments else arguments
    return any(name in own for name in ("-f", "--render-frame")) and not any(name in own for name in ("-a", "--render-anim"))


def _last_without_a_file(render: Any, frame: int, last: int, step: int) -> int:
    if render.use_overwrite or render.is_movie_format:
        return last
    for following in range(frame + step, last + 1, step):
        if any(map(os.path.exists, _files_of(render, following))):
            return following - step
    return last


def _files_of(render: Any, frame: int) -> list[str]:
    """Those that Blender looks for: one of them is enough for it to leave the frame out."""
    is_split = render.use_multiview and render.image_settings.views_format == "INDIVIDUAL"
    return [render.frame_path(frame=frame, view=view) for view in (compat.view_names(render) if is_split else [""])]


class Animation:
    """What is kept between the frames of one view layer: a native sequence for each view, and what is known of frames not delivered yet."""

    def __init__(self, job: Any, frames: Frames, folder: str) -> None:
        self.frames = frames
        self.library = job.session.library
        self._has_folder = bool(folder)
        self._next = frames.first
        self._begun = False
        self._shots: dict[tuple[str, int], Any] = {}
        self._alone: dict[int, str] = {}  # frames that are rendered on their own in their turn, and why
        self._fault: tuple[int, Exception] | None = None
        self._sequences: dict[str, int] = {}
        for view in job.views:
            self._sequences[view] = self._create(job, view, folder)

    def _create(self, job: Any, view: str, folder: str) -> int:
        settings = native.SequenceSettings(first=self.frames.first, last=self.frames.last, step=self.frames.step)
        settings.window_size, settings.window_overlap = job.host_value("window_size"), job.host_value("window_overlap")
        settings.with_flow = int(passes.needs_next_frame(job.filled()))
        if folder:
            settings.folder = native.text(str(frame_store.folder_of(folder, job.scene.name, job.layer.name, view)))
        handle = ctypes.c_uint64()
        self.library.sequence_create(job.session.device, byref(settings), byref(handle))
        return handle.value

    def has(self, frame: int, views: list[str]) -> bool:
        """Whether the frame is one of this animation, and was not delivered yet."""
        if list(self._sequences) != views or frame not in self.frames.up_to(self.frames.last):
            return False
        return frame >= self._next or frame in self._alone or all((view, frame) in self._shots for view in views)

    def why_alone(self, job: Any) -> str:
        """Why the job's frame is rendered on its own; "" it is not."""
        frame = job.scene.frame_current
        return _why_not_over_time(job) if frame >= self._next else self._alone.get(frame, "")

    # Ahead

    def look_ahead(self, job: Any) -> None:
        """Samples what the job's frame needs. A fault is held until its frame's turn: those before it are not lost by it."""
        frame = job.scene.frame_current
        first, last = self._needs(frame)
        begins = not self._begun
        if begins:  # files of earlier frames are there already, and nothing is asked for them
            self._next = max(self._next, first)
        missing = [number for number in self.frames.up_to(last) if number >= self._next] if self._fault is None else []
        if missing:
            with _stepping(job, missing[-1]) as show:
                display = Display(job)
                if self._has_folder and begins:
                    self._pass_by(job, show)
                self._begun = True
                for place, number in enumerate(missing):
                    display.follow(f"frame {number} of {first}–{last} ahead, ", place / len(missing), 1.0 / len(missing))
                    if not self._holds_fault(number, lambda number=number: self._sample(job, show, number, display)):
                        break
                    self._next = number + self.frames.step
        if self._fault is not None and self._fault[0] <= frame:
            raise self._fault[1]

    def _needs(self, frame: int) -> tuple[int, int]:
        first, last = ctypes.c_int32(), ctypes.c_int32()
        self.library.sequence_needs(next(iter(self._sequences.values())), frame, byref(first), byref(last))
        return first.value, last.value

    def _holds_fault(self, number: int, action: Callable[[], None]) -> bool:
        """Runs the action of a frame; False if it failed."""
        try:
            action()
        except (Cancelled, ExportCancelled):
            raise
        except Exception as error:
            self._fault = (number, error)
            if number > self.frames.first:
                for sequence in self._sequences.values():
                    self.library.sequence_end_at(sequence, number - self.frames.step)
            return False
        return True

    def _pass_by(self, job: Any, show: Callable[[int], None]) -> None:
        """Links the next frame to the one before it, so that parts of an animation, each with its own range, fit together in a store.
        That frame is not of this job: what is wrong with it concerns nobody, and without it there is no link."""
        job.is_silent = True
        try:
            for view in self._export(job, show, self._next - self.frames.step):
                self._pass_view_by(job, view)
        except (Cancelled, ExportCancelled):
            raise
        except Exception:
            logging.getLogger(__name__).info("The frame before the first one cannot be shown", exc_info=True)
        finally:
            job.is_silent = False
            self.library.take_scene_warnings(job.session.scene)

    def _pass_view_by(self, job: Any, view: str) -> None:
        self.library.sequence_pass_by(self._sequences[view], job.session.scene, byref(job.shot.settings))

    def _sample(self, job: Any, show: Callable[[int], None], number: int, display: Display) -> None:
        for view in self._export(job, show, number):
            if why := _why_not_over_time(job):
                self._alone[number] = why
                self._pass_view_by(job, view)
                continue
            handle = ctypes.c_uint64()
            self.library.sequence_sample(self._sequences[view], job.session.scene, byref(job.shot.settings), byref(handle))
            try:
                self._watch(job, view, handle.value, display)
            finally:
                self.library.render_release(handle.value)
            if job.cancelled:
                raise Cancelled
            job.shot.clock.stop()
            self._shots[view, number] = job.shot

    @staticmethod
    def _watch(job: Any, view: str, handle: int, display: Display) -> None:
        """A window shows the frame that is being sampled; progress tells which one that is."""
        if not is_watched():
            return wait(job, handle, display)
        with open_result(job, view, is_kept=False) as result:
            wait(job, handle, display, result)

    def _export(self, job: Any, show: Callable[[int], None], number: int) -> Iterator[str]:
        """Each view in turn, when the native scene shows it in that frame; job.shot is that view's."""
        for view in self._sequences:
            job.begin_shot()
            with job.shot.clock.phase("export"):
                show(number)
            job.shot.settings = job.new_settings()
            job.export(view)
            job.build()
            yield view

    # Delivery

    def take_shot(self, view: str, frame: int) -> Any:
        shot = self._shots.pop((view, frame))
        shot.clock.go_on()
        return shot

    def deliver(self, view: str, frame: int, settings: native.Settings) -> int:
        """Starts the reconstruction; a render's handle."""
        handle = ctypes.c_uint64()
        self.library.sequence_deliver(self._sequences[view], frame, byref(settings), byref(handle))
        return handle.value

    def free(self) -> None:
        while self._sequences:
            self.library.sequence_release(self._sequences.popitem()[1])


@contextmanager
def _stepping(job: Any, last: int) -> Iterator[Callable[[int], None]]:
    """Gives a function that shows the engine's depsgraph at a frame up to `last`. In the end, whatever happens, it is at the job's own."""
    own = job.scene.frame_current
    simulations = simulation.of_job(job.depsgraph)
    shown = own if simulations is None else None
    if simulations is not None:
        simulations.compute(last + job.frames_beyond(), last_of_job(job.scene) + job.frames_beyond(), job.stop)

    def show(frame: int) -> None:
        nonlocal shown
        if frame == shown:
            return
        if simulations is not None:
            simulations.show(frame)
        job.engine.frame_set(frame, subframe=0.0)
        shown = frame

    try:
        yield show
    finally:
        show(own)


# ------------------------------------------------------------------------------------------------ of the running jobs

_running: dict[tuple[str, str], Animation] = {}
"""By scene and view layer: Blender makes a new engine object for each frame."""


def of_job(job: Any) -> Animation | None:
    """The animation that the job's frame is taken from; None: it is rendered on its own."""
    if job.is_preview or not job.engine.is_animation:
        return None
    key = (job.scene.name_full, job.layer.name)
    if key in _running and not _running[key].has(job.scene.frame_current, job.views):
        _running.pop(key).free()
    if key not in _running:
        folder = bpy.path.abspath(job.host_value("frame_store")) if job.host_value("frame_store") else ""
        frames = frames_of_job(job.depsgraph.scene, bool(folder))
        job.frame_by_frame = _why_not(job)
        if frames is None or job.frame_by_frame:
            return None
        _running[key] = Animation(job, frames, folder)
    job.frame_by_frame = _running[key].why_alone(job)
    return None if job.frame_by_frame else _running[key]


def _why_not(job: Any) -> str:
    """What is against differences over time; "" nothing."""
    if not bpy.app.background and simulation.of_job(job.depsgraph) is not None:
        return "simulations are not baked"  # see simulation.py
    return _why_not_over_time(job)


def _why_not_over_time(job: Any) -> str:
    """What is against them in the frame that the job shows."""
    if not job.host_value("use_temporal"):
        return "temporal is off"
    applies, why_not = ctypes.c_uint32(), ctypes.c_char_p()
    job.session.library.sequence_applies(byref(job.shot.settings), byref(applies), byref(why_not))
    return (why_not.value or b"").decode("utf-8", "replace")


def clear() -> None:
    """The job has ended."""
    while _running:
        _running.popitem()[1].free()


store.job_ends.append(clear)
