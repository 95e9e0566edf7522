"""Simulations that are not baked: right in a frame only when the scene has passed the frames before, one by one.

What was found in 3.4, 4.5 and 5.0, and is relied on here:
- Rigid bodies and simulation zones are computed by the scene's own depsgraph alone (`scene.frame_set`), from the frame before; that of
  the engine (`engine.frame_set`) reads what is cached. An animated render never moves the scene's own depsgraph.
- Cloth, soft bodies, particles and dynamic paint are computed by both, into one cache. A visit to their first frame makes Blender forget
  that the cache is exact, and the next read drops what lies behind; a cache that counts as baked is left alone. So it does, except while
  we step. That of dynamic paint is always on disk, beside the file: there is none before that is saved.
- The engine's depsgraph keeps what it knew of a cache when it was last evaluated for Blender's own frame: of particles that are computed
  later it shows none, or dead ones. So those of all frames are computed before the first one is shown. (Liquids that are computed as they
  are played are right only where the scene has not been far beyond the frame.)
- The depsgraph of a render that begins later has put its own guess into the cache of a cloth before we are asked: a tag drops it.
- Blender reads what is not evaluated (the exposure of saved pictures, the file name) from the scene after the render: it must be at the
  frame again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import bpy

from .export import Cancelled
from .may_be_seen import MayBeSeen, is_keyed

_DEFORMING = frozenset({"CLOTH", "SOFT_BODY"})
_GUESSED = _DEFORMING | {"DYNAMIC_PAINT"}


class Simulations:
    """The simulations of a scene that its pictures may show, which this steps; several view layers and views share it. layer: one that is
    rendered, even where it is switched off."""

    def __init__(self, scene: Any, layer: str = "") -> None:
        self.scene = scene
        self._may_be_seen = MayBeSeen(_with_backgrounds(scene), layer)
        self.names: list[str] = []
        self._first = scene.frame_start
        self._caches: list[Any] = []  # those that count as baked between steps
        self._guessed: list[Any] = []  # objects whose caches may hold a guess
        self._has_particles = False
        self._computed: int | None = None  # last frame up to which all are computed
        self._find()

    def _find(self) -> None:
        for scene in _with_backgrounds(self.scene):
            world = scene.rigidbody_world
            if world is not None and world.enabled and not _is_kept(world.point_cache) and self._shows_bodies(world):
                self._add("Rigid Body World", world.point_cache.frame_start)
        for obj in _with_instances(obj for scene in _with_backgrounds(self.scene) for obj in scene.objects):
            found = [(modifier, *each) for modifier in obj.modifiers for each in self._not_baked(obj, modifier)]
            # What deforms a body may push others.
            if found and (obj.rigid_body is not None or self._may_be_seen(obj)):
                for each in found:
                    self._take(obj, *each)

    def _shows_bodies(self, world: Any) -> bool:
        """A world stays behind, empty, where its bodies were deleted."""
        return world.collection is not None and any(self._may_be_seen(obj) for obj in world.collection.all_objects)

    def _not_baked(self, obj: Any, modifier: Any) -> Iterator[tuple[int, Any]]:
        """First frames of what a modifier simulates, with the caches that every depsgraph writes into, or None."""
        if not modifier.show_render and not is_keyed(obj, "show_render"):
            return
        for cache in _point_caches(modifier):
            if not _is_kept(cache, is_always_on_disk=modifier.type == "DYNAMIC_PAINT"):
                yield cache.frame_start, cache
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.domain_settings.cache_type == "REPLAY":
            yield modifier.domain_settings.cache_frame_start, None
        # Blender does not tell which zones are baked; to step those costs time alone.
        if modifier.type == "NODES" and _has_zone(modifier.node_group, set()):
            yield self.scene.frame_start, None

    def _take(self, obj: Any, modifier: Any, first: int, cache: Any) -> None:
        self._add(f"{obj.name}, {modifier.name}", first)
        if cache is not None:
            self._caches.append(cache)
        if modifier.type in _GUESSED:
            self._guessed.append(obj)
        self._has_particles = self._has_particles or modifier.type == "PARTICLE_SYSTEM"

    def _add(self, name: str, first: int) -> None:
        self.names.append(name)
        self._first = min(self._first, first)

    def show(self, frame: int) -> None:
        """Moves the scene to a frame that was computed."""
        if self.scene.frame_current != frame:
            self.scene.frame_set(frame)

    def compute(self, last: int, last_of_job: int, stop: Callable[[], bool]) -> None:
        """Up to the frame `last`, where there are particles to that of the job, and one more: a simulation's second frame is what puts the
        first into the cache. Raises Cancelled, with the scene at the frame where it was."""
        if self._has_particles:
            last = max(last, last_of_job)
        if self._computed is not None and last < self._computed:
            return
        own = self.scene.frame_current
        self._count_as_baked(False)
        try:
            self._step(last + 1, stop)
        except Cancelled:
            self.show(own)
            raise
        finally:
            self._count_as_baked(True)

    def _step(self, last: int, stop: Callable[[], bool]) -> None:
        if self._computed is None:
            for obj in self._guessed:
                obj.update_tag(refresh={"OBJECT"})
            self._computed = self._first
        # Also where the scene seems to be there: the caches have been read at other frames meanwhile.
        self.scene.frame_set(self._computed)
        for frame in range(self._computed + 1, last + 1):
            if stop():
                raise Cancelled
            self.scene.frame_set(frame)
            self._computed = frame

    def _count_as_baked(self, wanted: bool) -> None:
        operator = bpy.ops.ptcache.bake_from_cache if wanted else bpy.ops.ptcache.free_bake
        for cache in self._caches:
            if cache.is_baked != wanted:
                with bpy.context.temp_override(point_cache=cache):
                    operator()

    def free(self) -> None:
        """The caches are the user's again."""
        if self._computed is not None:
            self._count_as_baked(False)


