"""Measures in each installed Blender what only Blender's side costs: export and upload. Runs host_worker.py in each."""

from __future__ import annotations

import json
import statistics
import subprocess
from collections.abc import Iterator
from typing import Any

import hosts
import records
from paths import HERE
from version import conditions, version_of_build

RESULTS = records.file_of("host")
WORKER = HERE / "host_worker.py"


def commands() -> Iterator[list[str]]:
    """Yields the commands that run the worker in the Blender application and in all installed modules."""
    yield hosts.application_command(WORKER)
    for blender in hosts.MODULES:
        if hosts.is_installed(blender):
            yield hosts.module_command(WORKER, blender)


def measure(command: list[str]) -> dict[str, Any]:
    process = subprocess.run(command, capture_output=True, text=True, timeout=300)
    for line in process.stdout.splitlines():
        if line.startswith("RESULT "):
            return json.loads(line.removeprefix("RESULT "))
    raise RuntimeError(f"{command[0]} ended with code {process.returncode}:\n{process.stderr[-2000:]}")


def newest() -> list[records.Row]:
    """Returns the last run of each Blender."""
    return list({row["host"]: row for row in records.read(RESULTS)}.values())


def main() -> None:
    for command in commands():
        row = measure(command)
        records.append(conditions(version_of_build()) | row, RESULTS)
        medians = {name: statistics.median(row[name]) for name in ("export", "upload", "refresh")}
        print(
            f"Blender {row['host']}: " + ", ".join(f"{name} {value:.4f} s" for name, value in medians.items()),
            flush=True,
        )


if __name__ == "__main__":
    main()
