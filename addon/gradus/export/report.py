"""What an export hands back, and what goes through all of its parts."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field


class ExportError(RuntimeError):
    """The scene cannot be rendered as it is; the text is for the user."""


class Cancelled(Exception):
    """The user asked to stop while the scene was exported."""


@dataclass
class ExportReport:
    width: int  # pixels of the full frame
    height: int
    warnings: list[str] = field(default_factory=list)
    seconds: float = 0.0


class Warnings:
    """Texts for the user, each once."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def add(self, text: str) -> None:
        if text not in self.texts:
            self.texts.append(text)


class Poll:
    """Asks `cancelled` now and then: asking Blender costs, and every object would be too often."""

    INTERVAL = 0.05  # s; test K2 wants the longest gap below 0.25 s

    def __init__(self, cancelled: Callable[[], bool] | None) -> None:
        self._cancelled = cancelled
        self._last = 0.0

    def __call__(self) -> None:
        """Raises Cancelled when the user wants to stop."""
        if self._cancelled is None:
            return
        now = time.monotonic()
        if now - self._last < self.INTERVAL:
            return
        self._last = now
        if self._cancelled():
            raise Cancelled
