"""Reads the seeded faults of faults.toml, and finds their switches in the sources of the library."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import tomllib

ROOT = Path(__file__).resolve().parents[2]
TABLE = Path(__file__).with_name("faults.toml")
LIST = ROOT / "native" / "src" / "base" / "fault.h"

LISTED = re.compile(r"^  X\((\w+)\)", re.M)
SWITCH = re.compile(r"\bGRADUS_FAULT\((\w+)\)")


@dataclass(frozen=True)
class Test:
    """Selects tests of one test program, or of one Python test file that runs in Blender 3.4."""

    program: str  # native, statistics, stress, memory or regression (GoogleTest), or the path of a pytest file
    choice: str  # --gtest_filter of GoogleTest, or -k expression of pytest

    @property
    def name(self) -> str:
        return f"{self.program}: {self.choice}"

    @property
    def is_native(self) -> bool:
        return not self.program.endswith(".py")


@dataclass(frozen=True)
class Edit:
    """Replaces `old` by `new` in a file of the add-on."""

    file: str
    old: str
    new: str


@dataclass(frozen=True)
class Fault:
    """A mistake that a switch in the library makes, or an edit of the add-on."""

    name: str
    kind: str
    meaning: str
    tests: tuple[Test, ...]  # each of these selections must fail
    edit: Edit | None


def read_faults() -> list[Fault]:
    return [_read(name, **fields) for name, fields in tomllib.loads(TABLE.read_text()).items()]


def _read(name: str, kind: str, meaning: str, tests: list[str], **edit: str) -> Fault:
    selections = tuple(Test(*test.split(": ", 1)) for test in tests)
    return Fault(name, kind, meaning, selections, Edit(**edit) if edit else None)


def listed_names() -> list[str]:
    """Returns the names of base/fault.h."""
    return LISTED.findall(LIST.read_text())


def switches() -> list[tuple[str, str]]:
    """Returns name and file of each switch in the sources of the library."""
    sources = ROOT / "native" / "src"
    files = (path for path in sorted(sources.rglob("*")) if path.suffix in {".h", ".cpp"} and path != LIST)
    return [(name, str(path.relative_to(ROOT))) for path in files for name in SWITCH.findall(path.read_text())]
