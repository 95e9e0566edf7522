"""`make render` tells mistakes in its variables before it sets up or builds anything."""

from __future__ import annotations

import os
import subprocess

import pytest
from support.application import ROOT

MISTAKES = {
    "SCENE": ("/nope.blend", "no such file"),
    "FRAMES": ("3-1", "ends before it starts"),
    "OUT": ("/proc/nope", "OUT=/proc/nope"),
    "ARGS": ("--gradus-samples '4", "No closing quotation"),
}


@pytest.mark.parametrize("name", list(MISTAKES))
def test_a_mistake_is_told_before_anything_is_built(name: str) -> None:
    value, message = MISTAKES[name]
    environment = {k: v for k, v in os.environ.items() if k not in MISTAKES} | {name: value, "BLENDER": "/nope"}
    result = subprocess.run(
        ["bash", str(ROOT / "tools" / "render.sh")], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert result.returncode == 1
    assert message in result.stderr
    assert result.stdout == ""
