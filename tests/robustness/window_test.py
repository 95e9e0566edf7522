"""Blender's window under Xvfb: Rendered viewport, F12, Escape, material previews, two viewports beside a render."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from support.application import ROOT, environment

pytestmark = [pytest.mark.application, pytest.mark.alone]

LIMIT = 240


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    for program in ("Xvfb", "xdotool", "import"):
        if shutil.which(program) is None:
            pytest.skip(f"needs {program}, a package of tools/setup/debian-window.txt")
    reading, writing = os.pipe()
    command = [
        "Xvfb",
        "-displayfd",
        str(writing),
        "-screen",
        "0",
        "1024x700x24",
        "+extension",
        "GLX",
        "-nolisten",
        "tcp",
    ]
    server = subprocess.Popen(command, pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait()


@pytest.fixture(scope="module")
def session(display: str) -> Iterator[tuple[Path, dict]]:
    """Runs one session in the window; returns its folder of pictures and its answers."""
    with tempfile.TemporaryDirectory(prefix="gradus-window-") as name:
        folder = Path(name)
        arguments = ["--factory-startup", "-noaudio", "-p", "0", "0", "1024", "700"]
        script = [
            "--python",
            str(ROOT / "tests" / "support" / "window_script.py"),
            "--",
            str(ROOT / "addon"),
            str(folder),
        ]
        process = subprocess.Popen(
            [os.environ.get("BLENDER") or "blender", *arguments, *script],
            env=environment(folder / "home", DISPLAY=display),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            output, _ = process.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, _ = process.communicate()
            pytest.fail(f"the window did not finish in {LIMIT} s\n{output.decode()}")
        text = output.decode("utf-8", "replace")
        assert process.returncode in (0, 1), text  # 1: Blender remembers the Escape
        assert "Traceback" not in text, text
        assert "Error" not in text, text
        answers = json.loads((folder / "answers.json").read_text())
        assert answers.get("finished"), answers
        yield folder, answers


def picture(path: Path) -> np.ndarray:
    """Returns RGB from 0 to 1, top row first."""
    file = oiio.ImageInput.open(str(path))
    return np.asarray(file.read_image("float"))[:, :, :3]


def viewport(path: Path) -> np.ndarray:
    """Returns the middle of the 3D viewport in the factory layout."""
    return picture(path)[200:420, 150:620]


def test_viewport_shows_the_scene(session: tuple[Path, dict]) -> None:
    rendered = viewport(session[0] / "rendered.png")
    assert rendered.max() > 0.5, "black"
    assert np.ptp(rendered.mean(axis=2)) > 0.2, "flat"
    assert np.abs(rendered - viewport(session[0] / "solid.png")).mean() > 0.02, "solid shading was drawn"


def test_viewport_follows_an_edit(session: tuple[Path, dict]) -> None:
    before, after = (viewport(session[0] / f"{name}.png").mean(axis=2) for name in ("rendered", "moved"))
    bright_rows = [
        np.average(np.arange(image.shape[0]), weights=(image > 0.4).sum(axis=1) + 1e-9) for image in (before, after)
    ]
    assert bright_rows[1] < bright_rows[0] - 10, "the cube did not go up"


def test_local_view_hides_other_objects(session: tuple[Path, dict]) -> None:
    """Regression: Rendered shading showed all objects in Local View."""
    local = viewport(session[0] / "local.png")
    assert np.ptp(local.mean(axis=2)) < 0.1
    assert local.mean() > 0.1, "nothing was drawn"


def test_edit_mode_keeps_the_mesh(session: tuple[Path, dict]) -> None:
    """Regression: a mesh in Edit Mode was missing."""
    moved, edited = (viewport(session[0] / f"{name}.png") for name in ("moved", "edited"))
    assert np.abs(moved - edited).mean() < 0.02


def test_a_render_while_two_viewports_sample(session: tuple[Path, dict]) -> None:
    folder, answers = session
    assert answers["areas"] == 2
    assert answers["f12"] == ["complete"]
    assert answers["views"] == 2
    image = picture(folder / "f12.png")
    assert image.shape == (90, 160, 3)
    assert image[45, 80].max() > 0.1
    assert np.ptp(image) > 0.2
    two = picture(folder / "two.png")[200:420]
    assert two[:, 60:330].max() > 0.5
    assert two[:, 390:620].max() > 0.5


def test_k1_escape_ends_the_render_and_keeps_the_picture(session: tuple[Path, dict]) -> None:
    folder, answers = session
    assert answers["escape"] == ["cancel"]
    assert (
        answers["escape_seconds"] <= 2.0
    )  # with what the window itself takes; the library's share is tested elsewhere
    assert picture(folder / "escape.png")[45, 80].max() > 0.1


def test_material_preview(session: tuple[Path, dict]) -> None:
    assert session[1]["preview"] > 0.1


def test_viewports_are_freed(session: tuple[Path, dict]) -> None:
    assert session[1]["views_left"] == 0
