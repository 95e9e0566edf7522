"""Two small rooms: the classic box, and one with glass and chrome."""

from __future__ import annotations

import bpy

from . import common


def room(width: float, depth: float, height: float, materials: dict[str, bpy.types.Material]) -> None:
    """Floor, ceiling, back, left and right; open to the front (-Y). Normals point inwards."""
    x, y, z = 0.5 * width, 0.5 * depth, height
    common.quad("Floor", [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], materials["floor"])
    common.quad("Ceiling", [(-x, -y, z), (-x, y, z), (x, y, z), (x, -y, z)], materials["ceiling"])
    common.quad("Back", [(-x, y, 0), (x, y, 0), (x, y, z), (-x, y, z)], materials["back"])
    common.quad("Left", [(-x, -y, 0), (-x, y, 0), (-x, y, z), (-x, -y, z)], materials["left"])
    common.quad("Right", [(x, y, 0), (x, -y, 0), (x, -y, z), (x, y, z)], materials["right"])


def _walls(
    white: tuple[float, float, float], left: tuple[float, float, float], right: tuple[float, float, float]
) -> dict[str, bpy.types.Material]:
    plain = common.diffuse("White", white)
    return {"floor": plain, "ceiling": plain, "back": plain, "left": common.diffuse("Left", left), "right": common.diffuse("Right", right)}


def cornell() -> None:
    """A box with red and green walls, a lamp in the ceiling and two blocks: diffuse light between surfaces."""
    common.settings(512, 512)
    common.world((0, 0, 0), 0.0)
    walls = _walls((0.73, 0.73, 0.73), (0.65, 0.06, 0.05), (0.12, 0.45, 0.15))
    room(2.0, 2.0, 2.0, walls)
    common.box("Tall", (-0.35, 0.35, 0.6), (0.6, 0.6, 1.2), walls["floor"], turn=18)
    common.box("Short", (0.35, -0.25, 0.3), (0.6, 0.6, 0.6), walls["floor"], turn=-17)
    light = common.emission("Lamp", (1.0, 0.85, 0.6), 28.0)
    common.quad("Lamp", [(-0.25, -0.2, 1.995), (-0.25, 0.2, 1.995), (0.25, 0.2, 1.995), (0.25, -0.2, 1.995)], light)
    common.camera((0, -4.9, 1.0), (0, 0, 1.0), lens=64)


def glass_and_chrome() -> None:
    """The same room with a glass and a chrome ball, frosted glass and brushed metal: chains of specular surfaces."""
    common.settings(640, 480, bounces=12)
    common.world((0.02, 0.025, 0.03), 1.0)
    room(2.6, 2.2, 2.0, _walls((0.7, 0.7, 0.68), (0.6, 0.3, 0.08), (0.08, 0.25, 0.5)))
    common.sphere("Chrome", (-0.62, 0.35, 0.45), 0.45, common.principled("Chrome", (0.9, 0.9, 0.92), 0.02, 1.0))
    common.sphere("Glass", (0.5, -0.15, 0.4), 0.4, common.glass("Glass"))
    common.sphere("Frosted", (-0.15, -0.6, 0.2), 0.2, common.glass("Frosted", (0.85, 0.95, 0.9), 0.25))
    common.box("Metal", (0.75, 0.7, 0.5), (0.4, 0.4, 1.0), common.principled("Brushed", (0.9, 0.55, 0.3), 0.35, 1.0), 25, bevel=0.03)
    common.area_lamp("Key", (0, -0.2, 1.98), (0, -0.2, 0), (0.8, 0.5), 45.0, (1.0, 0.93, 0.85))
    common.camera((0, -4.2, 1.1), (0, 0, 0.8), lens=40)
