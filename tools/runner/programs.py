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
    """Tests of a GoogleTest program: those that the filter `choice` selects. `part` names one of several parts."""

    path: Path
    limit: float  # seconds
    choice: str = "*"
    part: str = ""
    under: tuple[str, ...] = ()  # a command that runs the program, for example valgrind
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return " ".join(filter(None, ["native", str(self.path.relative_to(ROOT)), *self.under[:1], self.part]))

    def run(self, environment: dict[str, str]) -> Result:
        environment = environment | self.environment
        options = ["--gtest_brief=0", "--gtest_color=no", f"--gtest_filter={self.choice}"]
        code, output = run([*self.under, str(self.path), *options], self.limit, environment)
        return read_log(Result(self.name), code, output)


def parts(path: Path, limit: float, without: str, count: int, environment: dict[str, str]) -> list[Program]:
    """Returns `count` programs that share the tests of a program, except those that the filter `without` selects.

    A test suite stays in one part, because its tests share what they compute first.
    """
    if count == 1:
        return [Program(path, limit, f"*-{without}", environment=environment)]
    code, listed = run([str(path), "--gtest_list_tests"], limit, os.environ | environment)
    if code:  # the whole program fails in the same way, and is reported
        return [Program(path, limit, environment=environment)]
    suites: dict[str, int] = {}
    for line in listed.splitlines():
        if not line.startswith(" ") and line.split("#")[0].strip().endswith("."):
            suite = line.split("#")[0].strip()
            suites[suite] = 0
        elif line.startswith("  "):
            suites[suite] += 1
    chosen: list[list[str]] = [[] for _ in range(count)]
    sizes = [0] * count
    for suite, tests in sorted(suites.items(), key=lambda item: -item[1]):
        smallest = sizes.index(min(sizes))
        chosen[smallest].append(f"{suite}*")
        sizes[smallest] += tests
    return [
        Program(path, limit, f"{':'.join(names)}-{without}", f"{number}/{count}", environment=environment)
        for number, names in enumerate(chosen, 1)
        if names
    ]


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
