"""The hero scene: a still life on a bench in a room lit by one window."""

from __future__ import annotations

import math
import random

import bpy

from . import common

HALF, HEIGHT = 2.3, 2.6  # m: the room is a closed box
BENCH = 0.5  # height of the bench's top


def planks(u: float, v: float) -> common.Color:
    """Boards of oak with grain and dark joints; repeats in both directions."""
    row = int(v * 6)
    shift = (row * 0.37) % 1.0
    board = int(((u + shift) % 1.0) * 2) + 2 * row
    tone = random.Random(board).uniform(-0.06, 0.06)
    across = v * 6 - row
    along = ((u + shift) % 1.0) * 2 % 1.0
    grain = 0.035 * math.sin(across * 34 + 2.5 * math.sin(2 * math.pi * (u + shift) * 2 + board)) + 0.02 * math.sin(across * 91 + board)
    joint = 0.55 if across < 0.03 or along < 0.006 else 1.0
    return tuple(max(0.0, min(1.0, (channel + tone + grain) * joint)) for channel in (0.62, 0.44, 0.29))


def painting(u: float, v: float) -> common.Color:
    """Hills under an evening sky."""
    ridges = ((0.52, 0.10, 3.1, (0.45, 0.42, 0.55)), (0.38, 0.08, 5.3, (0.28, 0.36, 0.44)), (0.2, 0.06, 4.1, (0.16, 0.25, 0.24)))
    color = (0.95 - 0.35 * v, 0.62 + 0.1 * v, 0.38 + 0.42 * v)
    if (u - 0.68) ** 2 + (v - 0.66) ** 2 < 0.006:
        color = (1.0, 0.9, 0.7)
    for base, swing, waves, shade in ridges:
        if v < base + swing * math.sin(waves * u + 10 * base) + 0.02 * math.sin(23 * u * waves):
            color = shade
    return color


def _room() -> None:
    x = y = HALF
    z = HEIGHT
    wall = common.diffuse("Wall", (0.78, 0.74, 0.68))
    blue = common.diffuse("Blue wall", (0.24, 0.36, 0.42))
    floor = common.textured("Oak", common.image("Planks", 192, 192, planks), 0.35)
    common.quad("Floor", [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], floor, tiles=3.0)
    common.quad("Ceiling", [(-x, -y, z), (-x, y, z), (x, y, z), (x, -y, z)], common.diffuse("Ceiling", (0.82, 0.82, 0.8)))
    common.quad("Back", [(-x, y, 0), (x, y, 0), (x, y, z), (-x, y, z)], blue)
    common.quad("Left", [(-x, -y, 0), (-x, y, 0), (-x, y, z), (-x, -y, z)], wall)
    common.quad("Right", [(x, y, 0), (x, -y, 0), (x, -y, z), (x, y, z)], wall)
    common.quad("Front", [(x, -y, 0), (-x, -y, 0), (-x, -y, z), (x, -y, z)], wall)
    skirting = common.principled("Skirting", (0.8, 0.79, 0.76), 0.4)
    common.box("Skirting back", (0, y - 0.015, 0.06), (2 * x, 0.03, 0.12), skirting)
    common.box("Skirting left", (-x + 0.015, 0, 0.06), (0.03, 2 * y, 0.12), skirting)


def _window() -> None:
    """An area light of the size of a window in the left wall, behind white bars."""
    common.area_lamp("Window", (-HALF + 0.02, 0.1, 1.55), (0.4, 0.1, 1.2), (1.1, 1.3), 150.0, (1.0, 0.95, 0.86))
    white = common.principled("Frame", (0.8, 0.8, 0.78), 0.35)
    x = -HALF + 0.06
    for y, z, sy, sz in (
        (0.1, 2.23, 1.3, 0.08),
        (0.1, 0.87, 1.3, 0.08),
        (-0.51, 1.55, 0.08, 1.44),
        (0.71, 1.55, 0.08, 1.44),
        (0.1, 1.55, 0.04, 1.3),
        (0.1, 1.55, 1.2, 0.04),
    ):
        common.box("Window bar", (x, y, z), (0.05, sy, sz), white, bevel=0.006)


def _bench() -> None:
    wood = common.principled("Walnut", (0.2, 0.11, 0.065), 0.4)
    y = HALF - 0.55
    common.box("Bench", (0.1, y, BENCH - 0.035), (2.6, 0.62, 0.07), wood, bevel=0.015)
    for x in (-1.05, 1.25):
        common.box("Leg", (x, y, 0.5 * (BENCH - 0.07)), (0.07, 0.5, BENCH - 0.07), wood, bevel=0.01)
    frame = common.principled("Brass frame", (0.75, 0.55, 0.25), 0.3, 1.0)
    z = 1.3
    for dx, dz, sx, sz in ((0, 0.36, 1.04, 0.05), (0, -0.36, 1.04, 0.05), (-0.5, 0, 0.05, 0.74), (0.5, 0, 0.05, 0.74)):
        common.box("Frame", (0.35 + dx, HALF - 0.02, z + dz), (sx, 0.04, sz), frame, bevel=0.006)
    canvas = common.textured("Painting", common.image("Painting", 128, 90, painting), 0.7)
    common.quad(
        "Painting",
        [(-0.15, HALF - 0.015, z - 0.35), (0.85, HALF - 0.015, z - 0.35), (0.85, HALF - 0.015, z + 0.35), (-0.15, HALF - 0.015, z + 0.35)],
        canvas,
    )


