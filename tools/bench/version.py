"""Identifies what a run was made with: commit, Blender and processor."""

from __future__ import annotations

import subprocess
from pathlib import Path

import hosts
from paths import ROOT


def version_of_build() -> str:
    """Returns the last commit that changed what is measured. Commits of tests or documents do not make results old."""
    command = ["git", "-C", str(ROOT), "log", "-1", "--format=%h", "--", "native", "addon"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or "unknown"


def cpu_name() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next(
        (line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown processor"
    )


def conditions(version: str) -> dict[str, str]:
    """Returns the columns of a stored row that say what it was measured with."""
    return {"version": version, "blender": hosts.peer(), "machine": cpu_name()}
