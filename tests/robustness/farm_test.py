"""I4, I6: jobs divided as by farms, and the output that farms read."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from support import application
from support.application import Outcome

SETUP = """
import bpy
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 18, 100
scene.gradus.samples, scene.gradus.use_temporal = 2, TEMPORAL
cube = scene.objects["Cube"]
cube.keyframe_insert("location", frame=1)
cube.location.x = 1.0
cube.keyframe_insert("location", frame=6)
"""
MISSING = """
tree = cube.active_material.node_tree
image = tree.nodes.new("ShaderNodeTexImage")
image.image = bpy.data.images.new("Lost", 1, 1)
image.image.source, image.image.filepath = "FILE", "/nonexistent/lost.png"
tree.links.new(image.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
"""


def arguments(folder: Path, temporal: bool, *asked: str, kind: str = "OPEN_EXR", more: str = "") -> list[str]:
    script = SETUP.replace("TEMPORAL", str(temporal)) + more
    return ["--addons", "gradus", "-E", "GRADUS", "--python-expr", script, "-o", f"{folder}/f_####", "-F", kind, *asked]


def pictures(folder: Path) -> dict[str, np.ndarray]:
    files = sorted(folder.glob("f_*.exr"))
    return {file.name: np.asarray(oiio.ImageInput.open(str(file)).read_image("float")) for file in files}


def require_equal(found: Path, expected: Path, frames: int) -> None:
    a, b = pictures(found), pictures(expected)
    assert list(a) == list(b) == [f"f_{frame:04d}.exr" for frame in range(1, frames + 1)]
    for name in a:
        assert np.array_equal(a[name], b[name]), name


def finish(process: subprocess.Popen) -> str:
    """Waits for the end of a worker and returns its output."""
    try:
        output, _ = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 0, output
    return str(output)


def at_once(tmp_path: Path, *jobs: list[str]) -> list[str]:
    """Runs several workers at the same time and returns their outputs."""
    processes = [application.start(*job, folder=tmp_path / f"home {index}") for index, job in enumerate(jobs)]
    return [finish(process) for process in processes]


def films(store: Path) -> dict[str, tuple[int, int]]:
    """Returns which file each film of a frame store is, and when it was written."""
    return {file.name: (file.stat().st_ino, file.stat().st_mtime_ns) for file in sorted(store.rglob("f*.exr"))}


def test_i4_frames_are_equal_however_a_job_is_split(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    whole, alone, workers = (tmp_path / name for name in ("whole", "alone", "workers"))
    assert blender(*arguments(whole, False, "-s", "1", "-e", "4", "-a")).code == 0
    for frame in range(1, 5):
        assert blender(*arguments(alone, False, "-f", str(frame))).code == 0
    at_once(tmp_path, *(arguments(workers, False, "-s", first, "-e", "4", "-j", "2", "-a") for first in "12"))
    require_equal(alone, whole, 4)
    require_equal(workers, whole, 4)


def test_i4_workers_that_share_a_frame_store_make_the_bits_of_one(
    blender: Callable[..., Outcome], tmp_path: Path
) -> None:
    """The last worker has the pictures of a single worker. Others use the neighbouring frames that exist so far."""
    whole, parts, again = (tmp_path / name for name in ("whole", "parts", "again"))

    def store(name: str) -> list[str]:
        return ["--", "--gradus-frame-store", str(tmp_path / name)]

    assert blender(*arguments(whole, True, "-s", "1", "-e", "6", "-a"), *store("one")).code == 0
    outputs = at_once(
        tmp_path,
        *([*arguments(parts, True, "-s", first, "-e", last, "-a"), *store("shared")] for first, last in ("13", "46")),
    )
    assert len(pictures(parts)) == 6
    assert all(np.isfinite(picture).all() for picture in pictures(parts).values())
    # A film that is being written has another name until it is whole, so neither worker meets a torn one.
    for output in outputs:
        assert "cannot read" not in output and "sampled again" not in output, output
    assert not list((tmp_path / "shared").rglob("*.part"))
    sampled = films(tmp_path / "shared")
    assert set(sampled) == set(films(tmp_path / "one"))
    assert blender(*arguments(again, True, "-s", "1", "-e", "6", "-a"), *store("shared")).code == 0
    require_equal(again, whole, 6)
    # The last worker samples nothing: the frame at the seam replays its predecessor in whichever job it was sampled.
    assert films(tmp_path / "shared") == sampled


@pytest.mark.parametrize("temporal", [False, True], ids=["frame by frame", "ahead"])
def test_i6_the_lines_that_farms_parse(blender: Callable[..., Outcome], tmp_path: Path, temporal: bool) -> None:
    frames = list(range(1, 7))
    outcome = blender(*arguments(tmp_path, temporal, "-s", "1", "-e", "6", "-a", kind="PNG", more=MISSING))
    assert outcome.code == 0, outcome.output
    lines = outcome.output.splitlines()
    saved = [place for place, line in enumerate(lines) if re.fullmatch(r"Saved: '.*/f_\d{4}\.png'", line)]
    assert [lines[place][-9:-5] for place in saved] == [f"{frame:04d}" for frame in frames]
    told = [int(found[1]) for line in lines if (found := re.match(r"Fra:(\d+) Mem:", line))]
    assert set(told) == set(frames)
    ours = [line for line in lines if "Gradus" in line]
    assert all(re.match(r"Fra:\d+ Mem:.* \| Gradus: |Warning: Gradus: ", line) for line in ours), ours
    missing = [place for place, line in enumerate(lines) if "/nonexistent/lost.png" in line]
    assert len(missing) == 1 and missing[0] < saved[0], "one warning before the first frame"
    assert len(ours) - 1 <= 2 * len(frames) + outcome.seconds, ours
