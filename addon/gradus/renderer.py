"""Final renders and previews: the work of the engine's update() and render()."""

from __future__ import annotations

import ctypes
import math
from ctypes import byref
from dataclasses import dataclass, field
from typing import Any

import bpy

from . import (
    animation,
    automatic,
    compat,
    components,
    compositor,
    cryptomatte,
    cycles_settings,
    frame_store,
    native,
    options,
    output,
    passes,
    pixels,
    settings,
    simulation,
    stats,
    store,
)
from .animation import Animation
from .export import Cancelled as ExportCancelled
from .export.shutter import shutter_of
from .export.unsupported import missing_passes
from .failure import Failure
from .layer_channels import channels_of
from .native import Error, GradusError
from .progress import Display, is_watched, open_result, upload_last_picture, wait
from .store import FINAL, PREVIEW, Cancelled, Key, Session

_files = output.FrameFiles()


def stop_requested(engine: Any) -> bool:
    """Returns whether the user cancels the render: by Escape, or by SIGINT in the background.

    It is polled every 0.1 s in all phases.
    """
    return engine.test_break()


# ------------------------------------------------------------------------------------------------ settings


def active_passes(scene: Any, view_layer: Any, overrides: options.Overrides) -> list[passes.PassInfo]:
    """Returns the passes of a view layer, with those of the command line."""
    names = ("integrator", "reconstruction", "denoiser")
    choices = ((overrides.value(name) or getattr(scene.gradus, name)).upper() for name in names)
    method = automatic.method_of(*choices)
    component_names = _component_names(scene, overrides)
    return list(passes.list_passes(view_layer, method.is_reconstructed, component_names, overrides.passes))


def _component_names(scene: Any, overrides: options.Overrides) -> list[str]:
    """Returns the names of all components, or [] if the image is not decomposed."""
    switch, text = overrides.switch("use_decomposition"), overrides.text("components")
    if not (scene.gradus.use_decomposition if switch is None else switch):
        return []
    return components.names(scene.gradus.components if text is None else text)


def register_passes(engine: Any, scene: Any, view_layer: Any) -> None:
    """Registers the passes of a view layer.

    The interface calls this at any time, so it is cheap and does not need the library.
    """
    if scene is None or view_layer is None:
        return
    try:
        overrides = options.current()
    except options.OptionError:
        overrides = options.Overrides()  # update() reports the error once
    for info in active_passes(scene, view_layer, overrides):
        engine.register_pass(scene, view_layer, info.blender_name(compat.VERSION), info.channels, info.ids, info.kind)


def host_value(name: str, scene: Any, overrides: options.Overrides) -> Any:
    """Returns a setting that the library does not have."""
    return overrides.host.get(name, getattr(scene.gradus, name))


def native_settings(
    library: native.Library, scene: Any, view_layer: Any, overrides: options.Overrides, is_final: bool = True
) -> native.Settings:
    """Returns the native settings of a view layer without size, region and passes.

    Only final renders decompose the image: in previews and the viewport, a malformed set of components is not an error.
    """
    result = native.Settings()
    library.settings_default(byref(result))
    is_followed = host_value("use_cycles_settings", scene, overrides)
    settings.fill(
        result,
        lambda name: cycles_settings.owner(scene, name, is_followed),
        () if is_final else settings.COMPONENT_SETTINGS,
    )
    if view_layer.samples > 0:
        result.samples = view_layer.samples
    result.frame = scene.frame_current
    result.film_transparent = scene.render.film_transparent
    result.use_sky = view_layer.use_sky
    result.alpha_threshold = view_layer.pass_alpha_threshold
    result.one_more_transparent = compat.has_one_more_transparent()
    result.background_motion = compat.has_background_motion()
    result.threads = overrides.threads or compat.fixed_threads(scene.render)
    for name, text in overrides.native:
        library.settings_parse(byref(result), native.text(name), native.text(text))
    if result.use_decomposition:
        components.describe(library, result.components)  # refuses a malformed set before the export
    elif is_final:
        overrides.refuse_components()
    return result


