"""One sync: everything of the rendered frame is read first, then (for vectors and motion blur) the moments around it, then instances and
cameras are set."""

from __future__ import annotations

import time
from array import array
from collections.abc import Callable, Sequence
from typing import Any

import bpy

from .. import compat, native
from . import camera, instances, left_out, light, mesh, motion, world
from .collect import Collected, Entry, InstanceKey, collect
from .keys import KIND_IMAGE, KIND_MATERIAL, KIND_MESH, KeyTable
from .material import Materials, Resources
from .may_move import MayMove
from .mesh import MeshArrays
from .motion import Deforming, Shape
from .report import ExportReport, Poll, Warnings
from .shutter import SHARP, blur_of, shutter_of
from .target import Target
from .views import States, cameras_of, states_of


class Exporter:
    """Keeps a native scene equal to Blender's; what did not change since the last sync is not set again."""

    def __init__(self, library: Any, scene_handle: int) -> None:
        self._target = Target(library, scene_handle)
        self._meshes = KeyTable()
        self._images = KeyTable()
        self._materials = KeyTable()
        self._ids = KeyTable()
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
    ) -> ExportReport:
        """Sets all that the depsgraph shows at its frame. Raises ExportError (text for the user) and Cancelled.

        view: the viewport's, in place of the camera; then and in previews there is no motion.
        vectors: whether the Vector pass is wanted; None: where the view layer has it.
        views: of multi-view. The first is set; show_view sets another.
        """
        start = time.perf_counter()
        wants_vectors = depsgraph.view_layer_eval.use_pass_vector if vectors is None else vectors
        wanted = motion.Wanted()
        if view is None and not is_preview:
            wanted = motion.Wanted(wants_vectors, shutter_of(depsgraph.scene_eval, depsgraph.view_layer_eval))
        run = _Sync(self, depsgraph, engine, view, wanted, views, Poll(cancelled))
        tables = ((KIND_MESH, self._meshes), (KIND_IMAGE, self._images), (KIND_MATERIAL, self._materials))
        for table in (self._ids, *(table for _, table in tables)):
            table.begin()
        try:
            run.run()
        except Exception:
            for _, table in tables:
                table.distrust()
            raise
        self._ids.sweep()
        for kind, table in tables:
            for key in table.sweep():
                self._target.remove(kind, key)
        self._views = run.filled
        self.show_view(views[0])
        return ExportReport(*run.size, run.warnings.texts, time.perf_counter() - start)

    def show_view(self, view: str) -> None:
        """Sets the camera of another view of the frame that was exported last: nothing else of it differs."""
        struct, _keep = self._views[view]
        self._target.set_camera(struct)

    def sync_camera(self, depsgraph: Any, view: camera.ViewOverride) -> None:
        """Sets the viewport's camera alone: for redraws in which nothing but the view changed."""
        self._target.set_camera(camera.fill_camera(camera.view_state(view))[0])


