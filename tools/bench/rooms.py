"""The rooms that speed.py times and room.py builds: what is in each, and which modes take turns there. Needs no Blender."""

from __future__ import annotations

from dataclasses import dataclass

Turn = tuple[str, str]  # mode, Blender
ENGINES: tuple[Turn, ...] = (("path", "4.5"), ("gradient-none", "4.5"), ("cycles", "4.5"), ("cycles", "3.4"))
CHOICE: tuple[Turn, ...] = (("path", "4.5"), ("auto", "4.5"))  # where gradients cannot pay, AUTO should cost what plain path tracing costs


@dataclass(frozen=True)
class Room:
    cells: int  # of each of the nine spheres, which have 2·cells² triangles
    bounces: int = 4
    pane: bool = False  # all is seen through a slab of glass
    turns: tuple[Turn, ...] = ENGINES


ROOMS = {
    "room-1k": Room(8),
    "room-300k": Room(128),
    "room-2m": Room(354),
    "direct-light": Room(8, bounces=0, turns=CHOICE),
    "behind-glass": Room(8, pane=True, turns=CHOICE),
}
