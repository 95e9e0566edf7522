"""Types for a seeded fault and the tests that must catch it.

A fault is an edit of the sources that compiles and looks harmless. Its old text must occur exactly once in its file;
otherwise the tool stops, because a fault that no longer applies proves nothing.
"""

from __future__ import annotations

from dataclasses import dataclass


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
class Fault:
    """Replaces `old` by `new` in `file`."""

    number: int  # of the kind of fault
    name: str  # of the kind of fault
    meaning: str  # what the edited code does wrong
    file: str
    old: str
    new: str
    tests: tuple[Test, ...]  # each of these selections must fail


def native(choice: str) -> Test:
    return Test("native", choice)


def statistics(choice: str) -> Test:
    return Test("statistics", choice)