class _Sync:
    """The state of one call of Exporter.sync."""

    def __init__(
        self,
        exporter: Exporter,
        depsgraph: Any,
        engine: Any,
        view: camera.ViewOverride | None,
        wanted: motion.Wanted,
        views: Sequence[str],
        poll: Poll,
    ) -> None:
        self._depsgraph = depsgraph
        self._engine = engine
        self._view = view
        self._poll = poll
        self._target = exporter._target
        self._mesh_keys = exporter._meshes
        self._ids = exporter._ids
        self.warnings = Warnings()
        self._scene = depsgraph.scene_eval
        self.size = self._resolution()
        self._wanted = wanted
        resources = Resources(self._target, exporter._images, self._scene.frame_current, bpy.path.abspath, self.warnings)
        self._materials = Materials(self._target, exporter._materials, resources, poll, self.warnings)
        self._cameras = cameras_of(views, engine, self._scene) if view is None else {}
        self.filled: dict[str, tuple[native.Camera, Any]] = {}  # the cameras, by view
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
        # Where the moments around are read, they tell exactly what moves.
        collected = collect(self._depsgraph, self._poll, None if self._wanted.any() else MayMove())
        for text in (
            *left_out.of_scene(self._scene, self._depsgraph.view_layer_eval),
            *collected.left_out,
        ):
            self.warnings.add(text)
        for entry in collected.surfaces:
            entry.material_keys = self._materials.surface_keys(entry.materials)
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

    def _view_states(self) -> States:
        if self._view is not None:
            return {"": camera.view_state(self._view)}
        return states_of(self._cameras, self._depsgraph, self._engine, self.size)

    def _fill_camera(self, view: str, now: camera.CameraState, moments: motion.Moments) -> None:
        around = [motion.camera_at(view, moments[time]) for time in motion.AROUND] if self._wanted.vectors else [None, None]
        shutter = self._wanted.shutter
        keys = motion.camera_blur(view, self._cameras[view], now, shutter, moments) if shutter is not None else []
        self.filled[view] = camera.fill_camera(now, *around, shutter, keys)

    def _moments(self, collected: Collected) -> motion.Moments:
        if not self._wanted.any():
            return {}
        times = self._wanted.times({*map(blur_of, self._cameras.values()), *(entry.blur for entry in collected.surfaces)})
        return motion.read_moments(self._depsgraph, self._engine, times, self._deforming, self._cameras, self.size, self._poll)

    def _add_motion(self, found: Deforming, moments: motion.Moments) -> None:
        arrays, shutter = found.arrays, self._wanted.shutter
        if self._wanted.vectors and arrays.motion is None:
            arrays.motion = motion.mesh_motion(found, moments)
        if shutter is None or arrays.blur is not None:
            return
        arrays.blur = motion.mesh_blur(found, shutter, moments)
        if motion.changes_topology(found, shutter, moments):
            self.warnings.add(f"Object '{found.name}' changes its topology within the exposure: its deformation is not blurred")

    # Meshes

    def _shape(self, entry: Entry) -> Shape:
        """What the instances that share a mesh in the picture have in common. Without a shutter, all of the same mesh share it."""
        return entry.place, entry.blur if self._wanted.shutter is not None else SHARP

    def _read_meshes(self, collected: Collected) -> dict[Shape, int]:
        """Keys by shape; those of deforming meshes follow when the frames around have been read."""
        keys: dict[Shape, int] = {}
        deforming: dict[Shape, Deforming] = {}
        wanted = frozenset(self._materials.attribute_names)
        for entry in collected.surfaces:
            shape = self._shape(entry)
            if shape not in keys:
                self._poll()
                keys[shape] = 0
                arrays = self._read_mesh(entry, wanted)
                if arrays is not None and self._wanted.any() and motion.may_deform(entry):
                    deforming[shape] = Deforming(shape, arrays, entry.name, arrays.motion is not None)
                elif arrays is not None:
                    keys[shape] = self._set_mesh(arrays)
            if shape in deforming:
                self._deforming[entry.key] = deforming[shape]
        return keys

    def _read_mesh(self, entry: Entry, wanted: frozenset[str]) -> MeshArrays | None:
        original = entry.object.original
        undeformed = None
        has_shape_keys = getattr(original.data, "shape_keys", None) is not None
        if original.type == "MESH" and (original.modifiers or has_shape_keys or motion.is_deformed_by_parent(original)):
            undeformed = original.data
        if len(entry.data.polygons) == 0:
            return None
        arrays = mesh.read_mesh(entry.data, wanted, undeformed)
        frames_per_second = self._scene.render.fps / self._scene.render.fps_base
        if self._wanted.vectors:
            arrays.motion = motion.velocity_motion(entry.data, arrays, frames_per_second)
        if self._wanted.shutter is not None:
            arrays.blur = motion.velocity_blur(entry.data, arrays, entry.blur, self._wanted.shutter, frames_per_second)
        return arrays

    def _set_mesh(self, arrays: MeshArrays) -> int:
        key = self._mesh_keys.key(arrays.content_hash())
        if self._mesh_keys.changed(key, True):
            struct, _keep = mesh.fill_mesh(arrays)
            self._target.set_mesh(key, struct)
        return key

    def _set_instances(self, collected: Collected, mesh_of: dict[Shape, int], moments: motion.Moments) -> None:
        mesh_keys = [mesh_of[self._shape(entry)] for entry in collected.surfaces]
        arrays = instances.instance_arrays(collected, mesh_keys, self._ids.key)
        if self._wanted.vectors:
            around = (moments[time] for time in motion.AROUND)
            arrays.previous, arrays.following = (self._matrices_at(arrays.entries, moment) for moment in around)
        if self._wanted.shutter is not None:
            arrays.blur = motion.instance_blur(arrays.entries, arrays.matrices, self._wanted.shutter, moments)
        struct, _keep = instances.fill_instances(arrays)
        self._target.set_instances(struct)

    def _matrices_at(self, entries: list[Entry], moment: motion.Moment) -> array:
        def is_another_mesh(entry: Entry) -> bool:
            found = self._deforming.get(entry.key)
            return found is not None and found.shape in moment.other_topology and not found.by_velocity

        return motion.instance_motion(entries, moment, is_another_mesh)

    # Lights and the world

    def _set_lights(self, collected: Collected) -> None:
        records = native.struct_array(native.Light, (self._light(entry, collected.matrices) for entry in collected.lights))
        self._target.set_lights(records, len(collected.lights))

    def _light(self, entry: Entry, matrices: array) -> native.Light:
        data = entry.data
        matrix = matrices[16 * entry.index : 16 * entry.index + 16]
        record = native.Light()
        scale = tuple(sum(value * value for value in matrix[4 * axis : 4 * axis + 3]) ** 0.5 for axis in range(3))
        state = light.light_state(data, scale, compat.VERSION)
        emission = light.constant_emission(data)
        if emission is None:
            record.material = self._materials.key(data, "LIGHT")
            emission = (1.0, 1.0, 1.0)
        record.strength[:] = [strength * factor for strength, factor in zip(state.strength, emission, strict=True)]
        record.type, record.flags, record.visibility = state.type, state.flags, entry.visibility
        record.matrix[:] = matrix
        record.radius, record.angle, record.spread = state.radius, state.angle, state.spread
        record.size[:] = state.size
        record.cone, record.blend = state.cone, state.blend
        record.sun_radiance_per_irradiance = state.sun_radiance_per_irradiance
        record.max_bounces = state.max_bounces
        record.pass_index = entry.pass_index
        record.name = native.text(entry.name)
        return record

    def _set_world(self) -> None:
        layer = self._depsgraph.view_layer_eval
        found = getattr(layer, "world_override", None) or self._scene.world
        # Without sky the layer has no world at all, as in Cycles: neither seen nor shining.
        key = self._materials.key(found, "WORLD") if layer.use_sky else 0
        self._target.set_world(world.fill_world(found, key))
