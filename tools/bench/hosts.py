"""The Blenders that the benchmark runs, and the one choice of which of them renders Gradus and Cycles.

Gradus and its peers are always rendered in the same Blender, so that export, file output and the version of Open Image
Denoise are the same. The scripts of the benchmark themselves run in `.venv/bpy45`, which has the packages for measures
and figures.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from pathlib import Path

from paths import ROOT

NEWEST, FALLBACK = "5.2", "4.5"
MODULES = {"4.5": "bpy45", "5.0": "bpy50", "5.2": "bpy52"}  # Blender -> environment with its Python module


def is_installed(blender: str) -> bool:
    """Returns whether the environment of a Blender module is complete: set-up writes the stamp last."""
    return (ROOT / ".venv" / MODULES[blender] / ".stamp").exists()


@cache
def peer() -> str:
    """Returns the Blender whose Cycles and denoiser are the peers. Prints once if it is not the newest one."""
    if is_installed(NEWEST):
        return NEWEST
    print(
        f"Blender {NEWEST} is not installed (it needs Python 3.13): peers are those of {FALLBACK}",
        file=sys.stderr,
        flush=True,
    )
    return FALLBACK


def python_of(blender: str) -> Path:
    """Returns the Python interpreter that can import `bpy` of this Blender."""
    return ROOT / ".venv" / MODULES[blender] / "bin" / "python3"


def module_command(script: Path, blender: str = "") -> list[str]:
    """Returns the command that runs a script in a Blender module, in that of the peer by default."""
    return [str(python_of(blender or peer())), str(script)]


def application_command(script: Path) -> list[str]:
    """Returns the command that runs a script in the Blender application, which BLENDER may name."""
    program = os.environ.get("BLENDER") or "blender"
    return [program, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3", "--python", str(script)]
