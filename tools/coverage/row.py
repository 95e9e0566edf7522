"""A row of the coverage table: a feature, the scene that shows it, and the scene without it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

Build = Callable[[], None]
"""Makes a scene in an empty file."""

EXACT, NOISY, FAINT = 1, 32, 128
"""Samples of scenes that have no noise, of scenes that are lit, and of passes with a small part of the light."""


@dataclass(frozen=True)
class Row:
    family: str  # the section of the document
    name: str
    build: Build
    base: Build  # the same scene without the feature, to see whether the feature has an effect
    base_name: str  # the same for rows that share a base
    samples: int = EXACT


@dataclass(frozen=True)
class Family:
    """Makes rows of one section that share a scene. `stage` makes it and returns what the changes are applied to."""

    title: str
    name: str
    stage: Callable[[], Any]
    samples: int = EXACT

    def row(self, suffix: str, change: Callable[[Any], None]) -> Row:
        return Row(
            self.title,
            f"{self.name}{suffix}",
            partial(_build, self.stage, change),
            partial(_build, self.stage, None),
            f"{self.title}/{self.name}",
            self.samples,
        )

    def rows(self, changes: Iterator[tuple[str, Callable[[Any], None]]]) -> Iterator[Row]:
        for suffix, change in changes:
            yield self.row(suffix, change)


def _build(stage: Callable[[], Any], change: Callable[[Any], None] | None) -> None:
    subject = stage()
    if change is not None:
        change(subject)
