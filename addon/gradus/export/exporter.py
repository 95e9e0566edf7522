"""Export of one frame.

Everything of the rendered frame is read first, then the times around it for vectors and motion blur. Instances and
cameras are set last.
"""

from __future__ import annotations

import time
from array import array
from collections.abc import Callable, Sequence
from typing import Any

import bpy

from .. import compat, native
from ..abi import ChannelKind
from ..layer_channels import Channel, channels_of
from . import blender_pixels, camera, channels, culling, instances, light, mesh, motion, unsupported, world
from .collect import Collected, Entry, InstanceKey, collect
from .dicing import dicing_camera, dicing_of
from .digest import Digest
from .instance_attributes import read_instance_attributes
from .keys import KIND_IMAGE, KIND_MATERIAL, KIND_MESH, InstanceIds, KeyTable
from .material import Materials, Resources
from .may_move import MayMove
from .mesh import MeshArrays
from .motion import Deforming, Shape
from .report import ExportReport, Poll, Warnings
from .shutter import NO_BLUR, blur_of, shutter_of
from .target import Target
from .views import States, cameras_of, states_of


class Exporter:
    """Keeps a native scene equal to Blender's scene.

    Objects that are unchanged since the last sync are not set again.
    """

    def __init__(self, library: Any, scene_handle: int) -> None:
        self._target = Target(library, scene_handle)
        self._meshes = KeyTable()
        self._images = KeyTable()
        self._materials = KeyTable()
        self._ids = InstanceIds()
        self._views: dict[str, tuple[native.Camera, Any]] = {}

    def sync(
        self,
        depsgraph: Any,
        engine: Any = None,
        view: camera.ViewOverride | None = None,
        is_preview: bool = False,
        cancelled: Callable[[], bool] | None = None,
        vectors: bool | None = None,
        views: Sequence[str] = ("",),
        with_digest: bool = False,
        space: Any = None,
    ) -> ExportReport:
        """Sets everything that the depsgraph shows at its frame.

        Raises ExportError (with a text for the user) and Cancelled.

        view: the view of a viewport, which replaces the camera. Viewports and previews have no motion. vectors: whether
        the Vector pass is computed; None: if it is enabled in the view layer. views: views of multi-view. The first one
        is set; show_view() sets another. with_digest: whether the report has a digest of everything that was set.
        space: a 3D viewport that hides objects, by Local View for example, or None.
        """
        start = time.perf_counter()
        wants_vectors = depsgraph.view_layer_eval.use_pass_vector if vectors is None else vectors
        wanted = motion.MotionRequest()
        if view is None and not is_preview:
            shutter = shutter_of(depsgraph.scene_eval, depsgraph.view_layer_eval)
            wanted = motion.MotionRequest(wants_vectors, shutter)
        digest = Digest() if with_digest else None
        run = _Sync(self, depsgraph, engine, view, wanted, views, Poll(cancelled), digest, space, is_preview)
        tables = ((KIND_MESH, self._meshes), (KIND_IMAGE, self._images), (KIND_MATERIAL, self._materials))
        for _, table in tables:
            table.begin()
        try:
            run.run()
        except Exception:
            for _, table in tables:
                table.invalidate()
            raise
        finally:
            if view is not None or is_preview:
                blender_pixels.release()  # final renders do it when their job ends
        for kind, table in tables:
            for key in table.sweep():
                self._target.remove(kind, key)
        self._views = run.cameras
        self.show_view(views[0])
        seconds = time.perf_counter() - start
        return ExportReport(*run.size, run.warnings.texts, seconds, digest.value() if digest is not None else b"")

    def show_view(self, view: str) -> None:
        """Sets the camera of another view of the last exported frame. The views share everything else."""
        struct, _keep = self._views[view]
        self._target.set_camera(struct)

    def end_job(self) -> None:
        """Drops what is kept for all frames of a job."""
        self._ids.forget()

    def sync_camera(self, depsgraph: Any, view: camera.ViewOverride) -> None:
        """Sets only the camera of a viewport, when nothing else has changed."""
        self._target.set_camera(camera.fill_camera(camera.view_state(view))[0])