VASE = [(0.0, 0.0), (0.085, 0.0), (0.1, 0.02), (0.125, 0.12), (0.11, 0.24), (0.06, 0.34), (0.05, 0.4), (0.07, 0.46), (0.078, 0.47)]
VASE_INSIDE = [(0.07, 0.468), (0.04, 0.4), (0.05, 0.335), (0.1, 0.235), (0.112, 0.12), (0.085, 0.03), (0.0, 0.02)]
JUG = [
    (0.0, 0.0),
    (0.1, 0.0),
    (0.13, 0.05),
    (0.15, 0.14),
    (0.13, 0.25),
    (0.085, 0.33),
    (0.08, 0.38),
    (0.1, 0.43),
    (0.09, 0.43),
    (0.072, 0.38),
    (0.075, 0.33),
    (0.0, 0.25),
]
BOWL = [(0.0, 0.012), (0.07, 0.0), (0.075, 0.02), (0.17, 0.08), (0.21, 0.15), (0.203, 0.152), (0.162, 0.088), (0.07, 0.035), (0.0, 0.03)]
POT = [(0.0, 0.0), (0.17, 0.0), (0.22, 0.32), (0.25, 0.32), (0.25, 0.38), (0.22, 0.38), (0.2, 0.33), (0.0, 0.3)]


def _smooth(obj: bpy.types.Object) -> None:
    """Rounds a turned profile."""
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 2


def _still_life() -> None:
    y = HALF - 0.55
    glass = common.glass("Glass", (0.93, 0.98, 0.96))
    _smooth(common.lathe("Vase", VASE + VASE_INSIDE, glass, (-0.75, y, BENCH + 0.001), 24))
    _smooth(common.lathe("Jug", JUG, common.principled("Glaze", (0.82, 0.8, 0.76), 0.12), (-0.38, y + 0.08, BENCH), 24))
    common.sphere("Chrome ball", (0.02, y - 0.1, BENCH + 0.12), 0.12, common.principled("Chrome", (0.92, 0.92, 0.93), 0.03, 1.0))
    _smooth(common.lathe("Bowl", BOWL, common.principled("Copper", (0.93, 0.5, 0.33), 0.3, 1.0), (0.42, y, BENCH), 24))
    orange = common.principled("Orange", (0.85, 0.32, 0.03), 0.45)
    for dx, dy, dz in ((-0.06, 0.02, 0.1), (0.07, -0.02, 0.105), (0.0, 0.06, 0.17)):
        common.sphere("Orange", (0.42 + dx, y + dy, BENCH + dz), 0.065, orange, 32)
    colors = ((0.45, 0.08, 0.06), (0.08, 0.16, 0.3), (0.6, 0.5, 0.3))
    for index, color in enumerate(colors):
        cover = common.principled(f"Book {index}", color, 0.55)
        common.box(
            f"Book {index}",
            (0.98, y, BENCH + 0.025 + 0.05 * index),
            (0.3 - 0.03 * index, 0.22, 0.048),
            cover,
            turn=8 - 14 * index,
            bevel=0.006,
        )
    marble = common.principled("Marble", (0.75, 0.73, 0.7), 0.2)
    _smooth(
        common.lathe(
            "Candle holder",
            [(0.0, 0.0), (0.07, 0.0), (0.07, 0.015), (0.02, 0.04), (0.02, 0.1), (0.05, 0.12), (0.0, 0.12)],
            marble,
            (0.98, y, BENCH + 0.15),
            24,
        )
    )
    common.sphere("Candle light", (0.98, y, BENCH + 0.31), 0.03, common.emission("Flame", (1.0, 0.6, 0.25), 14.0), 24)


def _floor_pieces() -> None:
    terracotta = common.principled("Terracotta", (0.55, 0.22, 0.12), 0.8)
    _smooth(common.lathe("Pot", POT, terracotta, (1.65, HALF - 0.6, 0.0), 24))
    common.sphere("Moss", (1.65, HALF - 0.6, 0.45), 0.27, common.diffuse("Moss", (0.1, 0.2, 0.06)), 32)
    brass = common.principled("Brass", (0.85, 0.62, 0.28), 0.18, 1.0)
    common.sphere("Brass ball", (0.85, HALF - 1.12, 0.16), 0.16, brass)
    common.sphere("Glass ball", (-0.15, HALF - 1.2, 0.13), 0.13, common.glass("Clear glass"), 48)


def build() -> None:
    """Closed room, window light, still life; 960 x 540."""
    scene = common.settings(960, 540)
    scene.view_settings.view_transform = "Filmic"
    common.world((0, 0, 0), 0.0)
    _room()
    _window()
    _bench()
    _still_life()
    _floor_pieces()
    common.camera((0.95, -1.05, 1.15), (0.2, HALF - 0.6, 0.62), lens=34)
