"""Makes a room in which reflections and refractions move differently from the surfaces that show them.

    make_specular_motion.py FILE

The name of the file says what moves: gliding-camera (the camera alone, past a mirror and a pane of glass), moving-box
(a box behind the pane and in front of the mirror) or turning-mirror (the mirror alone).
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parents[2] / "sample_blends"))
from builders import boxes, common  # noqa: E402

FRAMES = 24
SPAN = 0.5  # meters by which the camera or the box moves
FACING, TURN = -50.0, 10.0  # degrees: direction of the mirror at first, and by how much it turns


def stripes(u: float, v: float) -> common.Color:
    """Returns soft waves in three directions, whose motion is visible and which have no edge sharper than a pixel."""
    waves = [0.5 + 0.5 * math.sin(2.0 * math.pi * (a * u + b * v)) for a, b in ((5, 0), (0, 4), (3, 3))]
    return 0.35 + 0.5 * waves[0], 0.35 + 0.5 * waves[1], 0.3 + 0.5 * waves[2]


def mirror() -> bpy.types.Object:
    """Adds a flat mirror on the right that faces the left and the camera."""
    silver = common.principled("Mirror", (0.95, 0.95, 0.95), 0.0, 1.0)
    quad = common.quad("Mirror", [(-0.6, 0.0, -0.55), (0.6, 0.0, -0.55), (0.6, 0.0, 0.55), (-0.6, 0.0, 0.55)], silver)
    quad.location = (0.85, 0.45, 0.75)
    quad.rotation_euler[2] = math.radians(FACING)
    return quad


def textured_box(name: str, place: common.Vector, material: bpy.types.Material) -> bpy.types.Object:
    box = common.box(name, place, (0.35, 0.35, 0.6), material, turn=20.0)
    box.data.uv_layers.new(name="UVMap")  # by default every face has the whole texture
    return box


def move(what: str) -> None:
    objects = bpy.data.objects
    if what == "gliding-camera":
        target, path, start, by = objects["Camera"], "location", (-0.5 * SPAN, -3.6, 1.0), (SPAN, 0.0, 0.0)
    elif what == "moving-box":
        target, path, start, by = objects["Box"], "location", (-0.75, 0.3, 0.3), (SPAN, 0.0, 0.0)
    elif what == "turning-mirror":
        turned = objects["Mirror"].rotation_euler
        target, path, start, by = objects["Mirror"], "rotation_euler", tuple(turned), (0.0, 0.0, math.radians(TURN))
    else:
        raise SystemExit(f"make_specular_motion.py: unknown scene {what}")
    common.key(target, path, [(1, start), (FRAMES, tuple(a + b for a, b in zip(start, by, strict=True)))])


def main() -> None:
    path = Path(sys.argv[1])
    common.reset()
    scene = common.settings(320, 180)
    scene.frame_start, scene.frame_end = 1, FRAMES
    common.world((0.05, 0.05, 0.06), 1.0)
    pattern = common.textured("Pattern", common.image("Pattern", 256, 256, stripes), roughness=1.0)
    gray = common.diffuse("Gray", (0.6,) * 3)
    boxes.room(3.6, 3.0, 2.2, {"floor": pattern, "ceiling": gray, "back": pattern, "left": pattern, "right": gray})
    common.area_lamp("Light", (0.0, -0.6, 2.15), (0.0, 0.0, 0.0), (1.2, 1.2), 90.0)
    mirror()
    common.box("Pane", (-0.7, -0.4, 0.7), (1.0, 0.06, 1.2), common.glass("Pane"), turn=10.0)
    textured_box("Box", (-0.5, 0.3, 0.3), pattern)
    common.camera((0.0, -3.6, 1.0), (0.0, 0.0, 0.75), lens=36)
    move(path.stem)
    path.parent.mkdir(parents=True, exist_ok=True)
    common.save(path)


main()
