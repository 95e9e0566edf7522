"""Runs the rows of one Blender in processes of their own, one after another. A crash or a hang costs one row."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from runner.hosts import command_of, environment_of_hosts
from runner.programs import kill_group

WORKER = Path(__file__).resolve().parent / "worker.py"
LIMIT = 600.0  # seconds without an answer; the slowest row takes one minute if nothing else runs
FAILS = "fails"  # as in trial.py, which only a Blender can import


def outcomes(host: str, pattern: str, done: set[str], log: Path) -> Iterator[dict[str, Any]]:
    """Yields the outcomes of all rows that match `pattern` and are not in `done`, which gets their names.

    Yields {"rows": count} first and again after each restart.
    """
    while True:
        begun: dict[str, Any] | None = None
        reason = "crash"
        with Process(host, pattern, done, log) as process:
            for answer in process.answers():
                if answer is None:
                    reason = f"no answer in {LIMIT:.0f} s"
                    break
                if "end" in answer:
                    return
                if "begin" in answer:
                    begun = answer
                else:
                    if "name" in answer:
                        begun = None
                        done.add(answer["name"])
                    yield answer
        if begun is None:
            raise RuntimeError(f"{host}: the worker ended before its first row; its output is in {log}")
        done.add(begun["begin"])
        yield {"family": begun["family"], "name": begun["begin"], "verdict": FAILS, "note": reason, "size": 0.0}


class Process:
    """A worker process, whose other output goes to a file."""

    def __init__(self, host: str, pattern: str, done: set[str], log: Path) -> None:
        self._names = tempfile.NamedTemporaryFile("w", suffix=".txt")  # noqa: SIM115  (closed by __exit__)
        self._names.write("\n".join(sorted(done)))
        self._names.flush()
        self._log = log.open("ab")
        self._process = subprocess.Popen(
            [*command_of(host, WORKER), "--", pattern, self._names.name],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=self._log, start_new_session=True,
            env=environment_of_hosts(dict(os.environ)),
        )  # fmt: skip
        self._lines: queue.Queue[bytes] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self._process.stdout:
            self._lines.put(line)
        self._lines.put(b"")

    def answers(self) -> Iterator[dict[str, Any] | None]:
        """Yields the answers until the process ends, and None if it is silent for too long."""
        while True:
            try:
                line = self._lines.get(timeout=LIMIT)
            except queue.Empty:
                yield None
                return
            if not line:
                return
            if line.startswith(b"RESULT "):
                yield json.loads(line.removeprefix(b"RESULT "))

    def __enter__(self) -> Process:
        return self

    def __exit__(self, *_: object) -> None:
        kill_group(self._process)
        self._names.close()
        self._log.close()