def _with_backgrounds(scene: Any) -> Iterator[Any]:
    """The scene, the one behind it, and so on."""
    while scene is not None:
        yield scene
        scene = scene.background_set


def _with_instances(objects: Iterable[Any]) -> list[Any]:
    """Each object once, and those of the collections that they instance, which need be nowhere else."""
    found = dict.fromkeys(objects)
    waiting = list(found)
    while waiting:
        obj = waiting.pop()
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            new = [other for other in obj.instance_collection.all_objects if other not in found]
            found.update(dict.fromkeys(new))
            waiting += new
    return list(found)


def _is_kept(cache: Any, is_always_on_disk: bool = False) -> bool:
    """Whether it is read from somewhere, whatever the depsgraph. What is on disk for want of another place need not be complete."""
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
    """Whether a node group, or one inside it, simulates. From 3.6 on."""
    if group is None or group.as_pointer() in seen:
        return False
    seen.add(group.as_pointer())
    return any(
        node.bl_idname == "GeometryNodeSimulationOutput" or (node.type == "GROUP" and _has_zone(node.node_tree, seen))
        for node in group.nodes
    )


# ------------------------------------------------------------------------------------------------ of the running job

_found: dict[str, Simulations] = {}


def of_job(depsgraph: Any) -> Simulations | None:
    """The simulations of a scene that are not baked, looked for once in a job; None if there are none. A view layer that is switched off is
    rendered alone."""
    scene = depsgraph.scene
    if scene.name_full not in _found:
        _found[scene.name_full] = Simulations(scene, depsgraph.view_layer.name)
    found = _found[scene.name_full]
    return found if found.names else None


def clear() -> None:
    """The job has ended."""
    while _found:
        _found.popitem()[1].free()


def forget() -> None:
    """A file is loaded: there is nothing to give back."""
    _found.clear()
