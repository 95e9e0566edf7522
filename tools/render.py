"""`make render`: renders frames of a .blend with Gradus in Blender, and prints the files and the times.

Reads SCENE, FRAMES (1, 1-24 or 1,5,9-12), OUT, ARGS (options of the add-on, as after "--"), COMPONENTS (default, or
Name=EXPRESSION;…, with all passes of each) and BLENDER from the environment. With --check it only checks these.

The exit code is 1 unless every image was written.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "addon"))

from gradus import components, native, options  # noqa: E402  (none needs Blender)


class RenderError(Exception):
    """The render cannot start or has failed; the text is for the user."""


def frame_ranges(text: str) -> list[tuple[int, int]]:
    ranges = []
    for part in text.replace("..", "-").split(","):
        match = re.fullmatch(r"\s*(\d+)(?:-(\d+))?\s*", part)
        if not match:  # Blender's -s and -e count negative numbers from the ends of the scene's range
            raise RenderError(f"FRAMES={text}: expected numbers from 0 on and ranges like 1-24 or 1,5,9-12")
        first = int(match.group(1))
        ranges.append((first, int(match.group(2) or first)))
        if ranges[-1][1] < first:
            raise RenderError(f"FRAMES={text}: {part} ends before it starts")
    return ranges


def frame_name(frame: int) -> str:
    """Returns the number of a frame as Blender writes it in file names."""
    return f"{frame:04d}"


def scripts_folder() -> Path:
    """Returns a scripts folder with this add-on alone, so that the user's settings are neither used nor changed."""
    folder = ROOT / "build" / "scripts"
    link = folder / "addons"
    if not link.exists():
        folder.mkdir(parents=True, exist_ok=True)
        link.unlink(missing_ok=True)
        link.symlink_to(Path("..") / ".." / "addon", target_is_directory=True)
    return folder


def blender_path() -> str:
    return os.environ.get("BLENDER") or "/usr/bin/blender"


def check_blender() -> None:
    """Raises RenderError if BLENDER names something that is no program. Debian's Blender is installed by set-up."""
    path = os.environ.get("BLENDER")
    if path and shutil.which(path) is None:
        raise RenderError(f"BLENDER={path}: no such program")


def opened(blender: str, scene: Path) -> list[str]:
    """Returns the command that opens a file in Blender and sets the engine to Gradus."""
    # The add-on precedes the file: otherwise Blender warns of an unknown engine when it reads a file that uses Gradus.
    head = [blender, "-b", "--factory-startup", "-noaudio", "--addons", "gradus", str(scene), "-E", "GRADUS"]
    return [*head, "--python-exit-code", "1"]


def command(blender: str, scene: Path, arguments: list[str]) -> list[str]:
    return [*opened(blender, scene), "--python", str(ROOT / "tools" / "render_output.py"), "--", *arguments]


def stats_of(path: Path) -> list[dict]:
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def timing(frames: int, wall: float, stats: list[dict]) -> str:
    def seconds(phase: str) -> float:
        return sum(entry.get("seconds", {}).get(phase, 0.0) for entry in stats)

    line = f"{frames} frame{'s' if frames > 1 else ''} in {wall:.1f} s"
    phases = [f"{phase} {seconds(phase):.2f}" for phase in ("export", "build", "sample", "reconstruct", "upload")]
    samples = {round(entry["samples"]) for entry in stats if "samples" in entry}
    counts = f"; {min(samples)}{f'-{max(samples)}' if len(samples) > 1 else ''} samples per pixel" if samples else ""
    return line + (f" ({', '.join(phases)} s{counts})" if stats else "")


def component_options(text: str) -> list[str]:
    """Returns the add-on's options for COMPONENTS. Options of ARGS come after them and replace them."""
    if not text:
        return []
    own = "" if text.lower() == "default" else text
    return ["--gradus-use-decomposition", "1", f"--gradus-components={own}", "--gradus-passes", "components"]


