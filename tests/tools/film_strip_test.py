"""`make render-animation` joins its frames to a film strip."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import bpy
import numpy as np
import pytest

SCRIPT = str(Path(__file__).resolve().parents[2] / "tools" / "film_strip.py")
WIDTH, HEIGHT, GAP = 160, 90, 2


def picture(path: Path, color: tuple[float, float, float]) -> str:
    image = bpy.data.images.new("Picture", 320, 180)
    image.pixels.foreach_set(np.tile((*color, 1.0), 320 * 180).astype(np.float32))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    return str(path)


def test_frames_lie_side_by_side_in_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    colors = [(0.1 * i, 1.0 - 0.1 * i, 0.2) for i in range(7)]
    files = [picture(tmp_path / f"{i}.png", color) for i, color in enumerate(colors)]
    monkeypatch.setenv("GRADUS_STRIP_FRAMES", json.dumps([*files, str(tmp_path / "missing.png")]))
    monkeypatch.setenv("GRADUS_STRIP", str(tmp_path / "strip.png"))
    runpy.run_path(SCRIPT)
    strip = bpy.data.images.load(str(tmp_path / "strip.png"))
    width, height = strip.size
    assert (width, height) == (6 * (WIDTH + GAP) - GAP, 2 * (HEIGHT + GAP) - GAP)
    pixels = np.array(strip.pixels[:]).reshape(height, width, 4)[::-1]
    for i, color in enumerate(colors):
        row, column = divmod(i, 6)
        found = pixels[row * (HEIGHT + GAP) + HEIGHT // 2, column * (WIDTH + GAP) + WIDTH // 2, :3]
        assert found == pytest.approx(color, abs=0.01)
    assert not pixels[HEIGHT + GAP :, WIDTH + GAP :, :3].any(), "the rest of the last row is black"
    assert not pixels[:HEIGHT, WIDTH, :3].any(), "frames are apart"


def test_no_frames_are_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GRADUS_STRIP_FRAMES", json.dumps([str(tmp_path / "missing.png")]))
    monkeypatch.setenv("GRADUS_STRIP", str(tmp_path / "strip.png"))
    with pytest.raises(SystemExit):
        runpy.run_path(SCRIPT)
