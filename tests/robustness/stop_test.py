"""K1, I3: SIGINT and SIGKILL at any moment end the process at once, and leave no incomplete file."""

from __future__ import annotations

import os
import signal
import statistics
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from support import application

pytestmark = pytest.mark.application

SETUP = """
import bpy
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = {size}, 100
scene.gradus.samples, scene.gradus.noise_threshold = {samples}, 0.0
scene.render.use_overwrite = False
cube = scene.objects['Cube']
cube.keyframe_insert('location', frame=1)
cube.location.x = 1.0
cube.keyframe_insert('location', frame=20)
bpy.data.objects['Cube'].modifiers.new('Fine', 'SUBSURF').render_levels = {level}
print('SETUP DONE', flush=True)
"""

FULL = os.environ.get("GRADUS_TEST_FULL") == "1"


def start(folder: Path, size: str, samples: int, level: int, frames: int, *arguments: str | Path) -> tuple:
    script = SETUP.format(size=size, samples=samples, level=level)
    (folder / "home").mkdir(exist_ok=True)
    output = ["-o", f"{folder}/f_####", "-F", "PNG", "-s", "1", "-e", str(frames), "-a"]
    home = folder / "home" / str(time.monotonic_ns())
    process = application.start(
        "--addons", "gradus", "-E", "GRADUS", "--python-expr", script, *output, "--", *arguments, folder=home
    )
    lines = []
    for line in process.stdout:
        lines.append(line)
        if b"SETUP DONE" in line:
            break
    return process, lines


def end(process: object, sent: int) -> tuple[int, float, bytes]:
    begin = time.monotonic()
    process.send_signal(sent)
    try:
        output, _ = process.communicate(timeout=30)
    except Exception:
        process.kill()
        raise
    return process.returncode, time.monotonic() - begin, output


def check_whole(folder: Path) -> int:
    paths = sorted(folder.glob("f_*"))
    for path in paths:
        file = oiio.ImageInput.open(str(path))
        assert file is not None, path
        pixels = np.asarray(file.read_image("float"))
        assert pixels.size, path
        assert pixels.max() > 0.0, path
    return len(paths)


@pytest.mark.alone
def test_k1_sigint_ends_the_render_within_a_second(tmp_path: Path) -> None:
    """Stops at times spread over export, build, sampling and reconstruction of a frame that would take minutes."""
    seconds = []
    for index in range(20 if FULL else 4):
        process, _ = start(tmp_path, "1280, 720", 100000, 7 if index % 2 else 2, 1)
        time.sleep(0.02 + index * (0.15 if FULL else 0.4))
        code, elapsed, output = end(process, signal.SIGINT)
        assert code == 1, output
        assert elapsed <= 1.0, (index, elapsed, output)
        seconds.append(elapsed)
    assert list(tmp_path.glob("f_*")) == []
    assert statistics.median(seconds) <= 0.3 or not FULL  # the catalogue's figure; a busy machine would break it


def kill_again_and_again(folder: Path, *arguments: str | Path) -> None:
    """Then a last run completes: six small frames with two samples each."""
    for index in range(20 if FULL else 4):
        process, _ = start(folder, "48, 27", 2, 2, 6, *arguments)
        time.sleep(0.05 + (0.1 if FULL else 0.3) * index)
        end(process, signal.SIGKILL)
        # Blender writes its files itself and not atomically: what was being written when it was killed may be short.
        for path in folder.glob("f_*"):
            if not is_whole_png(path):
                path.unlink()
        check_whole(folder)
    complete(folder, *arguments)


def complete(folder: Path, *arguments: str | Path) -> None:
    process, _ = start(folder, "48, 27", 2, 2, 6, *arguments)
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 0, output
    assert check_whole(folder) == 6


def test_i3_killed_at_any_moment_a_rerun_completes(tmp_path: Path) -> None:
    kill_again_and_again(tmp_path)


def test_i3_with_a_frame_store_the_rerun_has_the_bits_of_an_undisturbed_render(tmp_path: Path) -> None:
    disturbed, undisturbed = tmp_path / "disturbed", tmp_path / "undisturbed"
    disturbed.mkdir()
    undisturbed.mkdir()
    kill_again_and_again(disturbed, "--gradus-frame-store", disturbed / "store")
    complete(undisturbed, "--gradus-frame-store", undisturbed / "store")
    for path in sorted(undisturbed.glob("f_*")):
        found, expected = (
            np.asarray(oiio.ImageInput.open(str(file)).read_image()) for file in (disturbed / path.name, path)
        )
        assert np.array_equal(found, expected), path.name
    assert not list(disturbed.glob("store/**/*.part")), "what killed processes have left is removed by the next"


def is_whole_png(path: Path) -> bool:
    return path.read_bytes()[-8:-4] == b"IEND"
