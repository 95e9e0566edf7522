"""The animations in which reflections and refractions are followed: the six frames of each in which most moves."""

from __future__ import annotations

from animation_scenes import Animation
from scenes import MADE, REAL, SAMPLES, Scene

MAKER = "make_specular_motion.py"
ANIMATIONS = [
    Animation(
        Scene("mirror_and_glass", SAMPLES / "mirror_and_glass.blend", own=True),
        (10, 15),
        "a mirror ball rolls, a box slides by behind a slab of glass, the light swings; the camera is static",
    ),
    Animation(
        Scene("gliding-camera", MADE / "gliding-camera.blend", own=True, maker=MAKER),
        (10, 15),
        "the camera alone, past a flat mirror and a pane of glass",
    ),
    Animation(
        Scene("moving-box", MADE / "moving-box.blend", own=True, maker=MAKER),
        (10, 15),
        "a textured box alone, behind a pane of glass and in front of a mirror",
    ),
    Animation(
        Scene("turning-mirror", MADE / "turning-mirror.blend", own=True, maker=MAKER),
        (10, 15),
        "a flat mirror alone, which turns",
    ),
    Animation(
        Scene("animated", SAMPLES / "animated.blend", own=True),
        (10, 15),
        "the camera sideways, a rolling ball that comes into sight in a turning mirror, a flag that waves",
    ),
    Animation(
        Scene("specular-motion", REAL / "specular-motion.blend"),
        (8, 13),
        "a teapot of chrome and a ball of copper turn, a ball of glass rolls, a mirror swings; the camera is static",
    ),
    Animation(
        Scene("glass-teapot", REAL / "glass-teapot.blend"),
        (10, 15),
        "the camera, around a teapot of glass with tea in it",
    ),
    Animation(
        Scene("mannequin-mirror", REAL / "mannequin-mirror.blend"),
        (10, 15),
        "a runner beside a mirror, on a glossy floor",
    ),
    Animation(
        Scene("robot-room", REAL / "robot-room.blend"),
        (5, 10),
        "a dancing robot and its reflections in mirror and floor; the camera",
    ),
]
