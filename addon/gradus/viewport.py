"""The Rendered viewport: a progressive image that restarts on every change, drawn with Blender's display transform.

Blender's data is read on the main thread, where view_update() and view_draw() run. Other threads build and sample the
native scene, and never access Blender. Each viewport has its own native scene, so that viewports and final renders are
independent.
"""

from __future__ import annotations

import ctypes
import threading
import time
import weakref
from array import array
from ctypes import byref
from functools import cache
from typing import Any

import bpy
import gpu
from gpu_extras.presets import draw_texture_2d

from . import automatic, cycles_settings, native, options, renderer, settings, store, view_border
from .export import ViewOverride, panorama
from .export.dicing import DICING_SETTINGS, dicing_camera
from .native import Denoiser, Error, GradusError, Integrator, Pass, Phase, Reconstruction
from .store import VIEWPORT, Key, Session

REFRESH_SECONDS = 0.1
RESIZE_SECONDS = 0.25
"""Delay after a change of the region's size, so that dragging a border does not start a render at every step."""
JOIN_SECONDS = 0.3
"""Time to wait for a worker. The library ends a commit within 0.25 s of its cancellation."""


class View:
    """One viewport in rendered shading."""

    def __init__(self, engine: Any, depsgraph: Any) -> None:
        # Weak, because engine and view would otherwise keep each other and the threads alive after Blender freed the
        # engine.
        self._engine = weakref.ref(engine)
        scene, layer = depsgraph.scene, depsgraph.view_layer
        self.key = Key(VIEWPORT, scene.name_full, layer.name, id(self))
        self.session: Session = store.acquire(self.key)
        self.override: ViewOverride | None = None
        self.region: tuple[int, int, int, int] = (0, 0, 0, 0)
        self.signature: object = None
        self.hidden: frozenset[int] = frozenset()  # addresses of the objects that this viewport does not show
        self.worker: threading.Thread | None = None
        self.cancel = ctypes.c_int32(0)
        self.render = 0
        self.settings: native.Settings | None = None
        self.stale = True  # the image is outdated: a render starts as soon as the worker ends
        self.resized_at = 0.0
        self.error: BaseException | None = None
        self.failed = False
        self.picture = _Picture()
        self.done = False
        self.ticking = False

    @property
    def engine(self) -> Any:
        """The engine. Raises ReferenceError if Blender has freed it."""
        engine = self._engine()
        if engine is None:
            raise ReferenceError("the viewport is gone")
        return engine

    # Reading Blender.

    def synchronize(self, depsgraph: Any, override: ViewOverride, space: Any = None) -> bool:
        """Exports all changes. If the native scene is still busy, requests another update instead and returns False.

        space: the 3D viewport if it hides objects.
        """
        if not self.interrupt():
            self.engine.tag_update()
            return False
        self.failed = False
        report = self.session.sync(depsgraph, self.engine, override, False, None, space=space)
        self.session.take_new_warnings(report.warnings)
        self.override = override
        self.stale = True
        return True

    def move(self, depsgraph: Any, override: ViewOverride) -> None:
        """Exports a change of the view only."""
        if not self.interrupt():
            self.engine.tag_redraw()
            return
        old = self.override
        if old is not None and (override.width, override.height) != (old.width, old.height):
            self.resized_at = time.monotonic()
        self.session.exporter.sync_camera(depsgraph, override)
        self.override = override
        self.stale = True

    def interrupt(self) -> bool:
        """Cancels building and sampling. Returns False if the worker still uses the native scene."""
        self.cancel.value = 1
        if self.render:
            self.session.library.render_cancel(self.render)
        if self.worker is not None:
            self.worker.join(JOIN_SECONDS)
            if self.worker.is_alive():
                return False
            self.worker = None
        return True

    # Rendering.

    def start(self, scene: Any, layer: Any, region: tuple[int, int, int, int]) -> None:
        """Builds and samples on another thread. interrupt() must have returned True."""
        settings = renderer.native_settings(self.session.library, scene, layer, options.Overrides(), is_final=False)
        settings.samples = scene.gradus.preview_samples
        settings.noise_threshold = settings.time_limit = 0.0
        settings.strict = settings.use_guiding = False
        settings.integrator, settings.denoiser = Integrator.PATH, Denoiser.NONE
        settings.reconstruction = _reconstruction(scene.gradus)
        settings.threads = max(1, store.process_cpu_threads() - 1)  # leaves one thread to the interface
        settings.width, settings.height = self.override.width, self.override.height
        settings.region[:] = region
        settings.passes = 1 << Pass.COMBINED
        self.settings, self.region = settings, region
        self.stale = self.done = False
        self.picture.version = 0  # the new render has no image yet
        self.cancel.value = 0
        old, self.render = self.render, 0
        self.worker = threading.Thread(target=self._work, args=(old,), name="gradus-viewport", daemon=True)
        self.worker.start()
        _redraw_while_running(self)

    def _work(self, old: int) -> None:
        library = self.session.library
        try:
            if old:
                library.render_release(old)
            library.scene_commit(self.session.scene, byref(self.cancel), None)
            handle = ctypes.c_uint64()
            if self.cancel.value:
                return
            library.render_start(self.session.scene, byref(self.settings), byref(handle))
            self.render = handle.value
            # interrupt() sets `cancel` before it reads `render`, so that either it or this thread cancels the render.
            if self.cancel.value:
                library.render_cancel(self.render)
            else:
                self._request_image(library)
        except GradusError as error:
            if error.code != Error.CANCELLED:
                self.error = error

    def _request_image(self, library: native.Library) -> None:
        """Reads the empty image, which makes the library prepare a first image as early as possible."""
        x0, y0, x1, y1 = self.region
        count = 4 * (x1 - x0) * (y1 - y0)
        library.render_read_pass(self.render, Pass.COMBINED, (ctypes.c_float * count)(), count)

    def refresh(self) -> None:
        """Reads the newest image of the running render into the texture."""
        if not self.render:
            return
        library, progress = self.session.library, native.Progress()
        library.render_poll(self.render, byref(progress))
        if progress.phase == Phase.FAILED:
            self.done = True
            library.render_wait(self.render, 0.0)  # raises the failure
        # Without a reconstruction, the first images lack pixels.
        has_picture = progress.samples_done > 0 or self.settings.reconstruction != Reconstruction.NONE
        if progress.version != self.picture.version and has_picture:
            self.picture.take(library, self.render, self.region, progress.version)
            self.engine.update_stats("Gradus", f"Sample {progress.samples_done}/{self.settings.samples}")
        if progress.phase in (Phase.DONE, Phase.CANCELLED):
            self.done = True

    def free(self) -> None:
        self.done = True
        self.interrupt()
        if self.worker is not None:
            self.worker.join()
        if self.render:
            self.session.library.render_release(self.render)
            self.render = 0
        store.release(self.key)


