"""What a run was made with."""

from __future__ import annotations

import subprocess
from pathlib import Path

from scenes import ROOT


def version_of_build() -> str:
    """The last commit that touched what is measured: committing results does not make them old."""
    command = ["git", "-C", str(ROOT), "log", "-1", "--format=%h", "--", "native", "addon"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or "unknown"


def cpu_name() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown processor")