def limit_preview(result: native.Settings, samples: int) -> None:
    """Adapts settings to previews, which use half of the processor and are never strict."""
    result.samples = min(result.samples, samples)
    result.threads = max(1, store.process_cpu_threads() // 2)
    result.denoiser = native.Denoiser.NONE
    result.strict = result.use_guiding = False


def region_of(render: Any, width: int, height: int) -> tuple[int, int, int, int]:
    """Returns x0, y0, x1, y1 of the render border in the full frame, in which Blender truncates float32 products."""
    if not render.use_border:
        return 0, 0, width, height
    x0, x1 = (int(compat.as_float32(value * width)) for value in (render.border_min_x, render.border_max_x))
    y0, y1 = (int(compat.as_float32(value * height)) for value in (render.border_min_y, render.border_max_y))
    return max(x0, 0), max(y0, 0), min(x1, width), min(y1, height)


# ------------------------------------------------------------------------------------------------ one view layer


@dataclass
class ViewRender:
    """The render of one view of one frame."""

    settings: native.Settings = field(default_factory=native.Settings)
    clock: stats.Clock = field(default_factory=stats.Clock)
    warnings: list[str] = field(default_factory=list)


class Job:
    """The render of one view layer of one frame. update() prepares it and render() finishes it."""

    def __init__(self, engine: Any, depsgraph: Any) -> None:
        self.engine = engine
        self.depsgraph = depsgraph
        self.is_preview = engine.is_preview
        self.overrides = options.Overrides() if self.is_preview else options.current()
        self.is_silent = False
        self.with_digest = False  # whether exports compute `digest`
        self.digest = b""  # of the last exported frame
        self.cancelled = False
        self.has_result = False
        self.infos = active_passes(self.scene, self.layer, self.overrides)
        self.views = compat.view_names(self.scene.render)
        kind, space = (PREVIEW, id(self)) if self.is_preview else (FINAL, 0)
        self.key = Key(kind, self.scene.name_full, self.layer.name, space)
        self.session: Session | None = None
        self.current: ViewRender | None = None
        self.animation: Animation | None = None
        self.size = (0, 0)  # pixels of the last exported frame
        self.frame_by_frame = ""  # why a frame of an animation is rendered independently
        self.unsupported: list[str] = []  # warnings about the last exported frame that are errors if `strict`
        self.buffer = pixels.PassBuffer()

    @property
    def scene(self) -> Any:
        """The evaluated scene. Its view layers have other addresses after each evaluation."""
        return self.depsgraph.scene_eval

    @property
    def layer(self) -> Any:
        return self.depsgraph.view_layer_eval

    def host_value(self, name: str) -> Any:
        return host_value(name, self.scene, self.overrides)

    def prepare(self) -> None:
        """Exports the frame. Blender holds its draw lock during this call, so that no user edits the scene."""
        self.begin_view()
        if self.overrides.stats:
            stats.check(self.overrides.stats)
        self.session = store.acquire(self.key, self.overrides.threads, bool(self.overrides.save_scene))
        self.current.settings = self.new_settings()
        if not self.is_preview:
            self.refuse_missing_passes()
        given = {name for name, _ in self.overrides.native}
        is_followed = self.host_value("use_cycles_settings")
        self.warn(cycles_settings.warnings(self.scene, given, is_followed), changes_picture=False)
        chosen = self.current.settings
        self.warn(cycles_settings.clamp_warnings(self.depsgraph, chosen.clamp_direct), changes_picture=False)
        limit = chosen.transparent_max_bounces
        self.warn(cycles_settings.transparency_warnings(self.depsgraph, limit), changes_picture=False)
        self.warn_of_simulations()
        image_settings = self.scene.render.image_settings
        self.warn(output.truncated_names(image_settings, self.layer.name, self.views, self.infos, compat.VERSION))
        self.animation = animation.of_job(self)
        if self.animation is None:
            self.export_alone()

    def refuse_missing_passes(self) -> None:
        """Raises Failure if the compositor reads a pass that Gradus does not make."""
        lost = compositor.linked_passes(self.scene, self.layer.name, missing_passes(self.layer))
        if lost:
            text = (
                f"the compositor reads pass '{lost[0]}' of view layer '{self.layer.name}', which Gradus does not make"
            )
            raise Failure(f"{text}: unlink its socket")

    def export_alone(self) -> None:
        """Exports the frame as Blender has it, to render it independently."""
        self.compute_simulations()
        self.export(self.views[0])

    def begin_view(self) -> None:
        self.current = ViewRender()

    def new_settings(self) -> native.Settings:
        """Returns the settings of the depsgraph's frame."""
        settings = native_settings(native.load(), self.scene, self.layer, self.overrides, not self.is_preview)
        # The size is needed for plans that are made before the export.
        settings.width, settings.height = self.engine.resolution_x, self.engine.resolution_y
        infos = self.requested_passes()
        settings.passes, settings.component_passes = passes.mask(infos), passes.component_mask(infos)
        if self.is_preview:
            limit_preview(settings, self.scene.gradus.preview_samples)
        return settings

    def export(self, view: str) -> None:
        """Exports a view. The first view exports the frame with the cameras of all views."""
        with self.current.clock.phase("export"):
            if view == self.views[0]:
                self._export_frame()
            else:
                self.session.show_view(view)
        if view:
            self.engine.active_view_set(view)
        settings, (width, height) = self.current.settings, self.size
        settings.width, settings.height = width, height
        settings.region[:] = region_of(self.scene.render, width, height)

    def _export_frame(self) -> None:
        vectors = self.wants_vectors()
        arguments = (self.depsgraph, self.engine, None, self.is_preview, self.is_stop_requested, vectors, self.views)
        report = self.session.sync(*arguments, self.with_digest)
        if not self.is_preview:
            session, is_still = self.session, not self.engine.is_animation
            cryptomatte.add_names(session.library, session.scene, channels_of(self.layer), session.manifests, is_still)
        self.digest = report.digest
        self.size = report.width, report.height
        self.warn(report.warnings)

    def build(self) -> None:
        with self.current.clock.phase("build"):
            self.session.commit(self.is_stop_requested)
        self.warn([])
        self.refuse_unsupported()
        if self.overrides.save_scene:
            path = self.overrides.save_scene.replace("%f", str(self.scene.frame_current))
            self.session.library.scene_save(self.session.scene, byref(self.current.settings), native.text(path))

    def read(self, handle: int, only: frozenset[passes.Pass] | None = None) -> None:
        """Reads passes of a render into the buffer."""
        library = self.session.library

        def read_plane(plane: passes.Plane, target: Any, count: int) -> None:
            if isinstance(plane, passes.ComponentPlane):
                library.render_read_component(handle, native.text(plane.component), plane.plane, target, count)
            elif isinstance(plane, passes.ChannelPlane):
                name = native.name(plane.channel.name)
                library.render_read_channel(handle, plane.channel.kind, name, plane.layer, target, count)
            else:
                library.render_read_pass(handle, plane, target, count)

        self.buffer.fill(read_plane, only)

    def compute_simulations(self) -> None:
        """Computes simulations that are not baked, which Blender does not do when it renders an animation."""
        simulations = self.simulations() if bpy.app.background else None
        if simulations is not None:
            frame = self.scene.frame_current
            with self.current.clock.phase("export"):
                after = self.frames_after()
                simulations.compute(frame + after, animation.last_of_job(self.scene) + after, self.is_stop_requested)
                simulations.go_to(frame)
                self.engine.frame_set(frame, subframe=0.0)

    def simulations(self) -> simulation.Simulations | None:
        if self.is_preview or not self.engine.is_animation:
            return None
        return simulation.of_job(self.depsgraph)

    def warn_of_simulations(self) -> None:
        """Warns of simulations that are not baked if Blender has a window, in which they cannot be stepped."""
        if not bpy.app.background and (simulations := self.simulations()) is not None:
            names = simulations.names
            count = "1 simulation is" if len(names) == 1 else f"{len(names)} simulations are"
            self.warn([f"{count} not baked and may not move, the first is '{names[0]}': bake them before rendering"])

    def frames_after(self) -> int:
        """Returns how many frames after its own an export evaluates. Simulations must be computed up to there."""
        shutter = shutter_of(self.scene, self.layer)
        return max(int(self.wants_vectors()), math.ceil(shutter.close) if shutter is not None else 0)

    def requested_passes(self) -> list[passes.PassInfo]:
        """Returns the passes that the library computes. All others stay 0."""
        return [info for info in self.infos if not self.is_left_empty(info)]

    def is_left_empty(self, info: passes.PassInfo) -> bool:
        """Returns whether a pass stays 0.

        This holds for passes without a plane. As in Cycles, Vector is 0 in images with motion blur unless a setting
        asks for it, because a Vector Blur node would blur twice. Motion of components, which Cycles does not have, is
        always computed.
        """
        if info.plane is None:
            return True
        if info.plane != passes.Pass.VECTOR or self.host_value("vector_with_motion_blur"):
            return False
        return shutter_of(self.scene, self.layer) is not None

    def wants_vectors(self) -> bool:
        if any(info.plane is not None and self.is_left_empty(info) for info in self.infos):
            text = "Pass Vector is 0, because the image has motion blur (Motion Blur > Vector Pass computes it)"
            self.warn([text], changes_picture=False)
        return any(info.is_motion for info in self.requested_passes())

    def warn(self, texts: list[str], changes_picture: bool = True) -> None:
        """Reports `texts` and the warnings of the library, each once per session.

        changes_picture: whether the texts name something that the scene asks for and the image will not have.
        """
        if self.is_silent:
            return
        for text in self.session.take_new_warnings(texts):
            self.current.warnings.append(text)
            if not self.is_preview:
                self.engine.report({"WARNING"}, f"Gradus: {text}")
        if changes_picture:
            self.unsupported += [text for text in texts if text not in self.unsupported]

    def refuse_unsupported(self) -> None:
        """Raises Failure if the render is strict and the image will not have what the scene asks for.

        This covers warnings of the export and about colours. The library refuses the warnings of its own commit when
        the render starts.
        """
        if self.is_silent:
            return
        texts, self.unsupported = [*self.unsupported, *self.session.device_warnings()], []
        if self.current.settings.strict and texts:
            others = f" (and {len(texts) - 1} other warnings)" if len(texts) > 1 else ""
            raise Failure(f"strict: {texts[0]}{others}")

    def is_stop_requested(self) -> bool:
        return stop_requested(self.engine)

    def free(self) -> None:
        if self.is_preview:
            store.release(self.key)
        self.session = None


def update(engine: Any, _data: Any, depsgraph: Any) -> None:
    job = Job(engine, depsgraph)
    engine.job = job
    if not job.is_preview:
        _check_output(engine, job)
    try:
        job.prepare()
    except ExportCancelled:
        job.cancelled = True


def _check_output(engine: Any, job: Job) -> None:
    """Checks the output folder and the previous file, if Blender will write a file for this frame.

    In the background it writes one for every frame, in the window only for frames of an animation.
    """
    if not (bpy.app.background or engine.is_animation):
        return
    channels = sum(info.channels for info in job.infos)
    frame_bytes = engine.resolution_x * engine.resolution_y * channels * pixels.FLOAT_BYTES
    if not engine.is_animation:
        _files.previous = ""
    _files.before_frame(job.scene.render, job.scene.frame_current, frame_bytes)


def render(engine: Any, depsgraph: Any) -> None:
    job = engine.job
    if job is None:
        raise Failure("render() without update()")
    try:
        if job.animation is not None and not job.animation.look_ahead(job):
            job.animation = None
            job.export_alone()
        for index, view in enumerate(job.views):
            _prepare_view(job, index, view)
            _render_view(job, view)
    except (Cancelled, ExportCancelled):
        job.cancelled = True
        if not job.has_result:
            _deliver_last_pictures(job)
    finally:
        engine.job = None  # frees the buffers at once: engine and job refer to each other
        job.free()
    if engine.is_animation and not job.is_preview and not job.cancelled:
        _files.after_frame(job.scene.render, job.scene.frame_current)


def frame_finished(engine: Any) -> None:
    engine.job = None


def _deliver_last_pictures(job: Job) -> None:
    """Delivers the pictures of the frame before, or empty ones, after a cancel that came before the first sample.

    Without any result, Blender's multilayer writer would crash.
    """
    size = job.engine.resolution_x, job.engine.resolution_y
    for view in job.views:
        result = job.engine.begin_result(0, 0, *size, layer=job.layer.name, view=view)
        if result is None:
            return
        upload_last_picture(job, view, result)
        job.engine.end_result(result)


def _prepare_view(job: Job, index: int, view: str) -> None:
    if job.cancelled:
        raise Cancelled
    if job.animation is not None:
        job.current = job.animation.take_view(view, job.scene.frame_current)
        return
    if index > 0:
        job.current = ViewRender(job.current.settings)  # measures its own times
        job.export(view)
    job.engine.update_stats("", "Gradus: building the scene")
    job.build()


def _render_view(job: Job, view: str) -> None:
    with open_result(job, view) as result:
        _sample(job, view, result)


def _sample(job: Job, view: str, result: Any) -> None:
    handle = _start(job, view)
    try:
        # A frame of an animation is reconstructed at once: it has no intermediate image.
        wait(job, handle, Display(job), result if job.animation is None else None)
        _deliver(job, view, handle, result)
    finally:
        job.session.library.render_release(handle)


def _start(job: Job, view: str) -> int:
    if job.animation is not None:
        return job.animation.deliver(view, job.scene.frame_current, job.current.settings)
    handle = ctypes.c_uint64()
    job.session.library.render_start(job.session.scene, byref(job.current.settings), byref(handle))
    return handle.value


def _read(job: Job, handle: int) -> None:
    """Reads all passes. Raises Cancelled if the render was cancelled before the library had any of them."""
    try:
        job.read(handle)
    except GradusError as error:
        if job.cancelled and error.code == Error.INVALID_OPERATION:
            raise Cancelled from None
        raise


def _deliver(job: Job, view: str, handle: int, result: Any) -> None:
    with job.current.clock.phase("upload"):
        _read(job, handle)
        job.buffer.upload(result.layers[0])
    if job.is_preview or job.cancelled:
        return
    if job.engine.is_animation and is_watched():
        job.session.pictures[view], job.buffer = job.buffer, pixels.PassBuffer()
    library = job.session.library
    cryptomatte.stamp(library, job.engine.get_result(), job.layer.name, channels_of(job.layer), job.session.manifests)
    job.warn([])
    folder = job.host_value("frame_store")
    if folder and job.animation is None:
        frame_store.save(library, handle, bpy.path.abspath(folder), job.scene, job.layer, view)
    text = ctypes.c_char_p()
    library.render_stats(handle, byref(text))
    host = {"frame": job.scene.frame_current, "layer": job.layer.name, "scene": job.scene.name, "view": view}
    native_stats = (text.value or b"").decode("utf-8", "replace")
    summary = stats.complete(native_stats, host, job.current.clock, job.current.warnings)
    job.warn(summary["warnings"], changes_picture=False)  # also those that sampling has found
    if job.frame_by_frame:
        summary.setdefault("plan", {})["frame_by_frame"] = job.frame_by_frame
    store.summaries[(job.scene.name, job.layer.name)] = summary
    _stamp(job.engine, summary)
    if job.overrides.stats:
        stats.append(job.overrides.stats, summary)


def _stamp(engine: Any, summary: dict[str, Any]) -> None:
    """Adds metadata to the file about how the image was rendered."""
    stamped = engine.get_result()
    if stamped is None or not hasattr(stamped, "stamp_data_add_field"):
        return
    for name in ("version", "integrator", "reconstruction", "denoiser", "seed", "samples"):
        if name in summary:
            stamped.stamp_data_add_field(f"gradus.{name}", str(summary[name]))
