"""Animations: frames are sampled ahead, because neighbouring frames are reconstructed together.

Facts about Blender 3.4, 4.5 and 5.0 on which this module relies:

- Blender calls an engine for one frame and one view layer, with a depsgraph of that layer, and continues from
  `scene.frame_current`. `engine.frame_set` moves that counter, runs frame change handlers and evaluates the engine's
  depsgraph only. After a return to the frame, everything else (file names, the compositor, the next frame) is
  unchanged.
- Each view layer looks ahead over its own depsgraph, in render(): update() would lock the interface all the time.
- The frame range is that of the scene, which -s, -e and -j change. `render.render(frame_start=…)` of Blender 5.0 does
  not change it and cannot be detected: frames outside the scene's range are rendered one by one. -f is an animation of
  one frame with the scene's range, and can be detected from the command line only.
- If Overwrite is off, Blender skips frames whose files exist.

Frames of a store:

- Stored samples of a frame are used if the frame still shows what they show, which its content key tells. Others are
  sampled again. Keys are compared when a frame is sampled ahead, so before any picture that contains the frame.
- Stored frames beside those of the job are compared in the same way. They join the pictures of the job if they fit.
  They get no samples of their own, but replay the frame before again where the job has changed it.

Frames ahead and Python handlers:

- A frame ahead shows what drivers, keyframes and handlers of frame changes set for it. It does not show what other
  handlers will set when Blender comes to it, nor what a handler of frame changes sets that depends on more than the
  frame. Running the others for frames ahead would repeat their side effects, such as files and messages.
- Therefore, if there are any handlers, each frame is exported again when Blender comes to it. If it shows something
  else than what was sampled, its samples and those of later frames are dropped, and all further frames are rendered by
  themselves. Handlers that change nothing, such as those of render farms, cost an export per frame and no quality.
- The frame before was made with the dropped frames as neighbours. It is not wrong, because its own samples and its
  motion to the neighbours are those of the scenes that were sampled.
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
from pathlib import Path
from typing import Any

import bpy

from . import compat, frame_store, handlers, native, passes, simulation, store
from .export import Cancelled as ExportCancelled
from .progress import Display, is_watched, open_result, wait
from .store import Cancelled


@dataclass(frozen=True)
class FrameRange:
    """The frames that are rendered: first, first + step, … last."""

    first: int
    last: int
    step: int

    def up_to(self, last: int) -> range:
        return range(self.first, last + 1, self.step)


def frames_of_job(scene: Any, has_store: bool) -> FrameRange | None:
    """Returns the frames of the animation that Blender renders, or None if frames are rendered independently.

    With a store, a single frame is an animation, which the stored frames beside it join.
    """
    frame, first, step = scene.frame_current, scene.frame_start, max(scene.frame_step, 1)
    if _asks_for_single_frames(sys.argv):
        return FrameRange(frame, frame, step) if has_store else None
    if not first <= frame <= scene.frame_end or (frame - first) % step:
        return None
    last = scene.frame_end - (scene.frame_end - first) % step
    if scene.render.use_placeholder and not scene.render.use_overwrite:
        return None  # other processes may render any of the frames
    if not has_store:
        # Without a store, frames that Blender skips would be sampled only for their neighbours.
        first, last = frame, _last_before_existing_file(scene.render, frame, last, step)
    return FrameRange(first, last, step) if first < last or has_store else None


def last_of_job(scene: Any) -> int:
    """Returns the last frame that Blender will ask for, as far as it is known."""
    frame = scene.frame_current
    is_single = _asks_for_single_frames(sys.argv) or not scene.frame_start <= frame <= scene.frame_end
    return frame if is_single else scene.frame_end


def _asks_for_single_frames(arguments: list[str]) -> bool:
    own = arguments[: arguments.index("--")] if "--" in arguments else arguments
    renders_animation = any(name in own for name in ("-a", "--render-anim"))
    return not renders_animation and any(name in own for name in ("-f", "--render-frame"))


def _last_before_existing_file(render: Any, frame: int, last: int, step: int) -> int:
    if render.use_overwrite or render.is_movie_format:
        return last
    for following in range(frame + step, last + 1, step):
        if any(map(os.path.exists, _output_files(render, following))):
            return following - step
    return last


def _output_files(render: Any, frame: int) -> list[str]:
    """Returns the files of a frame. Blender skips a frame if one of them exists."""
    is_split = render.use_multiview and render.image_settings.views_format == "INDIVIDUAL"
    views = compat.view_names(render) if is_split else [""]
    return [render.frame_path(frame=frame, view=view) for view in views]


class Animation:
    """The animation of one view layer: a native sequence for each view, and all frames that were not delivered."""

    def __init__(self, job: Any, frames: FrameRange, folder: str) -> None:
        self.frames = frames
        self.library = job.session.library
        self._has_folder = bool(folder)
        self._next = frames.first
        self._begun = False
        self._views: dict[tuple[str, int], Any] = {}
        self._independent: dict[int, str] = {}  # frames that are rendered independently, and why
        self._fault: tuple[int, Exception] | None = None  # the frame that failed and its error
        self._states: dict[int, bytes] = {}  # what frames ahead showed when they were sampled, if there are handlers
        self._folders: list[Path] = []  # of the frame store
        self._written: set[int] = set()  # frames whose films this job has written there
        self._sequences: dict[str, int] = {}
        for view in job.views:
            self._sequences[view] = self._create(job, view, folder)

    def _create(self, job: Any, view: str, folder: str) -> int:
        settings = native.SequenceSettings(first=self.frames.first, last=self.frames.last, step=self.frames.step)
        settings.window_size = job.host_value("window_size")
        # The library refuses windows that overlap by more than half, as those of fewer than ten would by default.
        settings.window_overlap = min(job.host_value("window_overlap"), settings.window_size // 2)
        settings.with_flow = int(passes.needs_next_frame(job.requested_passes()))
        if folder:
            self._folders.append(frame_store.folder_of(folder, job.scene.name, job.layer.name, view))
            settings.folder = native.text(str(self._folders[-1]))
        handle = ctypes.c_uint64()
        self.library.sequence_create(job.session.device, byref(settings), byref(handle))
        return handle.value

    def can_deliver(self, frame: int, views: list[str]) -> bool:
        """Returns whether a frame belongs to this animation and was not delivered yet."""
        if list(self._sequences) != views or frame not in self.frames.up_to(self.frames.last):
            return False
        if self._fault is not None and frame > self._fault[0]:
            return False  # Blender did not ask for the frame that failed
        is_sampled = all((view, frame) in self._views for view in views)
        return frame >= self._next or frame in self._independent or is_sampled

    def why_independent(self, job: Any) -> str:
        """Returns why the job's frame is rendered independently, or ""."""
        frame = job.scene.frame_current
        return _why_frame_independent(job) if frame >= self._next else self._independent.get(frame, "")

    # Sampling ahead

    def look_ahead(self, job: Any) -> bool:
        """Samples the frames that the job's frame needs.

        An error of a later frame is raised when Blender asks for that frame, so that the frames before it are not lost.
        Returns False if handlers made the look-ahead fail. The frame is then rendered independently, as all later ones.
        """
        frame = job.scene.frame_current
        found = handlers.that_may_change_frames()
        job.with_digest = bool(found)
        if not self._shows_what_was_sampled(job):
            self._give_up(job, "Python handlers changed what was sampled ahead", found)
            return False
        first, last = self._needs(job)
        # Frames before the first one that is needed are left out: Blender skips them, or they are independent.
        begins = not self._begun or first > self._next
        if begins:
            self._next = first
        missing = range(self._next, last + 1, self.frames.step) if self._fault is None else range(0)
        if missing:
            with _stepping(job, missing[-1]) as go_to:
                display = Display(job)
                if self._has_folder and begins:
                    self._export_previous(job, go_to)
                self._begun = True
                for place, number in enumerate(missing):
                    share = 1.0 / len(missing)
                    display.begin(f"frame {number} of {first}–{last} ahead, ", place * share, share)
                    if number not in self.frames.up_to(self.frames.last):
                        self._join_stored(job, go_to, number, display)
                    elif not self._succeeds(number, lambda number=number: self._sample(job, go_to, number, display)):
                        break
                    self._next = number + self.frames.step
        self._states.pop(frame, None)  # Blender is at this frame
        if self._next > self._needs(job, self.frames.last)[1]:
            job.current = self._views.get((job.views[0], frame), job.current)  # its stats name the warnings
            job.warn(self._take_warnings(), changes_picture=False)
        if self._fault is not None and self._fault[0] <= frame:
            if not found:
                raise self._fault[1]
            # With its own state the frame may be sound. If it is not, it fails again when it is rendered by itself.
            self._give_up(job, f"{self._fault[1]}; Python handlers may be the cause", found)
            return False
        return True

    def _shows_what_was_sampled(self, job: Any) -> bool:
        """Returns whether the job's frame shows what was sampled for it. It is exported only if there are handlers."""
        frame = job.scene.frame_current
        state = self._states.pop(frame, None)
        is_sampled = all((view, frame) in self._views for view in self._sequences)
        if not is_sampled or (state is None and not job.with_digest):
            return True
        job.with_digest = True  # a handler may have removed itself
        job.compute_simulations()
        job.export(job.views[0])
        return self._state(job) == state

    @staticmethod
    def _state(job: Any) -> bytes:
        """Returns a value that is equal for frames that show the same and are sampled in the same way."""
        return job.digest + bytes(job.current.settings) + _why_frame_independent(job).encode()

    def _give_up(self, job: Any, why: str, found: list[str]) -> None:
        """Ends all animations of the job's scene, and warns once. found: the handlers."""
        job.begin_view()
        job.current.settings = job.new_settings()
        scene, frame = job.scene.name_full, job.scene.frame_current
        for key in [key for key in _running if key[0] == scene]:
            animation = _running.pop(key)
            animation._drop_stored(job)
            animation.free()
        _given_up.add(scene)
        job.frame_by_frame = _HANDLERS
        more = f" and {len(found) - 1} more" if len(found) > 1 else ""
        names = f" ({found[0]}{more})" if found else ""
        text = f"From frame {frame} on, frames are rendered by themselves: {why}{names}. {_ADVICE}"
        job.warn([text], changes_picture=False)

    def _drop_stored(self, job: Any) -> None:
        """Deletes the films of the frame store that this job wrote and that may not show what their frames show.

        These are all from the first one on that the job's frame needs. The command-line tool would show them.
        """
        first, _ = self._needs(job)
        for number in self._written:
            if number >= first or number in self._states:
                for folder in self._folders:
                    frame_store.drop(folder, number)

    def _needs(self, job: Any, frame: int | None = None) -> tuple[int, int]:
        """Returns the first and the last frame that must be sampled before a frame can be delivered.

        frame: the frame; None stands for that of the job.
        """
        first, last = ctypes.c_int32(), ctypes.c_int32()
        settings = job.new_settings()
        settings.frame = settings.frame if frame is None else frame
        sequence = next(iter(self._sequences.values()))
        self.library.sequence_needs(sequence, byref(settings), byref(first), byref(last))
        return first.value, last.value

    def _succeeds(self, number: int, action: Callable[[], None]) -> bool:
        """Runs the action of a frame and keeps its error. Returns False if it failed."""
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

    def _export_previous(self, job: Any, go_to: Callable[[int], None]) -> None:
        """Exports the frame before the first one, without sampling it.

        The first frame then has correspondences to it, so that ranges that are rendered by different jobs fit together
        in a frame store. That frame does not belong to this job, so its errors are ignored: without it the first frame
        has no correspondences.
        """
        with self._without_errors(job):
            for view in self._export(job, go_to, self._next - self.frames.step):
                self._set_previous(job, view)

    def _join_stored(self, job: Any, go_to: Callable[[int], None], number: int, display: Display) -> None:
        """Lets a stored frame beside those of the job join their pictures, if it still shows what its samples show.

        That frame does not belong to this job, so its errors are ignored: without it pictures lack its samples.
        """
        with self._without_errors(job):
            for view in self._export(job, go_to, number):
                if _why_frame_independent(job):
                    self._set_previous(job, view)
                else:
                    self._run_sampling(job, view, lambda handle: wait(job, handle, display))

    @contextmanager
    def _without_errors(self, job: Any) -> Iterator[None]:
        """Ignores errors and warnings about a frame that does not belong to the job."""
        job.is_silent = True
        try:
            yield
        except (Cancelled, ExportCancelled):
            raise
        except Exception:
            logging.getLogger(__name__).info("A frame beside those of the job cannot be used", exc_info=True)
        finally:
            job.is_silent = False
            self.library.take_scene_warnings(job.session.scene)

    def _set_previous(self, job: Any, view: str) -> None:
        self.library.sequence_pass_by(self._sequences[view], job.session.scene, byref(job.current.settings))

    def _sample(self, job: Any, go_to: Callable[[int], None], number: int, display: Display) -> None:
        for view in self._export(job, go_to, number):
            if reason := _why_frame_independent(job):
                self._independent[number] = reason
                self._set_previous(job, view)
                continue
            if job.with_digest:
                self._states.setdefault(number, self._state(job))
            before = self._written_at(number)
            try:
                self._run_sampling(job, view, lambda handle, view=view: self._wait(job, view, handle, display))
            finally:
                if self._written_at(number) != before:
                    self._written.add(number)
            job.current.clock.pause()
            self._views[view, number] = job.current

    def _run_sampling(self, job: Any, view: str, wait_for: Callable[[int], None]) -> None:
        """Samples the frame that the native scene shows, and waits for it. Raises Cancelled."""
        handle = ctypes.c_uint64()
        self.library.sequence_sample(
            self._sequences[view], job.session.scene, byref(job.current.settings), byref(handle)
        )
        try:
            wait_for(handle.value)
        finally:
            self.library.render_release(handle.value)
        if job.cancelled:
            raise Cancelled

    def _written_at(self, number: int) -> list[int]:
        return [frame_store.written_at(folder, number) for folder in self._folders]

    @staticmethod
    def _wait(job: Any, view: str, handle: int, display: Display) -> None:
        """Waits for the samples of a frame, and shows its image in the window."""
        if not is_watched():
            return wait(job, handle, display)
        with open_result(job, view, is_kept=False) as result:
            wait(job, handle, display, result)

    def _export(self, job: Any, go_to: Callable[[int], None], number: int) -> Iterator[str]:
        """Yields each view after the native scene was set to it at a frame. job.current is the render of that view."""
        for view in self._sequences:
            job.begin_view()
            with job.current.clock.phase("export"):
                go_to(number)
            job.current.settings = job.new_settings()
            job.export(view)
            job.build()
            yield view

    # Delivery

    def take_view(self, view: str, frame: int) -> Any:
        render = self._views.pop((view, frame))
        render.clock.resume()
        return render

    def deliver(self, view: str, frame: int, settings: native.Settings) -> int:
        """Starts the reconstruction of a frame. Returns the handle of a render."""
        handle = ctypes.c_uint64()
        self.library.sequence_deliver(self._sequences[view], frame, byref(settings), byref(handle))
        return handle.value

    def _take_warnings(self) -> list[str]:
        """Returns the warnings about stored frames. Each view has the same ones, unless files are damaged."""
        found = (self.library.take_sequence_warnings(sequence) for sequence in self._sequences.values())
        return list(dict.fromkeys(text for texts in found for text in texts))

    def free(self) -> None:
        for text in self._take_warnings():  # of a job that did not come to its last frame
            logging.getLogger(__name__).warning("Gradus: %s", text)
        while self._sequences:
            self.library.sequence_release(self._sequences.popitem()[1])


