"""Simulations that are not baked. A frame is correct only after the scene has visited all frames before it, one by one.

Facts about Blender 3.4, 4.5 and 5.0 on which this module relies:

- Rigid bodies and simulation zones are computed only by the scene's own depsgraph (`scene.frame_set`), from the
  previous frame. The engine's depsgraph (`engine.frame_set`) reads their caches. An animated render never moves the
  scene's own depsgraph.
- Cloth, soft bodies, particles and dynamic paint are computed by both depsgraphs, into one cache. After a visit to
  their first frame Blender considers the cache outdated and drops its later frames at the next read, unless it is
  marked as baked. Therefore caches are marked as baked, except while this module steps through the frames. Dynamic
  paint always caches on disk, beside the saved file.
- The engine's depsgraph keeps the state of a cache from its last evaluation at Blender's own frame, and shows no
  particles, or dead ones, that are computed later. Therefore the particles of all frames are computed before the first
  frame is shown. Liquids that are computed during playback are correct only if the scene has not been far beyond the
  frame.
- In a render that begins at a later frame, the engine's depsgraph has already written an estimate into the cache of a
  cloth. Tagging the object drops it.
- After the render, Blender reads values that are not evaluated (exposure of saved images, the file name) from the
  scene, which therefore must return to the frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import bpy

from .export import Cancelled
from .may_be_seen import MayBeSeen, is_keyed

_DEFORMING = frozenset({"CLOTH", "SOFT_BODY"})
_ESTIMATED = _DEFORMING | {"DYNAMIC_PAINT"}


class Simulations:
    """Steps those simulations of a scene that its images may show. All view layers and views share it.

    layer: a view layer that is rendered even if it is disabled.
    """

    def __init__(self, scene: Any, layer: str = "") -> None:
        self.scene = scene
        self._may_be_seen = MayBeSeen(_with_backgrounds(scene), layer)
        self.names: list[str] = []
        self._first = scene.frame_start
        self._caches: list[Any] = []  # caches that are marked as baked between steps
        self._estimated: list[Any] = []  # objects whose caches may hold an estimate
        self._has_particles = False
        self._computed: int | None = None  # the last frame up to which all simulations are computed
        self._find()

    def _find(self) -> None:
        for scene in _with_backgrounds(self.scene):
            world = scene.rigidbody_world
            if world is not None and world.enabled and not _is_stored(world.point_cache) and self._shows_bodies(world):
                self._add("Rigid Body World", world.point_cache.frame_start)
        for obj in _with_instances(obj for scene in _with_backgrounds(self.scene) for obj in scene.objects):
            found = [(modifier, *each) for modifier in obj.modifiers for each in self._not_baked(obj, modifier)]
            # An invisible rigid body may push others.
            if found and (obj.rigid_body is not None or self._may_be_seen(obj)):
                for each in found:
                    self._add_modifier(obj, *each)

    def _shows_bodies(self, world: Any) -> bool:
        """Returns whether a rigid body world has bodies. Blender keeps an empty world after its bodies were deleted."""
        return world.collection is not None and any(self._may_be_seen(obj) for obj in world.collection.all_objects)

    def _not_baked(self, obj: Any, modifier: Any) -> Iterator[tuple[int, Any]]:
        """Yields the first frame of each simulation of a modifier, and its cache if all depsgraphs write to it."""
        if not modifier.show_render and not is_keyed(obj, "show_render"):
            return
        for cache in _point_caches(modifier):
            if not _is_stored(cache, is_always_on_disk=modifier.type == "DYNAMIC_PAINT"):
                yield cache.frame_start, cache
        is_domain = modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN"
        if is_domain and modifier.domain_settings.cache_type == "REPLAY":
            yield modifier.domain_settings.cache_frame_start, None
        # The Python API does not expose which zones are baked. Stepping baked ones only costs time.
        if modifier.type == "NODES" and _has_zone(modifier.node_group, set()):
            yield self.scene.frame_start, None

    def _add_modifier(self, obj: Any, modifier: Any, first: int, cache: Any) -> None:
        self._add(f"{obj.name}, {modifier.name}", first)
        if cache is not None:
            self._caches.append(cache)
        if modifier.type in _ESTIMATED:
            self._estimated.append(obj)
        self._has_particles = self._has_particles or modifier.type == "PARTICLE_SYSTEM"

    def _add(self, name: str, first: int) -> None:
        self.names.append(name)
        self._first = min(self._first, first)

    def go_to(self, frame: int) -> None:
        """Moves the scene to a frame that was computed."""
        if self.scene.frame_current != frame:
            self.scene.frame_set(frame)

    def compute(self, last: int, last_of_job: int, is_stop_requested: Callable[[], bool]) -> None:
        """Computes all simulations up to the frame `last`, and up to the last frame of the job if there are particles.

        One more frame is computed, because Blender caches the first frame of a simulation while it computes the second.
        Raises Cancelled, and then the scene is at its previous frame.
        """
        if self._has_particles:
            last = max(last, last_of_job)
        if self._computed is not None and last < self._computed:
            return
        own = self.scene.frame_current
        self._mark_as_baked(False)
        try:
            self._step(last + 1, is_stop_requested)
        except Cancelled:
            self.go_to(own)
            raise
        finally:
            self._mark_as_baked(True)

    def _step(self, last: int, is_stop_requested: Callable[[], bool]) -> None:
        if self._computed is None:
            for obj in self._estimated:
                obj.update_tag(refresh={"OBJECT"})
            self._computed = self._first
        # Even if the scene is at this frame, because its caches may have been read at other frames.
        self.scene.frame_set(self._computed)
        for frame in range(self._computed + 1, last + 1):
            if is_stop_requested():
                raise Cancelled
            self.scene.frame_set(frame)
            self._computed = frame

    def _mark_as_baked(self, wanted: bool) -> None:
        operator = bpy.ops.ptcache.bake_from_cache if wanted else bpy.ops.ptcache.free_bake
        for cache in self._caches:
            if cache.is_baked != wanted:
                with bpy.context.temp_override(point_cache=cache):
                    operator()

    def free(self) -> None:
        """Removes the marks from the caches."""
        if self._computed is not None:
            self._mark_as_baked(False)


def _with_backgrounds(scene: Any) -> Iterator[Any]:
    """Yields a scene and its chain of background scenes."""
    while scene is not None:
        yield scene
        scene = scene.background_set


def _with_instances(objects: Iterable[Any]) -> list[Any]:
    """Returns each object once, with the objects of instanced collections, which may be in no view layer."""
    found = dict.fromkeys(objects)
    waiting = list(found)
    while waiting:
        obj = waiting.pop()
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            new = [other for other in obj.instance_collection.all_objects if other not in found]
            found.update(dict.fromkeys(new))
            waiting += new
    return list(found)


def _is_stored(cache: Any, is_always_on_disk: bool = False) -> bool:
    """Returns whether a cache holds all frames. A cache that can only be on disk need not be complete."""
    return cache.is_baked or cache.use_external or (cache.use_disk_cache and not is_always_on_disk)


def _point_caches(modifier: Any) -> Iterator[Any]:
    if modifier.type in _DEFORMING:
        yield modifier.point_cache
    elif modifier.type == "PARTICLE_SYSTEM":
        system = modifier.particle_system
        if system.settings.type == "EMITTER" or system.use_hair_dynamics:
            yield system.point_cache
    elif modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings is not None:
        yield from (surface.point_cache for surface in modifier.canvas_settings.canvas_surfaces)


def _has_zone(group: Any, seen: set[int]) -> bool:
    """Returns whether a node group, or one inside it, has a simulation zone (from Blender 3.6 on)."""
    if group is None or group.as_pointer() in seen:
        return False
    seen.add(group.as_pointer())
    return any(
        node.bl_idname == "GeometryNodeSimulationOutput" or (node.type == "GROUP" and _has_zone(node.node_tree, seen))
        for node in group.nodes
    )


# ------------------------------------------------------------------------------------------------ the running job

_found: dict[str, Simulations] = {}


def of_job(depsgraph: Any) -> Simulations | None:
    """Returns the simulations of a scene that are not baked, or None. They are searched once in a job."""
    scene = depsgraph.scene
    if scene.name_full not in _found:
        _found[scene.name_full] = Simulations(scene, depsgraph.view_layer.name)
    found = _found[scene.name_full]
    return found if found.names else None


def clear() -> None:
    """Restores all caches at the end of the job."""
    while _found:
        _found.popitem()[1].free()


def discard() -> None:
    """Drops everything without restoring caches, because their file is closed."""
    _found.clear()
