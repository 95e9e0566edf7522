"""Makes the sample scenes beside this file. Run: blender -b --factory-startup --python sample_blends/make_samples.py [-- NAME ...]

All geometry, textures and materials are made here; nothing is taken from elsewhere.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "addon")]

from builders import animated, boxes, common, components, hero, lights, textures  # noqa: E402

SCENES = {
    "hero": hero.build,
    "cornell": boxes.cornell,
    "glass_and_chrome": boxes.glass_and_chrome,
    "many_lights": lights.build,
    "textures_world": textures.build,
    "compositor": animated.compositor,
    "animated": animated.animated,
    "mirror_and_glass": components.mirror_and_glass,
    "components": components.compositor,
}


def main() -> None:
    """Builds the scenes named on the command line, or all."""
    names = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else list(SCENES)
    common.register_engine()
    for name in names:
        common.reset()
        SCENES[name]()
        common.save(HERE / f"{name}.blend")


main()
