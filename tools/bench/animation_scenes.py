"""The animations of the benchmark.

All have 24 frames. Fewer frames are taken around the middle, where events happen.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from scenes import MADE, REAL, SAMPLES, Scene, chosen

MAKER = "make_room_events.py"
STATIC = "static-shot"


@dataclass(frozen=True)
class Animation:
    scene: Scene
    frames: tuple[int, int]
    moves: str
    changes: int | None = None  # first frame after a light has gone off or on
    has_shadow: bool = False  # a shadow passes, and its wake is measured
    until: int = 24  # last frame of the motion

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def length(self) -> int:
        return self.frames[1] - self.frames[0] + 1

    def lasting(self, length: int) -> Animation:
        """Returns so many frames around the middle of the usual ones, within the motion."""
        middle = (self.frames[0] + self.frames[1] + 1) // 2
        first = max(1, min(middle - length // 2, self.until - length + 1))
        last = first + length - 1
        shown = self.changes is not None and first < self.changes <= last
        return replace(self, frames=(first, last), changes=self.changes if shown else None)

    def middle(self, length: int) -> tuple[int, int]:
        """Returns the first and the last of so many frames in the middle; a light changes at the middle one."""
        return self.lasting(min(length, self.length)).frames


def _animation(scene: Scene, moves: str, changes: int | None = None, has_shadow: bool = False) -> Animation:
    return Animation(scene, (1, 24), moves, changes, has_shadow)


def _room(name: str, moves: str, changes: int | None = None, has_shadow: bool = False) -> Animation:
    return _animation(Scene(name, MADE / f"{name}.blend", own=True, maker=MAKER), moves, changes, has_shadow)


def _real(name: str, moves: str) -> Animation:
    return _animation(Scene(name, REAL / f"{name}.blend"), moves)


ANIMATIONS = [
    _animation(
        Scene("animated", SAMPLES / "animated.blend", own=True),
        "the camera sideways; a rolling ball that comes into sight in a turning mirror, and a flag that waves",
    ),
    _real(
        "robot-room",
        "a dancing robot, whose arm swings by up to 31 pixels a frame, and its reflections in mirror and floor",
    ),
    _room("light-off", "nothing; one of two lights goes off at frame 13", changes=13),
    _room("light-on", "nothing; one of two lights goes on at frame 13", changes=13),
    _room("passing-shadow", "the shadow of a bar, by 10 pixels a frame along the back wall", has_shadow=True),
    _room(STATIC, "nothing"),
    _real("moving-light", "a panel of light, fast at first, which turns back at frame 13; the camera is static"),
    _real(
        "specular-motion",
        "a teapot of chrome and a ball of copper turn, a ball of glass rolls, a mirror swings; the camera is static",
    ),
    _real("instances", "instances in two levels, which turn: a third of the picture"),
    _real("kitchen", "the camera, through a still life of many materials"),
    _real("breakfast-room", "the camera, through a still life in thin stripes of sunlight"),
    _real("bathroom", "the camera sideways, before a mirror and tiles"),
    _real("arena", "the camera, through a level with 48 lights"),
    _real("door-ajar", "a door, through which all light comes"),
    _real("mannequin-mirror", "a runner beside a mirror, on a glossy floor"),
    _real("morph-sphere", "a sphere of chrome, which changes its shape"),
    _real("material-testball", "the camera, around six materials"),
    _real("glass-teapot", "the camera, around a teapot of glass with tea in it"),
    _real("dutch-ship", "the camera, around a ship with thin ropes"),
    _real("many-objects", "what moves among 420 objects of one mesh"),
    _real("toy-car", "a car, which drives a bend"),
]
QUICK = ("animated", "passing-shadow")  # the project's own: anyone can repeat them


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
