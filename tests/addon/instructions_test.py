"""The instructions of a sample: times vary more from run to run than most changes of the code matter, counts do not.

After an intended change, store the counts with
  GRADUS_STORE_INSTRUCTIONS=1 tools/test.py --hosts bpy45 --files tests/addon/instructions_test.py addon
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
TOOL = ROOT / "build" / "native" / "gradus"
STORED = ROOT / "tests" / "regression" / "instructions.json"
WIDTH, HEIGHT = 64, 36
SAMPLES = (1, 5)  # the difference is free of what happens once, as the first use of a table
TOLERANCE = 0.03
SCENES = ("hero", "animated", "many_lights", "cornell")


def render(name: str) -> None:
    """Renders one of the project's scenes in a small size."""
    bpy.ops.wm.open_mainfile(filepath=str(ROOT / "sample_blends" / f"{name}.blend"))
    scene = bpy.context.scene
    scene.render.engine = "GRADUS"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.render.use_border = False
    scene.render.use_persistent_data = False
    bpy.ops.render.render()


def count(scene: Path, samples: int) -> int:
    """Returns the instructions of all tiles."""
    counts = scene.with_suffix(".callgrind")
    options = ("--toggle-collect=gradus::render::TileSampler::sample_tile(*", f"--callgrind-out-file={counts}")
    film = scene.with_suffix(".exr")
    render = (TOOL, "render", scene, "-o", film, "--samples", samples, "--threads", 1)
    command = ["valgrind", "-q", "--tool=callgrind", *options, *map(str, render)]
    subprocess.run(command, check=True, capture_output=True, timeout=240)
    film.unlink()
    return int(re.search(r"^(?:summary|totals): (\d+)", counts.read_text(), re.MULTILINE)[1])


@pytest.mark.module
@pytest.mark.parametrize("name", SCENES)
def test_a_sample_takes_as_many_instructions_as_stored(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, host_version: tuple[int, int, int]
) -> None:
    if host_version[:2] != (4, 5):
        pytest.skip("what other hosts export differs")
    scene = tmp_path / "s.gradus"
    options = ("--gradus-save-scene", str(scene), "--gradus-samples", "1", "--gradus-integrator", "path")
    monkeypatch.setattr(sys, "argv", ["blender", "--", *options])
    render(name)
    few, many = (count(scene, samples) for samples in SAMPLES)
    found = (many - few) / (WIDTH * HEIGHT * (SAMPLES[1] - SAMPLES[0]))
    stored = json.loads(STORED.read_text()) if STORED.exists() else {}
    if os.environ.get("GRADUS_STORE_INSTRUCTIONS"):
        STORED.write_text(json.dumps(stored | {name: round(found)}, indent=1, sort_keys=True) + "\n")
        return
    assert found == pytest.approx(stored[name], rel=TOLERANCE)