class _Sync:
    """The state of one call of Exporter.sync."""

    def __init__(
        self,
        exporter: Exporter,
        depsgraph: Any,
        engine: Any,
        view: camera.ViewOverride | None,
        wanted: motion.MotionRequest,
        views: Sequence[str],
        poll: Poll,
        digest: Digest | None = None,
        space: Any = None,
        is_preview: bool = False,
    ) -> None:
        self._depsgraph = depsgraph
        self._engine = engine
        self._view = view
        self._poll = poll
        self._digest = digest
        self._space = space
        self._is_preview = is_preview or view is not None
        self._target = exporter._target
        self._mesh_keys = exporter._meshes
        self._ids = exporter._ids
        self.warnings = Warnings()
        self._scene = depsgraph.scene_eval
        self.size = self._resolution()
        self._wanted = wanted
        self._channels: tuple[Channel, ...] = ()
        if view is None and not is_preview:
            self._channels = channels_of(depsgraph.view_layer_eval)
        self._groups = channels.numbers(self._channels, ChannelKind.LIGHT_GROUP)
        resources = Resources(self._target, exporter._images, depsgraph, self.size, bpy.path.abspath, self.warnings)
        resources.aovs = channels.aovs(self._channels)
        self._materials = Materials(self._target, exporter._materials, resources, poll, self.warnings)
        self._cameras = cameras_of(views, engine, self._scene) if view is None else {}
        self.cameras: dict[str, tuple[native.Camera, Any]] = {}  # by view
        self._deforming: dict[InstanceKey, Deforming] = {}

    def _resolution(self) -> tuple[int, int]:
        if self._view is not None:
            return self._view.width, self._view.height
        if self._engine is not None and self._engine.resolution_x > 0:
            return self._engine.resolution_x, self._engine.resolution_y
        render = self._scene.render
        percentage = render.resolution_percentage
        return max(render.resolution_x * percentage // 100, 1), max(render.resolution_y * percentage // 100, 1)

    def run(self) -> None:
        now = self._view_states()
        # No prediction is needed if the times around the frame are read, because they show what moves.
        collected = collect(self._depsgraph, self._poll, None if self._wanted.any() else MayMove(), self._space)
        for text in (*unsupported.of_scene(self._scene, self._depsgraph.view_layer_eval), *collected.unsupported):
            self.warnings.add(text)
        if (culled := culling.culling_of(self._scene, now.get(""))) is not None:
            culling.cull(collected, culled)
        for entry in collected.surfaces:
            entry.material_keys = self._materials.surface_keys(entry.materials)
        for entry in collected.lights:
            if light.constant_emission(entry.data) is None:
                entry.material_keys = (self._materials.key(entry.data, "LIGHT"),)
        if self._materials.instance_attribute_names:
            of_keys = self._materials.instance_attributes_of
            entries = (*collected.surfaces, *collected.lights)
            read_instance_attributes(self._depsgraph, entries, of_keys, self._poll, self.warnings.add)
        self._set_channels()
        self._set_world()
        self._set_lights(collected)
        mesh_of = self._read_meshes(collected)
        moments = self._moments(collected)
        for shape, found in {found.shape: found for found in self._deforming.values()}.items():
            self._add_motion(found, moments)
            mesh_of[shape] = self._set_mesh(found.arrays)
        self._set_instances(collected, mesh_of, moments)
        for view, state in now.items():
            self._fill_camera(view, state, moments)
        self._set_dicing_camera()

    def _view_states(self) -> States:
        if self._view is not None:
            return {"": camera.view_state(self._view)}
        return states_of(self._cameras, self._depsgraph, self._engine, self.size)

    def _fill_camera(self, view: str, now: camera.CameraState, moments: motion.Moments) -> None:
        around: list[camera.CameraState | None] = [None, None]
        if self._wanted.vectors:
            around = [motion.camera_at(view, moments[time]) for time in motion.NEIGHBORS]
        shutter = self._wanted.shutter
        keys = motion.camera_blur(view, self._cameras[view], now, shutter, moments) if shutter is not None else []
        self.cameras[view] = camera.fill_camera(now, *around, shutter, keys)
        if self._digest is not None:
            struct, kept = self.cameras[view]
            self._digest.struct(struct)
            if shutter is not None:
                self._digest.arrays([shutter.curve, *kept[1:]])

    def _set_dicing_camera(self) -> None:
        chosen = dicing_camera(self._scene.original)
        if chosen is None:
            self._target.set_dicing_camera(None)
            return
        state = camera.camera_state(chosen.evaluated_get(self._depsgraph), self._scene, *self.size)
        struct, _kept = camera.fill_camera(state)
        self._target.set_dicing_camera(struct)
        if self._digest is not None:
            self._digest.struct(struct)

    def _moments(self, collected: Collected) -> motion.Moments:
        if not self._wanted.any():
            return {}
        blurs = {*map(blur_of, self._cameras.values()), *(entry.blur for entry in collected.surfaces)}
        times = self._wanted.times(blurs)
        arguments = (times, self._deforming, self._cameras, self.size, self._poll)
        return motion.read_moments(self._depsgraph, self._engine, *arguments)

    def _add_motion(self, found: Deforming, moments: motion.Moments) -> None:
        arrays, shutter = found.arrays, self._wanted.shutter
        if self._wanted.vectors and arrays.motion is None:
            arrays.motion = motion.mesh_motion(found, moments)
        if shutter is None or arrays.blur is not None:
            return
        arrays.blur = motion.mesh_blur(found, shutter, moments)
        if motion.changes_topology(found, shutter, moments):
            problem = "changes its topology while the shutter is open: its deformation is not blurred"
            self.warnings.add(f"Object '{found.name}' {problem}")

    # Meshes

    def _shape(self, entry: Entry) -> Shape:
        """Returns the key of a mesh and its motion blur. Instances with equal keys share a native mesh."""
        return entry.data_address, entry.blur if self._wanted.shutter is not None else NO_BLUR

    def _read_meshes(self, collected: Collected) -> dict[Shape, int]:
        """Returns keys of meshes by shape.

        Keys of deforming meshes are 0 until the times around the frame have been read.
        """
        keys: dict[Shape, int] = {}
        deforming: dict[Shape, Deforming] = {}
        wanted = frozenset(self._materials.attribute_names)
        for entry in collected.surfaces:
            shape = self._shape(entry)
            if shape not in keys:
                self._poll()
                keys[shape] = 0
                may_deform = self._wanted.any() and motion.may_deform(entry)
                arrays = self._read_mesh(entry, wanted, may_deform)
                if arrays is not None and may_deform:
                    deforming[shape] = Deforming(shape, arrays, entry.name, arrays.motion is not None)
                elif arrays is not None:
                    keys[shape] = self._set_mesh(arrays)
            if shape in deforming:
                self._deforming[entry.key] = deforming[shape]
        return keys

    def _read_mesh(self, entry: Entry, wanted: frozenset[str], is_kept: bool) -> MeshArrays | None:
        original = entry.object.original
        has_shape_keys = getattr(original.data, "shape_keys", None) is not None
        may_deform = original.modifiers or has_shape_keys or motion.is_deformed_by_parent(original)
        undeformed = original.data if original.type == "MESH" and may_deform else None
        if len(entry.data.polygons) == 0:
            return None
        arrays = mesh.read_mesh(entry.data, wanted, undeformed, self._materials.reads_edges, is_kept)
        arrays.dicing = dicing_of(original, self._scene.original, self.size[0], self._is_preview)
        frames_per_second = self._scene.render.fps / self._scene.render.fps_base
        if self._wanted.vectors:
            arrays.motion = motion.velocity_motion(entry.data, arrays, frames_per_second)
        if self._wanted.shutter is not None:
            shutter = self._wanted.shutter
            arrays.blur = motion.velocity_blur(entry.data, arrays, entry.blur, shutter, frames_per_second)
        return arrays

    def _set_mesh(self, arrays: MeshArrays) -> int:
        content = arrays.content_hash()
        key = self._mesh_keys.key(content)
        if self._mesh_keys.changed(key, content):
            struct, _keep = mesh.fill_mesh(arrays)
            self._target.set_mesh(key, struct)
        return key

    def _set_instances(self, collected: Collected, mesh_of: dict[Shape, int], moments: motion.Moments) -> None:
        mesh_keys = [mesh_of[self._shape(entry)] for entry in collected.surfaces]
        arrays = instances.instance_arrays(collected, mesh_keys, self._ids)
        if self._wanted.vectors:
            around = (moments[time] for time in motion.NEIGHBORS)
            arrays.previous, arrays.following = (self._matrices_at(arrays.entries, moment) for moment in around)
        if self._wanted.shutter is not None:
            arrays.blur = motion.instance_blur(arrays.entries, arrays.matrices, self._wanted.shutter, moments)
        arrays.attribute_names = sorted(self._materials.instance_attribute_names)
        struct, kept = instances.fill_instances(arrays, self._groups)
        self._target.set_instances(struct)
        if self._digest is not None:
            self._digest.columns(kept[0])
            self._digest.contents(map(self._mesh_keys.content, arrays.mesh_keys))
            self._digest.contents(map(self._materials.content, arrays.materials))

    def _matrices_at(self, entries: list[Entry], moment: motion.Moment) -> array:
        """Returns the matrices of instances at another time, NaN for those that are missing or replaced."""

        def is_another_mesh(entry: Entry) -> bool:
            found = self._deforming.get(entry.key)
            return found is not None and found.shape in moment.other_topology and not found.by_velocity

        return motion.instance_motion(entries, moment, is_another_mesh)

    # Lights and the world

    def _set_lights(self, collected: Collected) -> None:
        names = sorted(self._materials.instance_attribute_names)
        attributes = instances.attributes_by_entry(collected.lights, names)
        lights = (
            self._light(entry, collected.matrices, attributes[index]) for index, entry in enumerate(collected.lights)
        )
        records = native.struct_array(native.Light, lights)
        self._target.set_lights(records, len(collected.lights))
        if self._digest is not None:
            for record in records or ():
                self._digest.struct(record)
                self._digest.contents([self._materials.content(record.material)])
            self._digest.arrays(attributes)

    def _light(self, entry: Entry, matrices: array, attributes: array) -> native.Light:
        data = entry.data
        matrix = matrices[16 * entry.index : 16 * entry.index + 16]
        record = native.Light()
        scale = tuple(sum(value * value for value in matrix[4 * axis : 4 * axis + 3]) ** 0.5 for axis in range(3))
        state = light.light_state(data, scale, compat.VERSION)
        if entry.material_keys:
            (record.material,) = entry.material_keys
            emission = (1.0, 1.0, 1.0)
        else:
            emission = light.constant_emission(data)
        record.strength[:] = [strength * factor for strength, factor in zip(state.strength, emission, strict=True)]
        record.type, record.flags, record.visibility = state.type, state.flags, entry.visibility
        record.matrix[:] = matrix
        record.radius, record.angle, record.spread = state.radius, state.angle, state.spread
        record.size[:] = state.size
        record.cone, record.blend = state.cone, state.blend
        record.sun_radiance_per_irradiance = state.sun_radiance_per_irradiance
        record.max_bounces = state.max_bounces
        record.random_id, record.pass_index = entry.random_id, entry.pass_index
        record.color[:], record.generated[:], record.uv[:] = entry.color, entry.generated, entry.uv
        record.attribute_count, record.attributes = len(attributes) // 4, native.pointer(attributes)
        record.name = native.name(entry.name)
        record.receiver_mask, record.blocker_mask = entry.links.receiver_mask, entry.links.blocker_mask
        record.light_group = self._groups.get(entry.light_group, 0)
        return record

    def _set_channels(self) -> None:
        records = channels.fill_channels(self._channels)
        self._target.set_channels(records, len(self._channels))
        if self._digest is not None:
            self._digest.contents(self._channels)

    def _set_world(self) -> None:
        layer = self._depsgraph.view_layer_eval
        found = getattr(layer, "world_override", None) or self._scene.world
        # Without sky the view layer has no world, which then is neither visible nor emits light, as in Cycles.
        key = self._materials.key(found, "WORLD") if layer.use_sky else 0
        struct = world.fill_world(found, key, self._groups)
        self._target.set_world(struct)
        if self._digest is not None:
            self._digest.struct(struct)
            self._digest.contents([self._materials.content(key)])
