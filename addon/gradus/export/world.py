"""The world: its program, mist, ambient occlusion distance and how it is sampled."""

from __future__ import annotations

from typing import Any

from .. import native
from .visibility import ALL_RAYS, CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, VOLUME

_MIST = {"QUADRATIC": 0, "LINEAR": 1, "INVERSE_QUADRATIC": 2}
_IMPORTANCE = {"NONE": 0, "AUTOMATIC": 1, "MANUAL": 2}
# Names of Cycles' properties for the visibility of the world.
_CYCLES_VISIBILITY = (
    ("camera", CAMERA),
    ("diffuse", DIFFUSE),
    ("glossy", GLOSSY),
    ("transmission", TRANSMISSION),
    ("scatter", VOLUME),
)


def world_visibility(world: Any) -> int:
    """Returns the flags of the kinds of rays that see the world."""
    switches = getattr(world, "cycles_visibility", None)
    bits = ALL_RAYS
    for name, bit in _CYCLES_VISIBILITY:
        if not getattr(switches, name, True):
            bits &= ~bit
    return bits


def fill_world(world: Any, material: int, groups: dict[str, int]) -> native.World:
    """Returns a native World. `world` may be None: the world is then black and has no mist.

    groups: the numbers of light groups by name.
    """
    struct = native.World()
    struct.visibility = ALL_RAYS
    struct.importance = 1
    struct.mist_depth, struct.mist_falloff = 100.0, _MIST["LINEAR"]  # without a world, as in Cycles
    struct.ao_distance = 10.0  # as in Cycles
    if world is None:
        return struct
    struct.visibility = world_visibility(world)
    struct.material = material
    struct.light_group = groups.get(getattr(world, "lightgroup", ""), 0)
    cycles = getattr(world, "cycles", None)
    struct.importance = _IMPORTANCE.get(getattr(cycles, "sampling_method", "AUTOMATIC"), 1)
    struct.map_size = getattr(cycles, "sample_map_resolution", 1024)
    mist = world.mist_settings
    struct.mist_start = mist.start
    struct.mist_depth = mist.depth
    struct.mist_falloff = _MIST.get(mist.falloff, 0)
    struct.ao_distance = max(world.light_settings.distance, 0.0)
    return struct
