"""The rooms that speed.py times and room.py builds: what is in each, and which modes take turns there.

Needs no Blender.
"""

from __future__ import annotations

from dataclasses import dataclass

ENGINES = ("path", "gradient-none", "cycles")
PILOT = ("path", "auto-l2")  # where gradients cannot pay, the pilot should find that out at little cost


@dataclass(frozen=True)
class Room:
    cells: int  # of each of the nine spheres, which have 2·cells² triangles
    bounces: int = 4
    pane: bool = False  # the camera sees the room through a slab of glass
    modes: tuple[str, ...] = ENGINES


ROOMS = {
    "room-1k": Room(8),
    "room-300k": Room(128),
    "room-2m": Room(354),
    "direct-light": Room(8, bounces=0, modes=PILOT),
    "behind-glass": Room(8, pane=True, modes=PILOT),
}