def _reconstruction(settings: Any) -> Reconstruction:
    """Returns NONE if the final render shows plain samples, else REGULARIZED."""
    method = automatic.method_of(settings.integrator, settings.reconstruction, settings.denoiser)
    return Reconstruction.REGULARIZED if method.is_reconstructed else Reconstruction.NONE


def _redraw_while_running(view: View) -> None:
    """Registers a timer that requests redraws until the render ends. It does not keep the view alive."""
    if view.ticking:
        return
    view.ticking = True
    reference = weakref.ref(view)

    def tick() -> float | None:
        view = reference()
        if view is None or view.session.scene == 0:
            return None
        try:
            view.engine.tag_redraw()
        except ReferenceError:
            view.free()
            return None
        view.ticking = not view.done
        return REFRESH_SECONDS if view.ticking else None

    bpy.app.timers.register(tick, first_interval=REFRESH_SECONDS)


class _Picture:
    """The image on screen: a texture and its place in the region of the viewport."""

    def __init__(self) -> None:
        self.texture: Any = None
        self.version = 0  # GradusProgress.version of the image
        self.rectangle = (0, 0, 0, 0)
        self._pixels = array("f")

    def take(self, library: native.Library, render: int, region: tuple[int, int, int, int], version: int) -> None:
        width, height = region[2] - region[0], region[3] - region[1]
        count = 4 * width * height
        if len(self._pixels) != count:
            self._pixels = array("f", bytes(4 * count))
        library.render_read_pass(render, Pass.COMBINED, native.pointer(self._pixels), count)
        # A 16-bit texture would overflow at 65520 and turn black.
        data = gpu.types.Buffer("FLOAT", count, self._pixels)
        self.texture = gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)
        self.version = version
        self.rectangle = (region[0], region[1], width, height)

    def draw(self, engine: Any, scene: Any) -> None:
        if self.texture is None:
            return
        x, y, width, height = self.rectangle
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self.texture, (x, y), width, height)
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")


# ------------------------------------------------------------------------------------------------ engine callbacks


def update(engine: Any, context: Any, depsgraph: Any) -> None:
    if engine.view is None:
        engine.view = View(engine, depsgraph)
    view = engine.view
    hidden = _hidden_objects(context.space_data, depsgraph)
    signature = _signature(depsgraph)
    is_known = signature == view.signature and hidden == view.hidden
    if view.override is not None and is_known and not _has_edits(depsgraph):
        return
    space = context.space_data if _hides_objects(context.space_data) else None
    if view.synchronize(depsgraph, _override(context), space):
        view.signature, view.hidden = signature, hidden


