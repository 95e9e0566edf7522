"""Runs the tests and sums them up; the last line is "N passed, N failed[, N skipped]". The build must be there: use `make test`.

    test.py [--full] [--hosts 3.4,bpy45,bpy50] [--files a_test.py,b_test.py] all | native | addon

Native tests are GoogleTest programs. The others are pytest files that run inside each host, one process per file: a crash or a hang
costs that file, which then counts as one failure, and the rest goes on.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUNNER = ROOT / "tests" / "run_in_host.py"
HOSTS = {
    "3.4": ["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3", "--python", str(RUNNER), "--"],
    "bpy45": [str(ROOT / ".venv/bpy45/bin/python3"), str(RUNNER), "--"],
    "bpy50": [str(ROOT / ".venv/bpy50/bin/python3"), str(RUNNER), "--"],
}
LIMIT = {"native": 900, "host": 300, "full": 3600}  # seconds for one program or file

# L6: a picture of 160 x 120 pixels with all passes, and scenes, commits, renders, reconstruction and frames in the tests of the C API;
# nothing of them depends on the clock. J2: animations that change or are cancelled. Memory that is lost is an error, too.
VALGRIND = (
    "valgrind",
    "-q",
    "--error-exitcode=9",
    "--num-callers=20",
    "--leak-check=full",
    f"--suppressions={ROOT / 'tests/support/valgrind.supp'}",
)
VALGRIND_TESTS = (
    "L6_*:J2_*:Integrators/L1_Determinism.L3_Border*:G2_Pointers.*:All/Passes.LightAddsUp*/World:All/Passes.LightAddsUp*/RoughGlass"
)


@dataclass
class Result:
    name: str
    passed: int = 0
    failed: int = 0
    skipped: int = 0
    seconds: float = 0.0
    notes: list[str] = field(default_factory=list)


def run(command: list[str], limit: float, environment: dict[str, str]) -> tuple[int, str]:
    """Exit code (124: over the limit) and output. What it started ends with it."""
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


def native(program: Path, limit: float, environment: dict[str, str], choice: str = "*", under: tuple[str, ...] = ()) -> Result:
    """Runs the chosen tests of a program, under another one if it is given."""
    result = Result(" ".join(["native", str(program.relative_to(ROOT)), *under[:1]]))
    code, output = run([*under, str(program), "--gtest_brief=0", "--gtest_color=no", f"--gtest_filter={choice}"], limit, environment)
    # Counted from the log, not from the report file, which a crash would take with it.
    result.passed = len(re.findall(r"^\[       OK \] ", output, re.M))
    skipped = set(re.findall(r"^\[  SKIPPED \] ([^\s,]+)", output, re.M))
    failed = set(re.findall(r"^\[  FAILED  \] ([^\s,]+\.[^\s,]+)", output, re.M))
    result.skipped, result.failed = len(skipped), len(failed)
    finished = re.search(r"^\[==========\] .* ran\.", output, re.M)
    if failed or not finished or code not in (0, 1):
        result.notes.append(failures_of_native(output, failed))
    if not finished or (code != 0 and not failed):
        running = re.findall(r"^\[ RUN      \] (.*)$", output, re.M)[-1:] or ["its start"]
        result.failed += 1
        result.notes.append(f"ended with code {code} in {running[0]}\n{tail(output, 15)}")
    return result


def failures_of_native(output: str, failed: set[str]) -> str:
    """The part of the log that belongs to the tests that failed."""
    parts = []
    for name in sorted(failed):
        match = re.search(rf"^\[ RUN      \] {re.escape(name)}\n(.*?)^\[  FAILED  \] ", output, re.M | re.S)
        parts.append(f"{name}\n{tail(match.group(1), 20) if match else ''}")
    return "\n".join(parts)


def host(name: str, file: Path, limit: float, environment: dict[str, str]) -> Result:
    relative = file.relative_to(ROOT)
    result = Result(f"{name} {relative}")
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        command = [
            *HOSTS[name],
            str(relative),
            "-q",
            "--tb=short",
            "-p",
            "no:cacheprovider",
            f"--junitxml={report}",
            f"--basetemp={folder}/tmp",
        ]
        code, output = run(command, limit, environment)
        if report.exists():
            count_report(report, result)
    # 0: passed, 1: some failed, 5: nothing to do here. The marker says that pytest itself reached its end.
    finished = re.search(r"^GRADUS-TESTS-FINISHED (\d+)$", output, re.M)
    if finished is None or int(finished.group(1)) not in (0, 1, 5) or (code != 0 and result.failed == 0 and int(finished.group(1)) != 5):
        result.failed += 1
        result.notes.append(f"ended with code {code}\n{tail(output, 40)}")
    elif result.failed:
        result.notes.append(tail(output, 80))
    return result


def count_report(report: Path, result: Result) -> None:
    for case in ElementTree.parse(report).iter("testcase"):
        kinds = {child.tag for child in case}
        if kinds & {"failure", "error"}:
            result.failed += 1
        elif "skipped" in kinds:
            result.skipped += 1
        else:
            result.passed += 1


def tail(text: str, lines: int) -> str:
    return "\n".join("    " + line for line in text.rstrip().splitlines()[-lines:])


def test_files(selection: str) -> list[Path]:
    if selection:
        return [ROOT / name for name in selection.split(",")]
    folders = (ROOT / "tests" / "addon", ROOT / "tests" / "robustness")
    return sorted({path for folder in folders for pattern in ("*_test.py", "test_*.py") for path in folder.rglob(pattern)})


def report(result: Result, results: list[Result]) -> None:
    results.append(result)
    if result.passed + result.failed + result.skipped:
        skipped = f", {result.skipped} skipped" if result.skipped else ""
        print(f"{result.name}: {result.passed} passed, {result.failed} failed{skipped} ({result.seconds:.1f} s)", flush=True)
    for note in result.notes:
        print(note, flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("all", "native", "addon"))
    parser.add_argument("--full", action="store_true", help="with what takes long")
    parser.add_argument("--hosts", default=os.environ.get("HOSTS") or ",".join(HOSTS))
    parser.add_argument("--files", default=os.environ.get("TESTS", ""), help="test files, separated by commas; default: all")
    options = parser.parse_args()

    environment = {key: value for key, value in os.environ.items() if not key.startswith(("BLENDER_", "PYTEST_", "MAKE", "MFLAGS"))}
    # Blender's Python takes its modules from beside the first python3.11 in PATH: that must be the system's, not a version manager's.
    environment["PATH"] = "/usr/bin:/bin:" + environment.get("PATH", "")
    environment |= {"PYTHONDONTWRITEBYTECODE": "1", "GRADUS_TEST_FULL": "1" if options.full else "0"}
    environment["OPENBLAS_NUM_THREADS"] = "1"  # NumPy's threads wait for each other in loops, for longer than small matrices take
    jobs = []
    if options.what in ("all", "native"):
        limit = LIMIT["full" if options.full else "native"]
        for program in sorted((ROOT / "build" / "tests").glob("gradus_*_tests")):
            jobs.append(lambda program=program, limit=limit: native(program, limit, environment))
        if options.full:  # memory errors do not need long counts
            short = environment | {"GRADUS_TEST_FULL": "0"}
            for name in ("gradus_native_tests", "gradus_stress_tests"):
                jobs.append(lambda sanitized=ROOT / "build-sanitize" / "tests" / name: native(sanitized, limit, short))
            jobs.append(lambda: native(ROOT / "build/tests/gradus_native_tests", limit, short, VALGRIND_TESTS, VALGRIND))
    if options.what in ("all", "addon"):
        limit = LIMIT["full" if options.full else "host"]
        for name in options.hosts.split(","):
            for file in test_files(options.files):
                jobs.append(lambda name=name, file=file, limit=limit: host(name, file, limit, environment))

    results: list[Result] = []
    for job in jobs:
        start = time.monotonic()
        result = job()
        result.seconds = time.monotonic() - start
        report(result, results)
    passed, failed, skipped = (sum(getattr(result, kind) for result in results) for kind in ("passed", "failed", "skipped"))
    for result in results:
        if result.failed:
            print(f"FAILED {result.name}")
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
