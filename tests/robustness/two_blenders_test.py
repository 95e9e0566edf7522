"""H7: two Blender processes render at the same time, each with its own library."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from support import application

SCRIPT = "import bpy; bpy.context.scene.render.resolution_percentage = 5; bpy.context.scene.gradus.samples = 4"


@pytest.mark.application
def test_h7_two_blenders_at_once(tmp_path: Path) -> None:
    arguments = ["--addons", "gradus", "-E", "GRADUS", "--python-expr", SCRIPT, "-F", "PNG", "-s", "1", "-e", "3"]
    with tempfile.TemporaryDirectory(prefix="gradus-test-") as folder:
        names = ("one", "two")
        both = [
            application.start(*arguments, "-o", tmp_path / name / "f_####", "-a", folder=Path(folder) / name)
            for name in names
        ]
        outputs = [process.communicate(timeout=120)[0] for process in both]
    assert [process.returncode for process in both] == [0, 0], outputs
    files = [sorted((tmp_path / name).glob("*.png")) for name in names]
    assert [len(found) for found in files] == [3, 3]
    assert [path.read_bytes()[-1000:] for path in files[0]] == [path.read_bytes()[-1000:] for path in files[1]]
