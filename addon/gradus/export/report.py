"""The result of an export, its warnings, and the polling of its cancellation."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from ..failure import Failure


class ExportError(Failure):
    """The scene cannot be rendered. The text is for the user."""


class Cancelled(Exception):
    """The user cancelled the export."""


@dataclass
class ExportReport:
    width: int  # pixels of the full frame
    height: int
    warnings: list[str] = field(default_factory=list)
    seconds: float = 0.0
    digest: bytes = b""  # of all that was set, if it was asked for


class Warnings:
    """A list of texts for the user without duplicates."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def add(self, text: str) -> None:
        if text not in self.texts:
            self.texts.append(text)


class Poll:
    """Calls `cancelled` at intervals, because asking Blender for every object would be slow."""

    INTERVAL = 0.05  # s; well below the 0.25 s within which a cancel must be noticed

    def __init__(self, cancelled: Callable[[], bool] | None) -> None:
        self._cancelled = cancelled
        self._last = 0.0

    def __call__(self) -> None:
        """Raises Cancelled if the user has cancelled."""
        if self._cancelled is None:
            return
        now = time.monotonic()
        if now - self._last < self.INTERVAL:
            return
        self._last = now
        if self._cancelled():
            raise Cancelled
