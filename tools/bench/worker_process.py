"""Functions of all worker processes: their answers on standard output, and their peak memory."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any


class Answers:
    """Writes lines of JSON to standard output for the process that started the worker.

    Other output, such as the progress bars of libraries, goes to standard error.
    """

    def __init__(self) -> None:
        self._file = os.fdopen(os.dup(1), "w")
        os.dup2(2, 1)

    def send(self, answer: dict[str, Any]) -> None:
        print("RESULT " + json.dumps(answer), file=self._file, flush=True)


def reset_peak() -> None:
    """Starts a new measurement of the peak of resident memory (Linux, proc(5): clear_refs)."""
    Path("/proc/self/clear_refs").write_text("5")


def peak_bytes() -> int:
    """Returns the peak of resident memory since the last reset."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) * 1024
