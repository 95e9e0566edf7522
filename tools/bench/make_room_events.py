"""Makes a room with a static camera, in which at most one thing happens. usage: make_room_events.py FILE

The name of the file says what: light-off or light-on (one of two lights goes off or on at frame 13), passing-shadow
(the shadow of a bar behind the camera crosses the back wall by 10 pixels a frame at 640×360) or static-shot (nothing).
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parents[2] / "sample_blends"))
from builders import boxes, common  # noqa: E402

WIDTH, HEIGHT, FRAMES, CHANGE = 640, 360, 24, 13
DEPTH, DISTANCE, LENS, SENSOR = 2.4, 3.6, 36.0, 36.0  # of the room and of the camera from its middle, meters and mm
SPEED = 10.0  # pixels by which the shadow moves in a frame


def switch(light: bpy.types.Object, before: float, after: float) -> None:
    """Gives a light another power from the frame of the change on."""
    common.key(light.data, "energy", [(1, before), (CHANGE, after)])
    for curve in light.data.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "CONSTANT"


def pass_a_shadow() -> None:
    """Adds a sun behind the camera and a bar that moves before it. The shadow moves along the wall as the bar does."""
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 2.0, math.radians(0.2)
    common.link(sun, "Sun", rotation=(88.0, 0.0, 0.0))
    bar = common.box("Bar", (0.0, -4.5, 1.0), (0.35, 0.05, 4.0), common.diffuse("Bar", (0.5,) * 3))
    meters_of_a_pixel = (DISTANCE + 0.5 * DEPTH) * SENSOR / LENS / WIDTH
    half = 0.5 * SPEED * meters_of_a_pixel * (FRAMES - 1)
    common.key(bar, "location", [(1, (-half, -4.5, 1.0)), (FRAMES, (half, -4.5, 1.0))])


def main() -> None:
    path = Path(sys.argv[1])
    common.reset()
    common.settings(WIDTH, HEIGHT)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, FRAMES
    common.world((0.02, 0.02, 0.02), 1.0)
    gray, red, green = (
        common.diffuse(name, color)
        for name, color in (("Gray", (0.7,) * 3), ("Red", (0.6, 0.1, 0.05)), ("Green", (0.1, 0.5, 0.2)))
    )
    boxes.room(3.2, DEPTH, 2.0, {"floor": gray, "ceiling": gray, "back": gray, "left": red, "right": green})
    common.area_lamp("Stays", (0.9, -0.2, 1.98), (0.9, -0.2, 0), (0.5, 0.5), 12.0, (0.8, 0.9, 1.0))
    other = common.area_lamp("Other", (-0.8, -0.2, 1.98), (-0.8, -0.2, 0), (0.6, 0.6), 40.0, (1.0, 0.9, 0.75))
    common.box("Block", (-0.6, 0.4, 0.45), (0.6, 0.6, 0.9), gray, turn=20.0)
    common.sphere("Ball", (0.5, -0.2, 0.4), 0.4, common.principled("Ball", (0.8, 0.6, 0.2), 0.3))
    common.camera((0, -DISTANCE, 1.1), (0, 0, 0.85), lens=LENS)
    if path.stem == "light-off":
        switch(other, 40.0, 0.0)
    elif path.stem == "light-on":
        switch(other, 0.0, 40.0)
    elif path.stem == "passing-shadow":
        other.data.energy = 4.0
        pass_a_shadow()
    elif path.stem != "static-shot":
        raise SystemExit(f"make_room_events.py: unknown scene {path.stem}")
    path.parent.mkdir(parents=True, exist_ok=True)
    common.save(path)


main()
