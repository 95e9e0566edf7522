"""Runs GoogleTest programs and reads their logs."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from .results import Result, tail

ROOT = Path(__file__).resolve().parent.parent.parent


@dataclass
class Program:
    """Tests of a GoogleTest program: those that the filter `choice` selects, or one shard of them."""

    path: Path
    limit: float  # seconds
    choice: str = "*"
    shard: int = 0
    shards: int = 1
    under: tuple[str, ...] = ()  # a command that runs the program, for example valgrind
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        part = f" {self.shard + 1}/{self.shards}" if self.shards > 1 else ""
        return " ".join(["native", str(self.path.relative_to(ROOT)), *self.under[:1]]) + part

    def run(self, environment: dict[str, str]) -> Result:
        environment = environment | self.environment
        if self.shards > 1:
            environment |= {"GTEST_TOTAL_SHARDS": str(self.shards), "GTEST_SHARD_INDEX": str(self.shard)}
        options = ["--gtest_brief=0", "--gtest_color=no", f"--gtest_filter={self.choice}"]
        code, output = run([*self.under, str(self.path), *options], self.limit, environment)
        return read_log(Result(self.name), code, output)


def run(command: list[str], limit: float, environment: dict[str, str]) -> tuple[int, str]:
    """Returns exit code (124 if the time limit was exceeded) and output. Ends all processes of the command."""
    with tempfile.TemporaryFile() as out:
        process = subprocess.Popen(
            command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True
        )
        try:
            code = process.wait(limit)
        except subprocess.TimeoutExpired:
            code = 124
        finally:
            kill_group(process)
        out.seek(0)
        return code, out.read().decode("utf-8", "replace")


def kill_group(process: subprocess.Popen) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def read_log(result: Result, code: int, output: str) -> Result:
    """Counts tests in the log, because a report file would be missing after a crash."""
    result.passed = len(re.findall(r"^\[       OK \] ", output, re.M))
    skipped = set(re.findall(r"^\[  SKIPPED \] ([^\s,]+)", output, re.M))
    failed = set(re.findall(r"^\[  FAILED  \] ([^\s,]+\.[^\s,]+)", output, re.M))
    result.skipped, result.failed = len(skipped), len(failed)
    finished = re.search(r"^\[==========\] .* ran\.", output, re.M)
    if failed:
        result.notes.append(failures(output, failed))
    if not finished or (code != 0 and not failed):
        running = re.findall(r"^\[ RUN      \] (.*)$", output, re.M)[-1:] or ["its start"]
        result.failed += 1
        result.notes.append(f"{result.name} ended with code {code} in {running[0]}\n{tail(output, 40)}")
    return result


def failures(output: str, failed: set[str]) -> str:
    """Returns the parts of the log that belong to failed tests."""
    parts = []
    for name in sorted(failed):
        match = re.search(rf"^\[ RUN      \] {re.escape(name)}\n(.*?)^\[  FAILED  \] ", output, re.M | re.S)
        parts.append(f"{name}\n{tail(match.group(1), 20) if match else ''}")
    return "\n".join(parts)