def draw(engine: Any, context: Any, depsgraph: Any) -> None:
    view = engine.view
    if view is None or view.failed:
        return
    if view.error is not None:
        error, view.error, view.failed = view.error, None, True
        raise error
    if view.hidden != _hidden_objects(context.space_data, depsgraph):
        engine.tag_update()
    override = _override(context)
    region = view_border.region(context, depsgraph.scene)
    if view.override is not None and override != view.override:
        view.move(depsgraph, override)
    elif region != view.region and view.settings is not None:
        view.stale = True
    busy = view.worker is not None and view.worker.is_alive()
    settled = time.monotonic() - view.resized_at > RESIZE_SECONDS
    if view.stale and not busy and settled and region[2] > region[0] and region[3] > region[1]:
        view.interrupt()
        view.start(depsgraph.scene_eval, depsgraph.view_layer_eval, region)
    elif not busy:
        view.refresh()
    if view.stale:
        engine.tag_redraw()
    view.picture.draw(engine, depsgraph.scene_eval)


def _override(context: Any) -> ViewOverride:
    data, space, region = context.region_data, context.space_data, context.region
    clip = (space.clip_start, space.clip_end)
    camera = space.camera if space.use_local_camera else context.scene.camera
    if data.view_perspective == "CAMERA" and camera is not None and camera.type == "CAMERA":
        clip = (camera.data.clip_start, camera.data.clip_end)
        if camera.data.type == "PANO" and panorama.is_known(camera.data):
            frame = view_border.camera_frame(context, context.scene)
            if frame is not None:
                size = (region.width, region.height)
                return ViewOverride.from_panorama(camera.data, data.view_matrix, frame, context.scene.render, size)
    return ViewOverride.from_view(data.view_matrix, data.window_matrix, clip, region.width, region.height)


def _has_edits(depsgraph: Any) -> bool:
    """Returns whether the update is of more than the scene itself.

    Blender tags the scene alone when something is selected, but also when objects are hidden or settings change; see
    _signature(). Before 5.0 the scene's compositor is tagged along with it. It works on the finished picture and does
    not concern the renderer.
    """
    ignored = (bpy.types.Scene, bpy.types.CompositorNodeTree)
    return any(not isinstance(update.id, ignored) for update in depsgraph.updates)


@cache
def _object_filters() -> tuple[str, ...]:
    """Returns the switches of a 3D viewport that hide all objects of a type."""
    names = bpy.types.SpaceView3D.bl_rna.properties.keys()
    return tuple(name for name in names if name.startswith("show_object_viewport_"))


def _hides_objects(space: Any) -> bool:
    """Returns whether a 3D viewport may show fewer objects than its view layer has."""
    is_filtered = not all(getattr(space, name) for name in _object_filters())
    return space.local_view is not None or space.use_local_collections or is_filtered


def _hidden_objects(space: Any, depsgraph: Any) -> frozenset[int]:
    """Returns the addresses of the objects that a viewport hides: by Local View, Local Collections or their type."""
    if not _hides_objects(space):
        return frozenset()
    objects = (obj.original for obj in depsgraph.objects)
    return frozenset(obj.as_pointer() for obj in objects if not obj.visible_in_viewport_get(space))


def _signature(depsgraph: Any) -> object:
    """Returns a value that differs if an update of the scene alone has changed the picture.

    Blender lists every other change in depsgraph.updates, instances included. What remains are settings, the frame,
    replaced datablocks, and which objects and collections the view layer shows: hiding and unhiding objects of a view
    layer tags the scene alone. The objects are read and hashed by two calls into Blender and Python, without a loop
    over them, and instances are not read at all.
    """
    scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    is_followed = scene.gradus.use_cycles_settings
    owners = (cycles_settings.owner(scene, name, is_followed) for name in settings.BY_NAME)
    values = tuple(getattr(*owner) for owner in owners if owner[1] not in settings.COMPONENT_SETTINGS)
    dicing = tuple(getattr(getattr(scene, "cycles", None), name, None) for name in DICING_SETTINGS)
    camera = dicing_camera(scene)
    replaced = (scene.world, layer.material_override, getattr(layer, "world_override", None), camera)
    blocks = tuple(block.original.as_pointer() if block else 0 for block in replaced)
    flags = (scene.render.film_transparent, layer.use_sky, layer.use_solid)
    objects = hash(tuple(depsgraph.objects.values()))
    return values, dicing, scene.frame_current, layer.name, flags, blocks, objects, _collection_flags(layer)


def _collection_flags(layer: Any) -> tuple[tuple[bool, ...], ...]:
    """Returns the switches of a view layer's collections that change how their objects are rendered."""
    flags = []
    waiting = [layer.layer_collection]
    while waiting:
        collection = waiting.pop()
        flags.append((collection.exclude, collection.holdout, collection.indirect_only))
        waiting.extend(collection.children)
    return tuple(flags)
