"""Counts of passed, failed and skipped tests, and their report."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, field


@dataclass
class Result:
    """The outcome of one program or file. `notes` are printed below its line."""

    name: str
    passed: int = 0
    failed: int = 0
    skipped: int = 0
    seconds: float = 0.0
    notes: list[str] = field(default_factory=list)


class Report:
    """Prints each result as it arrives, from any thread, and sums them up."""

    def __init__(self) -> None:
        self.results: list[Result] = []
        self._lock = threading.Lock()
        self._begin = time.monotonic()

    def add(self, result: Result) -> None:
        with self._lock:
            self.results.append(result)
            if result.passed + result.failed + result.skipped:
                print(f"{result.name}: {counts(result)} ({result.seconds:.1f} s)", flush=True)
            for note in result.notes:
                print(note, flush=True)

    def finish(self) -> bool:
        """Prints the time of each group and, as the last line, the sums. Returns whether tests ran and none failed."""
        groups: dict[str, float] = {}
        for result in self.results:
            group = result.name.split()[0]
            groups[group] = groups.get(group, 0.0) + result.seconds
        parts = ", ".join(f"{group} {seconds:.0f} s" for group, seconds in groups.items())
        print(f"time: {time.monotonic() - self._begin:.0f} s; job time: {parts}")
        for result in self.results:
            if result.failed:
                print(f"FAILED {result.name}")
        total = Result("all")
        for result in self.results:
            total.passed += result.passed
            total.failed += result.failed
            total.skipped += result.skipped
        print(counts(total))
        return total.passed > 0 and total.failed == 0


def counts(result: Result) -> str:
    return f"{result.passed} passed, {result.failed} failed" + (f", {result.skipped} skipped" if result.skipped else "")


def tail(text: str, lines: int) -> str:
    """Returns the last lines of a log, indented."""
    return "\n".join("    " + line for line in text.rstrip().splitlines()[-lines:])
