"""Makes a room in which nothing moves and one of two lights goes off at frame 6. usage: make_light_off.py FILE"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parents[2] / "sample_blends"))
from builders import boxes, common  # noqa: E402

FRAMES, OFF = 10, 6


def switch_off(light: bpy.types.Object) -> None:
    for frame, watts in ((1, light.data.energy), (OFF, 0.0)):
        light.data.energy = watts
        light.data.keyframe_insert("energy", frame=frame)
    for curve in light.data.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "CONSTANT"


def main() -> None:
    common.reset()
    common.settings(640, 360)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, FRAMES
    common.world((0.02, 0.02, 0.02), 1.0)
    gray, red, green = (
        common.diffuse(name, color)
        for name, color in (("Gray", (0.7,) * 3), ("Red", (0.6, 0.1, 0.05)), ("Green", (0.1, 0.5, 0.2)))
    )
    boxes.room(3.2, 2.4, 2.0, {"floor": gray, "ceiling": gray, "back": gray, "left": red, "right": green})
    common.area_lamp("Stays", (0.9, -0.2, 1.98), (0.9, -0.2, 0), (0.5, 0.5), 12.0, (0.8, 0.9, 1.0))
    switch_off(common.area_lamp("Goes", (-0.8, -0.2, 1.98), (-0.8, -0.2, 0), (0.6, 0.6), 40.0, (1.0, 0.9, 0.75)))
    common.box("Block", (-0.6, 0.4, 0.45), (0.6, 0.6, 0.9), gray, turn=20.0)
    common.sphere("Ball", (0.5, -0.2, 0.4), 0.4, common.principled("Ball", (0.8, 0.6, 0.2), 0.3))
    common.camera((0, -3.6, 1.1), (0, 0, 0.85), lens=36)
    path = Path(sys.argv[1])
    path.parent.mkdir(parents=True, exist_ok=True)
    common.save(path)


main()