@contextmanager
def _stepping(job: Any, last: int) -> Iterator[Callable[[int], None]]:
    """Yields a function that moves the engine's depsgraph to a frame up to `last`.

    At exit, the depsgraph is at the job's frame again.
    """
    own = job.scene.frame_current
    simulations = simulation.of_job(job.depsgraph)
    current = own if simulations is None else None
    if simulations is not None:
        after = job.frames_after()
        simulations.compute(last + after, last_of_job(job.scene) + after, job.is_stop_requested)

    def go_to(frame: int) -> None:
        nonlocal current
        if frame == current:
            return
        if simulations is not None:
            simulations.go_to(frame)
        job.engine.frame_set(frame, subframe=0.0)
        current = frame

    try:
        yield go_to
    finally:
        go_to(own)


# ------------------------------------------------------------------------------------------------ the running jobs

_running: dict[tuple[str, str], Animation] = {}
"""Animations by scene and view layer. They are global because Blender creates an engine object for each frame."""
_given_up: set[str] = set()
"""Scenes whose frames are not sampled ahead any more, because handlers change them."""
_HANDLERS = "Python handlers change frames"
_ADVICE = "Handlers of frame changes keep Temporal on if what they do depends on the frame alone"


def of_job(job: Any) -> Animation | None:
    """Returns the animation that delivers the job's frame, or None if the frame is rendered independently."""
    if job.is_preview or not job.engine.is_animation:
        return None
    key = (job.scene.name_full, job.layer.name)
    if key in _running and not _running[key].can_deliver(job.scene.frame_current, job.views):
        _running.pop(key).free()
    if job.scene.name_full in _given_up:
        job.frame_by_frame = _HANDLERS
        return None
    if key not in _running:
        folder = bpy.path.abspath(job.host_value("frame_store")) if job.host_value("frame_store") else ""
        frames = frames_of_job(job.depsgraph.scene, bool(folder))
        job.frame_by_frame = _why_independent(job)
        if frames is None or job.frame_by_frame:
            return None
        _running[key] = Animation(job, frames, folder)
    job.frame_by_frame = _running[key].why_independent(job)
    return None if job.frame_by_frame else _running[key]


def _why_independent(job: Any) -> str:
    """Returns why the frames of a job are rendered independently, or ""."""
    if not bpy.app.background and simulation.of_job(job.depsgraph) is not None:
        return "simulations are not baked"  # stepping them would disturb the window; see simulation.py
    return _why_frame_independent(job)


def _why_frame_independent(job: Any) -> str:
    """Returns why the job's frame is rendered independently, or ""."""
    if not job.host_value("use_temporal"):
        return "temporal is off"
    applies, reason = ctypes.c_uint32(), ctypes.c_char_p()
    job.session.library.sequence_applies(byref(job.current.settings), byref(applies), byref(reason))
    return (reason.value or b"").decode("utf-8", "replace")


def clear() -> None:
    """Releases all animations at the end of the job."""
    while _running:
        _running.popitem()[1].free()
    _given_up.clear()


store.job_ends.append(clear)
