"""One process per host runs one test file after another. After a crash or a hang, a new process is started."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import subprocess
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from .programs import kill_group
from .results import Result, tail

ROOT = Path(__file__).resolve().parent.parent.parent
RUNNER = ROOT / "tests" / "run_in_host.py"


APPLICATION = "3.4"


def command_of(host: str, script: Path) -> list[str]:
    """Returns the command that runs a script in a Blender: in the application, or in a Python that has the module."""
    if host == APPLICATION:
        options = ["-b", "--factory-startup", "-noaudio", "--python-exit-code", "3"]
        return ["blender", *options, "--python", str(script)]
    return [str(ROOT / ".venv" / host / "bin" / "python3"), str(script)]


# "plain" has the packages of bpy45's environment, but cannot import bpy.
HOSTS = {
    "plain": [*command_of("bpy45", RUNNER), "--", "--plain"],
    **{host: [*command_of(host, RUNNER), "--"] for host in (APPLICATION, "bpy45", "bpy50", "bpy52")},
}


def environment_of_hosts(environment: dict[str, str]) -> dict[str, str]:
    """Returns an environment without variables that would change what a Blender does."""
    foreign = ("BLENDER_", "PYTEST_", "MAKE", "MFLAGS")
    result = {key: value for key, value in environment.items() if not key.startswith(foreign)}
    # Blender's Python takes its modules from the folder of the first python3.11 in PATH, which must be the system's.
    result["PATH"] = "/usr/bin:/bin:" + result.get("PATH", "")
    # Without compiled modules, a start of Blender takes twice as long. The folders of the sources stay as they are.
    result.pop("PYTHONDONTWRITEBYTECODE", None)
    result["PYTHONPYCACHEPREFIX"] = str(ROOT / "build" / "python")
    # NumPy's threads wait in busy loops that take longer than small matrices.
    result["OPENBLAS_NUM_THREADS"] = "1"
    return result


def is_missing(host: str) -> bool:
    """Returns whether a host cannot run here. Only bpy52 may be absent: Debian 12 does not have its Python 3.13."""
    return host == "bpy52" and not Path(HOSTS[host][0]).exists()


@dataclass(frozen=True)
class TestFile:
    """A test file for one host. `marks`, an expression of pytest over marks, and `tests`, their names, limit it."""

    path: Path
    limit: float  # seconds
    marks: str = ""
    tests: tuple[str, ...] = ()

    __test__ = False

    @property
    def name(self) -> str:
        return str(self.path.relative_to(ROOT) if self.path.is_relative_to(ROOT) else self.path)

    def arguments(self, folder: Path) -> list[str]:
        paths = [f"{self.path}::{test}" for test in self.tests] or [str(self.path)]
        marks = ["-m", self.marks] if self.marks else []
        outputs = [f"--junitxml={folder}/report.xml", f"--basetemp={folder}/tmp"]
        return [*paths, *marks, "-q", "--tb=short", "-p", "no:cacheprovider", *outputs]


class HostProcess:
    """A host that takes test files over a socket; tests/run_in_host.py is the other end."""

    def __init__(self, name: str, environment: dict[str, str]) -> None:
        self.name = name
        self._environment = environment
        self._process: subprocess.Popen | None = None
        self._output: BinaryIO | None = None
        self._channel: socket.socket | None = None

    def run(self, file: TestFile) -> Result:
        result = Result(f"{self.name} {file.name}")
        if self._process is None:
            self._start()
        start = self._output.seek(0, os.SEEK_END)
        with tempfile.TemporaryDirectory() as folder:
            code = self._ask(file.arguments(Path(folder)), file.limit)
            report = Path(folder) / "report.xml"
            if report.exists():
                count_report(report, result)
        self._output.seek(start)
        output = self._output.read().decode("utf-8", "replace")
        # 0: passed, 5: no test of the file belongs to this host. With other codes the report may lack what went wrong.
        if isinstance(code, str) or (code not in (0, 5) and not result.failed):
            result.failed += 1
            result.notes.append(f"{result.name} ended with {code}")
        if result.failed:
            result.notes.append(tail(output, 80))
        return result

    def _start(self) -> None:
        ours, theirs = socket.socketpair()
        self._output = tempfile.TemporaryFile("a+b")  # noqa: SIM115  (the host appends to it while this process seeks)
        self._process = subprocess.Popen(
            [*HOSTS[self.name], "--serve", str(theirs.fileno())],
            cwd=ROOT, env=self._environment, stdin=subprocess.DEVNULL, stdout=self._output, stderr=self._output,
            pass_fds=[theirs.fileno()], start_new_session=True,
        )  # fmt: skip
        theirs.close()
        self._channel = ours

    def _ask(self, arguments: list[str], limit: float) -> int | str:
        """Returns pytest's exit code for these arguments, or a message if the process ended or exceeded the limit."""
        answer, end = b"", time.monotonic() + limit
        try:
            self._channel.sendall(json.dumps(arguments).encode() + b"\n")
            while not answer.endswith(b"\n"):
                self._channel.settimeout(max(end - time.monotonic(), 0.001))
                part = self._channel.recv(64)
                if not part:
                    return self._end("crash")
                answer += part
        except TimeoutError:
            return self._end(f"time limit of {limit:.0f} s")
        except OSError:
            return self._end("crash")
        return int(answer)

    def _end(self, reason: str) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            reason += f", code {self._process.wait(1.0)}"
        self._stop()
        return reason

    def _stop(self) -> None:
        kill_group(self._process)
        self._channel.close()
        self._process = None

    def close(self) -> None:
        """Ends the process and everything that its tests left running."""
        if self._process is None:
            return
        self._channel.shutdown(socket.SHUT_WR)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(10.0)
        self._stop()
        self._output.close()


def count_report(report: Path, result: Result) -> None:
    for case in ElementTree.parse(report).iter("testcase"):
        kinds = {child.tag for child in case}
        if kinds & {"failure", "error"}:
            result.failed += 1
        elif "skipped" in kinds:
            result.skipped += 1
        else:
            result.passed += 1
