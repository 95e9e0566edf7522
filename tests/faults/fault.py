"""A seeded fault, and the tests that must catch it.

A fault is an edit of the sources that compiles and looks harmless. Its old text must be there exactly once, or the tool stops: a fault that
no longer applies proves nothing.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Test:
    """A few tests of one program, or of one file in Blender 3.4."""

    program: str  # native, statistics, stress, memory, regression: GoogleTest; else a file of pytest
    choice: str  # filter of GoogleTest, or expression of pytest's -k

    @property
    def name(self) -> str:
        return f"{self.program}: {self.choice}"

    @property
    def is_native(self) -> bool:
        return not self.program.endswith(".py")


@dataclass(frozen=True)
class Fault:
    number: int
    name: str  # as in the catalogue of tests
    meaning: str
    file: str
    old: str
    new: str
    tests: tuple[Test, ...]  # each of them must fail


def native(choice: str) -> Test:
    return Test("native", choice)


def statistics(choice: str) -> Test:
    return Test("statistics", choice)
