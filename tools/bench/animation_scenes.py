"""The animations of the benchmark: the ten frames of each in which most moves.

Other numbers of frames are taken around these.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from scenes import MADE, REAL, SAMPLES, Scene, chosen


@dataclass(frozen=True)
class Animation:
    scene: Scene
    frames: tuple[int, int]
    moves: str
    goes_off: int | None = None  # first frame without a light that was on before
    until: int = 24  # last frame of the motion

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def length(self) -> int:
        return self.frames[1] - self.frames[0] + 1

    def lasting(self, length: int) -> Animation:
        """Returns so many frames, from the same first frame on or from an earlier one if the motion would end too
        early.
        """
        first = min(self.frames[0], self.until - length + 1)
        last = first + length - 1
        return replace(
            self, frames=(first, last), goes_off=self.goes_off if self.goes_off and self.goes_off <= last else None
        )


ANIMATIONS = [
    Animation(
        Scene("animated", SAMPLES / "animated.blend", own=True),
        (10, 19),
        "the camera sideways; a rolling ball that comes into sight in a turning mirror, and a flag that waves",
    ),
    Animation(
        Scene("light-off", MADE / "light-off.blend", own=True, maker="make_light_off.py"),
        (1, 10),
        "nothing; one of two lights goes off at frame 6",
        goes_off=6,
        until=100,
    ),
    Animation(
        Scene("moving-light", REAL / "moving-light.blend"),
        (5, 14),
        "a panel of light, fast at first, which turns back at frame 13; blocks and camera are static",
    ),
    Animation(
        Scene("specular-motion", REAL / "specular-motion.blend"),
        (8, 17),
        "a teapot of chrome and a ball of copper turn, a ball of glass rolls, a mirror swings; the camera is static",
    ),
    Animation(
        Scene("robot-room", REAL / "robot-room.blend"),
        (5, 14),
        "a dancing robot, whose arm swings by up to 31 pixels a frame, and its reflections in mirror and floor",
    ),
    Animation(
        Scene("instances", REAL / "instances.blend"),
        (8, 17),
        "instances in two levels, which turn: a third of the picture",
    ),
]


def select(animations: list[Animation], names: str, length: int) -> list[Animation]:
    """Returns the animations that are named ('a,b'), or all for '', of so many frames.

    Missing or short ones are skipped with a message.
    """
    scenes = chosen([animation.scene for animation in animations], names)
    found = [animation for animation in animations if animation.scene in scenes]
    for animation in found:
        if animation.until < length:
            print(f"SKIP {animation.name}: it has {animation.until} frames")
    return [animation.lasting(length) for animation in found if animation.until >= length]
