"""I5: hosts of farms: no display, no home, other locales, odd paths, a strict umask."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from support.application import ROOT, Outcome

SETUP = """
import bpy
render = bpy.context.scene.render
render.resolution_x, render.resolution_y, render.resolution_percentage = 32, 18, 100
"""

ENVIRONMENTS = {
    "no display": {"DISPLAY": None, "WAYLAND_DISPLAY": None},
    "no home": {"HOME": None},
    "read-only home": {"HOME": "/proc"},
    "no temporary folder": {"TMPDIR": "/nonexistent", "TEMP": None, "TMP": None},
    "locale C": {"LC_ALL": "C", "LANG": "C"},
    "decimal comma": {"LC_ALL": "tr_TR.UTF-8", "LANG": "tr_TR.UTF-8"},
}


ALONE, AHEAD = ("-f", "1"), ("-s", "1", "-e", "2", "-a")
"""The frames of an animation are kept in temporary files."""


def frame(blender: Callable[..., Outcome], out: Path, asked: tuple[str, ...] = ALONE, **options: object) -> Outcome:
    head = ["--addons", "gradus", "-E", "GRADUS", "--python-expr", SETUP, "-o", f"{out}/f_####", "-F", "PNG", *asked]
    return blender(*head, "--", "--gradus-samples", "2", "--gradus-filter-width", "1.25", **options)


@pytest.mark.parametrize("asked", [ALONE, AHEAD], ids=["alone", "ahead"])
@pytest.mark.parametrize("name", list(ENVIRONMENTS))
def test_i5_environments(blender: Callable[..., Outcome], tmp_path: Path, name: str, asked: tuple[str, ...]) -> None:
    outcome = frame(blender, tmp_path, asked, env=ENVIRONMENTS[name])
    assert outcome.code == 0, outcome.output
    assert all(path.stat().st_size > 100 for path in tmp_path.glob("f_*.png"))
    assert len(list(tmp_path.glob("f_*.png"))) == (1 if asked == ALONE else 2)


def test_i5_a_temporary_folder_that_takes_no_files(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    """Single frames need no home; an animation names what is missing."""
    assert frame(blender, tmp_path, env={"TMPDIR": "/proc"}).code == 0
    outcome = frame(blender, tmp_path / "ahead", AHEAD, env={"TMPDIR": "/proc"})
    assert outcome.code == 1, outcome.output
    assert "Gradus: cannot make a temporary folder in /proc" in outcome.output


def test_i5_paths_outside_ascii(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    folder = tmp_path / "Größe 夜"
    folder.mkdir()
    addon = folder / "gradus"
    shutil.copytree(ROOT / "addon" / "gradus", addon, symlinks=True)
    outcome = frame(blender, folder, addon=addon)
    assert outcome.code == 0, outcome.output
    assert (folder / "f_0001.png").exists()


def test_i5_strict_umask(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    before = os.umask(0o077)
    try:
        outcome = frame(blender, tmp_path)
    finally:
        os.umask(before)
    assert outcome.code == 0, outcome.output
    assert (tmp_path / "f_0001.png").exists()
