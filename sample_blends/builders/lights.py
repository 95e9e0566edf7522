"""A hall with two hundred small lamps: the choice among many lights."""

from __future__ import annotations

import math

import bpy

from . import common

LAMPS = 200


def _columns(stone: bpy.types.Material) -> None:
    profile = [(0.0, 0.0), (0.34, 0.0), (0.34, 0.12), (0.24, 0.2), (0.22, 1.5), (0.2, 2.7), (0.3, 2.82), (0.3, 3.0), (0.0, 3.0)]
    first = common.lathe("Column", profile, stone, (-2.2, -4.0, 0), steps=32)
    for row in range(6):
        for side in (-1, 1):
            if row == 0 and side < 0:
                continue
            copy = common.link(first.data, "Column", (2.2 * side, -4.0 + 2.0 * row, 0))
            screw = copy.modifiers.new("Screw", "SCREW")
            screw.steps = screw.render_steps = 32
            screw.use_normal_calculate = screw.use_smooth_shade = True


def _lamps() -> None:
    """Garlands along the hall; eight kinds of lamp, shared by all."""
    kinds = []
    for index in range(8):
        data = bpy.data.lights.new(f"Lamp {index}", "POINT")
        angle = 2.0 * math.pi * index / 8
        data.color = (0.75 + 0.25 * math.cos(angle), 0.7 + 0.2 * math.cos(angle - 2.1), 0.65 + 0.3 * math.cos(angle + 2.1))
        data.energy = 0.5 + 0.25 * index
        data.shadow_soft_size = 0.02
        kinds.append(data)
    for index in range(LAMPS):
        garland, place = index % 5, index // 5
        along = place / (LAMPS // 5 - 1)
        x = -3.2 + 1.6 * garland
        y = -4.6 + 10.6 * along
        z = 2.9 - 0.55 * abs(math.sin(math.pi * (3.0 * along + 0.2 * garland)))
        common.link(kinds[(index * 5 + garland) % 8], f"Lamp {index:03d}", (x, y, z))


def build() -> None:
    """Columns, vases on plinths, a glossy floor."""
    common.settings(800, 450)
    common.world((0.1, 0.15, 0.3), 0.02)
    stone = common.principled("Stone", (0.6, 0.57, 0.52), 0.6)
    floor = common.principled("Floor", (0.22, 0.2, 0.19), 0.25)
    wall = common.diffuse("Wall", (0.6, 0.5, 0.42))
    common.quad("Floor", [(-4, -6, 0), (4, -6, 0), (4, 7, 0), (-4, 7, 0)], floor)
    common.quad("Back", [(-4, 7, 0), (4, 7, 0), (4, 7, 4), (-4, 7, 4)], wall)
    common.quad("Left", [(-4, -6, 0), (-4, 7, 0), (-4, 7, 4), (-4, -6, 4)], wall)
    common.quad("Right", [(4, 7, 0), (4, -6, 0), (4, -6, 4), (4, 7, 4)], wall)
    common.quad("Ceiling", [(-4, -6, 4), (-4, 7, 4), (4, 7, 4), (4, -6, 4)], wall)
    _columns(stone)
    vase = [
        (0.0, 0.0),
        (0.16, 0.0),
        (0.2, 0.08),
        (0.26, 0.3),
        (0.2, 0.5),
        (0.09, 0.62),
        (0.09, 0.7),
        (0.15, 0.76),
        (0.12, 0.76),
        (0.06, 0.68),
        (0.0, 0.5),
    ]
    metals = [common.principled("Gold", (1.0, 0.72, 0.3), 0.2, 1.0), common.principled("Glaze", (0.1, 0.25, 0.4), 0.1)]
    for index in range(4):
        place = (-0.9 + 1.8 * (index % 2), -1.5 + 3.0 * (index // 2), 0.0)
        common.box(f"Plinth {index}", (place[0], place[1], 0.3), (0.6, 0.6, 0.6), stone, bevel=0.03)
        common.lathe(f"Vase {index}", vase, metals[index % 2], (place[0], place[1], 0.6), steps=48)
    _lamps()
    common.camera((0.5, -5.6, 1.6), (0.0, 0.0, 1.15), lens=28)
