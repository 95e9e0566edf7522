"""The stats object of a delivered frame: that of the library, with the times of the add-on and of the process.

No Blender here.
"""

from __future__ import annotations

import json
import os
import resource
import time
from contextlib import contextmanager
from typing import Any

from .failure import Failure


class Clock:
    """Measures wall and CPU seconds by phase. A phase may be entered repeatedly."""

    def __init__(self) -> None:
        self.wall: dict[str, float] = {}
        self.cpu: dict[str, float] = {}
        self._start = time.perf_counter()
        self._cpu_start = time.process_time()
        self._paused = (0.0, 0.0)

    @contextmanager
    def phase(self, name: str) -> Any:
        wall, cpu = time.perf_counter(), time.process_time()
        try:
            yield
        finally:
            self.wall[name] = self.wall.get(name, 0.0) + time.perf_counter() - wall
            self.cpu[name] = self.cpu.get(name, 0.0) + time.process_time() - cpu

    def pause(self) -> None:
        """Excludes the time until resume(), in which other frames are rendered."""
        self._paused = time.perf_counter(), time.process_time()

    def resume(self) -> None:
        self._start += time.perf_counter() - self._paused[0]
        self._cpu_start += time.process_time() - self._paused[1]

    def total(self) -> float:
        return time.perf_counter() - self._start

    def total_cpu(self) -> float:
        return time.process_time() - self._cpu_start


def complete(native_json: str, host: dict[str, Any], clock: Clock, warnings: list[str]) -> dict[str, Any]:
    """Returns the complete stats object. `host` holds frame, layer, scene and view."""
    stats = {**json.loads(native_json or "{}"), **host}
    for field, measured in (("seconds", clock.wall), ("cpu_seconds", clock.cpu)):
        stats[field] = {**stats.get(field, {}), **{name: round(value, 6) for name, value in measured.items()}}
    stats["seconds"]["total"] = round(clock.total(), 6)
    cpu = stats["cpu_seconds"]
    cpu["total"] = round(sum(value for name, value in cpu.items() if name != "total"), 6)
    stats["process_cpu"] = round(clock.total_cpu(), 6)
    resident_bytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    stats["peak_memory_bytes"] = max(int(stats.get("peak_memory_bytes", 0)), resident_bytes)
    native_warnings = stats.get("warnings", [])
    stats["warnings"] = [*native_warnings, *(text for text in warnings if text not in native_warnings)]
    return stats


def check(path: str) -> None:
    """Raises Failure if append() cannot write to the file, before a render takes its time. Makes no file."""
    target = path if os.path.exists(path) else os.path.dirname(os.path.abspath(path))
    if os.path.isdir(path) or not os.access(target, os.W_OK):
        raise Failure(f"cannot write the statistics to {path}")


def append(path: str, stats: dict[str, Any]) -> None:
    """Appends one line in a single write, so that several processes may share the file."""
    line = json.dumps(stats, separators=(",", ":"), ensure_ascii=False) + "\n"
    handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    try:
        os.write(handle, line.encode("utf-8"))
    finally:
        os.close(handle)
