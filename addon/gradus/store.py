"""Native objects that outlive an engine object.

These are the device, and one native scene for each (kind, scene, view layer, space). Blender creates an engine object
for each frame and for each change of a pass switch, so engine objects own nothing large.
"""

from __future__ import annotations

import ctypes
import os
import threading
from collections.abc import Callable
from ctypes import byref
from typing import Any, NamedTuple

import bpy

from . import color, compat, cryptomatte, native, pixels, simulation
from .export import Exporter, blender_pixels

FINAL, PREVIEW, VIEWPORT = "FINAL", "PREVIEW", "VIEWPORT"
POLL_SECONDS = 0.05


class Cancelled(Exception):
    """The user stopped the render."""


class Key(NamedTuple):
    kind: str
    scene: str
    layer: str
    space: int  # identifies the viewport or preview; 0 for final renders


class Session:
    """A native scene, and the exporter that keeps it equal to Blender's scene."""

    def __init__(self, library: native.Library, device: int, record: bool = False) -> None:
        self.library = library
        self.device = device
        self.working_space = compat.working_space()  # which the device converts colours to
        handle = ctypes.c_uint64()
        library.scene_create(device, byref(handle))
        self.scene = handle.value
        if record:
            library.scene_record(self.scene, 1)
        self.exporter = Exporter(library, self.scene)
        self.reported: set[str] = set()
        self.pictures: dict[str, pixels.PassBuffer] = {}
        """The last picture of each view, which stays in the window if the user cancels before the next one."""
        self.manifests = cryptomatte.Manifests()

    def sync(self, *arguments: Any, **options: Any) -> Any:
        """Defines the colour spaces of all images on the device, then calls Exporter.sync()."""
        colors = _host_colors.get(self.device)
        if colors is not None:
            colors.define(self.library, self.device, compat.image_color_spaces())
        return self.exporter.sync(*arguments, **options)

    def show_view(self, view: str) -> None:
        """Sets the camera of another view; see Exporter.show_view()."""
        self.exporter.show_view(view)

    def commit(self, cancelled: Callable[[], bool]) -> None:
        """Builds the snapshot on another thread while it polls `cancelled`. Raises Cancelled or GradusError."""
        cancel, progress = ctypes.c_int32(0), ctypes.c_float(0.0)
        failures: list[BaseException] = []

        def work() -> None:
            try:
                self.library.scene_commit(self.scene, byref(cancel), byref(progress))
            except BaseException as error:  # raised again by the waiting thread
                failures.append(error)

        thread = threading.Thread(target=work, name="gradus-commit", daemon=True)
        thread.start()
        while thread.is_alive():
            thread.join(POLL_SECONDS)
            if cancelled():
                cancel.value = 1
        if cancel.value:
            raise Cancelled
        if failures:
            raise failures[0]

    def take_new_warnings(self, texts: list[str]) -> list[str]:
        """Returns those of `texts` and of the warnings of scene and device that are new in this session."""
        about_device = _device_warnings.setdefault(self.device, [])
        about_device += self.library.take_device_warnings(self.device)
        if (colors := _host_colors.get(self.device)) is not None:
            about_device += colors.take_warnings()
        fresh = []
        for text in [*texts, *self.library.take_scene_warnings(self.scene), *about_device]:
            if text not in self.reported:
                self.reported.add(text)
                fresh.append(text)
        return fresh

    def device_warnings(self) -> list[str]:
        """Returns all warnings about the device that were taken so far, such as unknown colour spaces."""
        return list(_device_warnings.get(self.device, ()))

    def free(self) -> None:
        scene, self.scene = self.scene, 0
        if scene:
            self.library.scene_release(scene)


_lock = threading.RLock()
_sessions: dict[Key, Session] = {}
_devices: dict[tuple[str, str, int], int] = {}
_host_colors: dict[int, color.HostColors] = {}
_device_warnings: dict[int, list[str]] = {}
"""All warnings of each device. Every session reports them, whichever takes them from the library."""
summaries: dict[tuple[str, str], dict[str, Any]] = {}
"""The stats of the last final render by (scene, view layer), for the panels."""


def device(library: native.Library, threads: int = 0) -> int:
    """Returns the device for Blender's current colour configuration, its working space, and a number of threads."""
    path = compat.color_config_path()
    with _lock:
        key = (path, compat.working_space(), threads)
        if key not in _devices:
            colors = color.host_colors(compat.bundled_python_packages())
            # The library need not read a configuration that Blender's OpenColorIO has read, and may not be able to.
            settings = native.DeviceSettings(threads=threads, color_config=native.text(path) or None)
            if colors is not None:
                settings.color_config = None
            settings.denoiser_path = native.text(compat.bundled_libraries()) or None
            handle = ctypes.c_uint64()
            library.device_create(byref(settings), byref(handle))
            if colors is not None:
                _host_colors[handle.value] = colors
            _devices[key] = handle.value
        return _devices[key]


def acquire(key: Key, threads: int = 0, record: bool = False) -> Session:
    """Returns the session of `key`, and creates it if there is none."""
    library = native.load()
    with _lock:
        if key in _sessions and _sessions[key].working_space != compat.working_space():
            release(key)
        if key not in _sessions:
            _sessions[key] = Session(library, device(library, threads), record)
        return _sessions[key]


def release(key: Key) -> None:
    with _lock:
        session = _sessions.pop(key, None)
    if session is not None:
        session.free()


def release_kind(kind: str) -> None:
    with _lock:
        keys = [key for key in _sessions if key.kind == kind]
    for key in keys:
        release(key)


def clear() -> None:
    """Releases all sessions and devices."""
    _end_job()
    with _lock:
        keys = list(_sessions)
    for key in keys:
        release(key)
    with _lock:
        handles = list(_devices.values())
        _devices.clear()
        _device_warnings.clear()
    for handle in handles:
        native.load().device_release(handle)
    _host_colors.clear()
    summaries.clear()


# ------------------------------------------------------------------------------------------------ handlers

job_ends: list[Callable[[], None]] = [blender_pixels.release]
"""Functions that are called when a render ends: it is finished or cancelled, or another file is loaded."""


def _end_job() -> None:
    for end in job_ends:
        end()
    for session in _sessions.values():
        session.pictures.clear()
        session.exporter.end_job()


@bpy.app.handlers.persistent
def _after_render(scene: Any, *_: Any) -> None:
    """Releases the native scene after the last frame, unless Blender is to keep persistent data.

    An animation keeps its scene between frames even without persistent data.
    """
    _end_job()
    simulation.clear()
    if scene is None or not scene.render.use_persistent_data:
        release_kind(FINAL)


@bpy.app.handlers.persistent
def _before_load(*_: Any) -> None:
    _end_job()
    simulation.discard()
    release_kind(FINAL)
    summaries.clear()


_HANDLERS = (("render_complete", _after_render), ("render_cancel", _after_render), ("load_pre", _before_load))


def register_handlers() -> None:
    for name, function in _HANDLERS:
        listed = getattr(bpy.app.handlers, name)
        if function not in listed:
            listed.append(function)


def unregister_handlers() -> None:
    for name, function in _HANDLERS:
        listed = getattr(bpy.app.handlers, name)
        if function in listed:
            listed.remove(function)


def process_cpu_threads() -> int:
    """Returns the number of hardware threads that this process may use."""
    return len(os.sched_getaffinity(0))
