"""Checks of the sources and builds that are no tests: each is a command that must succeed, and counts as one test."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .programs import run
from .results import Result, tail

ROOT = Path(__file__).resolve().parent.parent.parent


@dataclass
class Check:
    name: str
    command: tuple[str, ...]
    without: Path | None = None  # the check is skipped, visibly, where this is missing
    limit: float = 600  # seconds

    def run(self, environment: dict[str, str]) -> Result:
        result = Result(f"check {self.name}")
        if self.without and not self.without.exists():
            result.skipped = 1
            result.notes.append(f"check {self.name} is skipped: there is no {self.without.relative_to(ROOT)}")
            return result
        code, output = run(list(self.command), self.limit, environment)
        result.passed, result.failed = int(code == 0), int(code != 0)
        if code:
            result.notes.append(f"{' '.join(self.command)} ended with code {code}\n{tail(output, 60)}")
        return result


PYTHON = "/usr/bin/python3"
CHECKS = [
    # native/src/film is a folder of the layout that the check describes.
    Check("includes", (PYTHON, "tools/checks/includes.py"), ROOT / "native/src/film"),
    Check("schema", (PYTHON, "tools/schema/generate.py", "--check"), ROOT / "tools/schema/generate.py"),
    Check("one definition", ("ninja", "-C", "build-odr", "gradus"), ROOT / "build-odr/build.ninja"),
]