def check_options(arguments: list[str]) -> None:
    """Raises RenderError for options that the add-on would refuse, except for values of native settings.

    `make render` runs this check before the build.
    """
    try:
        overrides = options.parse(arguments)
    except options.OptionError as error:
        raise RenderError(str(error)) from error
    text = overrides.text("components") or ""
    problem = components.syntax_error(text) or library_error(text)
    if problem:
        raise RenderError(f"COMPONENTS: {problem}")


def library_error(text: str) -> str:
    """Returns what the library of an earlier build says against a set of components, such as two that overlap."""
    try:
        library = native.load()
    except native.GradusError:  # nothing is built, or something else
        return ""
    try:
        components.describe(library, text.encode())
    except native.GradusError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class Request:
    """The scene, frames, output and options that the environment variables ask for."""

    scene: Path
    ranges: list[tuple[int, int]]
    out: Path
    arguments: list[str]


def request() -> Request:
    scene = Path(os.environ.get("SCENE") or "sample_blends/hero.blend")
    if not scene.is_file():
        raise RenderError(f"SCENE={scene}: {'this is a folder' if scene.is_dir() else 'no such file'}")
    ranges = frame_ranges(os.environ.get("FRAMES") or "1")
    text = os.environ.get("ARGS") or ""
    try:
        arguments = component_options(os.environ.get("COMPONENTS") or "") + shlex.split(text)
    except ValueError as error:
        raise RenderError(f"ARGS={text}: {error}") from error
    check_options(arguments)
    out = Path(os.environ.get("OUT") or "out").absolute()
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RenderError(f"OUT={out}: {error.strerror}") from error
    return Request(scene, ranges, out, arguments)


def render(wanted: Request) -> None:
    blender = blender_path()
    prefix = wanted.out / f"{wanted.scene.stem}_"
    names = [f"{prefix}{frame_name(frame)}" for first, last in wanted.ranges for frame in range(first, last + 1)]
    files = [Path(name + suffix) for name in names for suffix in (".png", ".exr")]
    for file in files:
        file.unlink(missing_ok=True)  # an old picture must not be taken for a new one

    with tempfile.TemporaryDirectory(prefix="gradus-render-") as folder:
        stats = Path(folder) / "stats.jsonl"
        arguments = list(wanted.arguments)
        if not any(argument.partition("=")[0] == "--gradus-stats" for argument in arguments):
            arguments += ["--gradus-stats", str(stats)]
        environment = os.environ | {
            "BLENDER_USER_SCRIPTS": str(scripts_folder()),
            "GRADUS_RENDER_OUT": str(prefix),
            "GRADUS_RENDER_FRAMES": json.dumps(wanted.ranges),
        }
        start = time.monotonic()
        try:
            code = subprocess.run(
                command(blender, wanted.scene, arguments), env=environment, stdin=subprocess.DEVNULL, check=False
            ).returncode
        except OSError as error:
            raise RenderError(f"BLENDER={blender}: {error.strerror}") from error
        wall = time.monotonic() - start
        missing = [file for file in files if not file.exists() or file.stat().st_size == 0]
        if code != 0 or missing:
            absent = (
                f"; not written: {', '.join(map(str, missing[:6]))}{' …' if len(missing) > 6 else ''}"
                if missing
                else ""
            )
            raise RenderError(f"Blender ended with code {code}{absent}")
        print(f"render: {names[0]}.png and .exr" + (f" … {names[-1]}.png and .exr" if len(names) > 1 else ""))
        print(f"render: {timing(len(names), wall, stats_of(stats))}")


def main(work: Callable[[Request], None] = render, check: Callable[[Request], None] = lambda _: None) -> int:
    try:
        wanted = request()
        check(wanted)
        check_blender()
        if "--check" not in sys.argv:
            work(wanted)
    except RenderError as error:
        print(f"render: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
