"""Checks of sources and builds. Each is a command that must succeed, and counts as one test."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .programs import run
from .results import Result, tail

ROOT = Path(__file__).resolve().parent.parent.parent


@dataclass
class Check:
    """A command that must succeed."""

    name: str
    command: tuple[str, ...]
    needs: Path | None = None  # the check fails if this file or folder is missing
    limit: float = 600  # seconds

    def run(self, environment: dict[str, str]) -> Result:
        result = Result(f"check {self.name}")
        if self.needs and not self.needs.exists():
            result.failed = 1
            result.notes.append(f"check {self.name}: there is no {self.needs}")
            return result
        code, output = run(list(self.command), self.limit, environment)
        result.passed, result.failed = int(code == 0), int(code != 0)
        if code:
            result.notes.append(f"{' '.join(self.command)} ended with code {code}\n{tail(output, 60)}")
        return result


PYTHON = "/usr/bin/python3"
CHECKS = [
    Check("includes", (PYTHON, "tools/checks/includes.py"), ROOT / "native/src/film"),
    Check("schema", (PYTHON, "tools/schema/generate.py", "--check"), ROOT / "tools/schema/generate.py"),
]
