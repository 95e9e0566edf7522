"""Shows where the time of plain paths goes: a flame graph for each scene, and the share of ray tracing in it.

    profiles.py [--scenes a,b] [--width 640] [--samples 8] [--minutes 600]

The tool of the build renders the scene on one thread while `perf` takes its stack 200 times a second. Pictures go to
out/bench/profiles; every scene appends one row to out/bench/results/profiles.jsonl. Other work on the machine does not
disturb shares much.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import flame_graph
import records
from paths import OUT, TOOL
from records import Row
from renderers import blender_worker
from runs import bench_each, parser_of
from scenes import Scene, select
from version import conditions

RESULTS = records.file_of("profiles")
PICTURES = "profiles"  # folder, relative to OUT
SAMPLING = "TileSampler::sample_tile"
RAYS = ("embree::", "rtc")  # what functions of Embree begin with
# Bytes of the stack that each sample copies. Traversal of instances needs more than 16 KB: a stack that is cut off
# lacks SAMPLING and does not count, so that ray tracing would seem to take less.
STACK_BYTES = 32768
# Part of the names of the functions of Embree that traverse; those that build have others.
TRAVERSAL = "Intersector"
# Largest share of the stacks of traversal that may lack SAMPLING. About a tenth cannot be unwound, however large the
# copies are.
MOST_CUT = 0.2
SETUP = ("width", "version", "machine")  # columns in which rows must agree


def save_scene(scene: Scene, size: tuple[int, int], target: Path) -> None:
    """Lets the add-on save what it exports, with the settings of plain paths."""
    worker = blender_worker("worker.py", scene.path, *size)
    try:
        image = str(target.with_suffix(".npy"))
        worker.ask({"mode": "path", "samples": 1, "seed": 1, "out": image, "scene": str(target)})
    finally:
        worker.close()


def profile(scene: Path, samples: int) -> flame_graph.Stacks:
    """Renders a saved scene and returns the stacks of its sampling."""
    data = scene.with_suffix(".perf")
    render = [TOOL, "render", scene, "-o", scene.with_suffix(".exr"), "--samples", samples, "--threads", 1]
    record = ["perf", "record", "-q", "-o", data, "--call-graph", f"dwarf,{STACK_BYTES}", "-F", 200, "--", *render]
    subprocess.run([str(part) for part in record], check=True, capture_output=True)
    script = ["perf", "script", "-i", str(data), "--no-inline", "-F", "ip,sym"]
    listed = subprocess.run(script, check=True, capture_output=True, text=True)
    lines = listed.stdout.splitlines()
    cut = flame_graph.cut_share(lines, SAMPLING, TRAVERSAL)
    if cut > MOST_CUT:
        raise RuntimeError(f"{100 * cut:.0f} % of the stacks of ray tracing are cut off")
    return flame_graph.parse(lines, SAMPLING)


def bench_scene(scene: Scene, arguments: argparse.Namespace, version: str, _: float) -> None:
    setup = {"scene": scene.name, "width": arguments.width} | conditions(version)
    if any(row.items() >= setup.items() for row in load()):
        return
    with tempfile.TemporaryDirectory() as folder:
        saved = Path(folder) / "scene.gradus"
        save_scene(scene, (arguments.width, arguments.width * 9 // 16), saved)
        stacks = profile(saved, arguments.samples)
    if not stacks:
        raise RuntimeError("the profile has no stacks of sampling")
    row = setup | {"stacks": stacks.total(), "rays": flame_graph.share_of_library(stacks, RAYS)}
    picture = OUT / PICTURES / f"{scene.name}.svg"
    picture.parent.mkdir(parents=True, exist_ok=True)
    picture.write_text(flame_graph.svg(stacks, f"{scene.name}, commit {version}"))
    records.append(row, RESULTS)
    print(f"{scene.name:18} rays {100 * row['rays']:.0f} % of {row['stacks']} stacks", flush=True)


def load() -> list[Row]:
    return records.read(RESULTS)


def newest() -> list[Row]:
    """Returns the last row of each scene, of those that were measured like the last one of all."""
    return records.newest(load(), SETUP)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--samples", type=int, default=8)
    arguments = parser.parse_args()
    if shutil.which("perf") is None:
        sys.exit("perf is missing")
    bench_each(select(arguments.scenes), bench_scene, arguments)


if __name__ == "__main__":
    main()
