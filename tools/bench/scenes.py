"""The scenes of the still benchmark. Real scenes lie beside the repository; missing ones are skipped with a message."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from paths import CACHE, HERE, ROOT

SAMPLES = ROOT / "sample_blends"
MADE = CACHE / "scenes"
REAL = ROOT.parent / "shared" / "scenes"


@dataclass(frozen=True)
class Scene:
    name: str
    path: Path
    diffuse_interior: bool = False  # counts for the target of L2 on diffuse interiors
    own: bool = False  # the project's own scene, of which pictures may be published
    maker: str = ""  # script that makes the file if it is missing


SCENES = [
    Scene("hero", SAMPLES / "hero.blend", own=True),
    Scene("cornell", SAMPLES / "cornell.blend", diffuse_interior=True, own=True),
    Scene("glass_and_chrome", SAMPLES / "glass_and_chrome.blend", own=True),
    Scene("many_lights", SAMPLES / "many_lights.blend", own=True),
    Scene("animated", SAMPLES / "animated.blend", own=True),
    Scene("textures_world", SAMPLES / "textures_world.blend", own=True),
    Scene("faceted", MADE / "faceted.blend", own=True, maker="make_faceted.py"),
    Scene("door-ajar", REAL / "door-ajar.blend", diffuse_interior=True),
    Scene("breakfast-room", REAL / "breakfast-room.blend", diffuse_interior=True),
    Scene("kitchen", REAL / "kitchen.blend"),
    Scene("bathroom", REAL / "bathroom.blend"),
    Scene("arena", REAL / "arena.blend"),
    Scene("material-testball", REAL / "material-testball.blend"),
    Scene("glass-teapot", REAL / "glass-teapot.blend"),
    Scene("moving-light", REAL / "moving-light.blend", diffuse_interior=True),
    Scene("specular-motion", REAL / "specular-motion.blend"),
    Scene("morph-sphere", REAL / "morph-sphere.blend"),
    Scene("mannequin-mirror", REAL / "mannequin-mirror.blend"),
    Scene("robot-room", REAL / "robot-room.blend"),
    Scene("dutch-ship", REAL / "dutch-ship.blend"),
    Scene("many-objects", REAL / "many-objects.blend"),
    Scene("instances", REAL / "instances.blend"),
    Scene("toy-car", REAL / "toy-car.blend"),
]
QUICK = ("cornell", "door-ajar")


def select(names: str) -> list[Scene]:
    """Returns the scenes of the still benchmark by name ('a,b'), or all for ''."""
    return chosen(SCENES, names)


def chosen(scenes: list[Scene], names: str) -> list[Scene]:
    """Returns those of the scenes that are named ('a,b'), or all for '', without those whose file is missing."""
    wanted = [n for n in names.split(",") if n]
    unknown = set(wanted) - {s.name for s in scenes}
    if unknown:
        raise SystemExit(f"unknown scenes: {', '.join(sorted(unknown))}")
    found = [s for s in scenes if not wanted or s.name in wanted]
    for scene in found:
        if scene.maker and not scene.path.exists():
            subprocess.run([sys.executable, str(HERE / scene.maker), str(scene.path)], check=True)
        if not scene.path.exists():
            print(f"SKIP {scene.name}: {scene.path} does not exist")
    return [s for s in found if s.path.exists()]
