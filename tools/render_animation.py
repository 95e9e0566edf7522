"""`make render-animation`: renders a range of frames by `blender -b -a`, and joins small copies to a film strip.

Reads SCENE, FRAMES (1-24), OUT, ARGS (options of the add-on, as after "--") and BLENDER from the environment, as
render.py does.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from render import ROOT, RenderError, Request, blender_path, frame_name, main, opened, scripts_folder


def command(wanted: Request, prefix: str) -> list[str]:
    """Returns Blender's command. Blender runs its options in order, so that the strip follows the frames of -a."""
    first, last = wanted.ranges[0]
    frames = ["-o", f"{prefix}####", "-F", "PNG", "-x", "1", "-s", str(first), "-e", str(last), "-j", "1", "-a"]
    strip = ["--python", str(ROOT / "tools" / "film_strip.py")]
    return [*opened(blender_path(), wanted.scene), *frames, *strip, "--", *wanted.arguments]


def check(wanted: Request) -> None:
    if len(wanted.ranges) != 1:
        raise RenderError("FRAMES: expected one range, as Blender's -a takes it")


def render(wanted: Request) -> None:
    first, last = wanted.ranges[0]
    prefix = f"{wanted.out}/{wanted.scene.stem}_"
    frames = [Path(f"{prefix}{frame_name(frame)}.png") for frame in range(first, last + 1)]
    strip = Path(f"{prefix}strip.png")
    for file in (*frames, strip):
        file.unlink(missing_ok=True)  # an old picture must not be taken for a new one
    environment = os.environ | {
        "BLENDER_USER_SCRIPTS": str(scripts_folder()),
        "GRADUS_STRIP": str(strip),
        "GRADUS_STRIP_FRAMES": json.dumps([str(file) for file in frames]),
    }
    start = time.monotonic()
    try:
        code = subprocess.run(
            command(wanted, prefix), env=environment, stdin=subprocess.DEVNULL, check=False
        ).returncode
    except OSError as error:
        raise RenderError(f"BLENDER={blender_path()}: {error.strerror}") from error
    missing = [file.name for file in (*frames, strip) if not file.exists()]
    if code != 0 or missing:
        raise RenderError(
            f"Blender ended with code {code}" + (f"; not written: {', '.join(missing)}" if missing else "")
        )
    print(f"render: {frames[0]} … {frames[-1].name} in {time.monotonic() - start:.1f} s; film strip: {strip}")


if __name__ == "__main__":
    sys.exit(main(render, check))
