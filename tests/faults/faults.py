"""Shows that the tests catch the seeded faults (M4): make faults.

    faults.py [--only PART_OF_A_NAME_OR_FILE] [--new] [--table FILE]

For each fault, the tool edits a copy of the sources in build-faults/, builds it, and runs the tests that the fault names: they
must fail. Before that, the same tests must pass without a fault. The table of results goes to docs/faults.md.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fault import Fault, Test
from light_faults import LIGHT
from motion_faults import MOTION
from reconstruction_faults import RECONSTRUCTION
from renderer_faults import RENDERER
from sequence_faults import SEQUENCES

ROOT = Path(__file__).resolve().parents[2]
FAULTS = (*RENDERER, *RECONSTRUCTION, *MOTION, *SEQUENCES, *LIGHT)
COPY = ROOT / "build-faults"
LIMIT = 200  # seconds for one selection of tests; a selection that does not end counts as failed


def copy_sources() -> None:
    """Copies all files that git would commit. Unchanged files keep their times, so that a second run builds little."""
    command = ["git", "ls-files", "-co", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    names = listed.stdout.splitlines()
    for folder in {name.split("/")[0] for name in names if "/" in name}:
        for path in (COPY / folder).rglob("*.*"):
            if path.is_file() and not (ROOT / path.relative_to(COPY)).exists():
                path.unlink()  # renamed or removed since the last run
    for name in names:
        source, target = ROOT / name, COPY / name
        if not source.is_file() or (target.exists() and target.read_bytes() == source.read_bytes()):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
        target.chmod(source.stat().st_mode)


def build(tests: tuple[Test, ...]) -> None:
    if not (COPY / "build" / "build.ninja").exists():
        command = ["cmake", "-S", ".", "-B", "build", "-G", "Ninja"]
        subprocess.run(command, cwd=COPY, check=True, stdout=subprocess.DEVNULL)
    targets = {f"gradus_{test.program}_tests" if test.is_native else "gradus" for test in tests}
    run(["ninja", "-C", "build", *sorted(targets)], "the build failed")
    if "gradus" in targets:
        run([sys.executable, "tools/bundle.py", "build/native/libgradus.so", "addon/gradus/lib"], "the bundle failed")


def run(command: list[str], complaint: str) -> None:
    done = subprocess.run(command, cwd=COPY, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stdout[-4000:]}\n{complaint}")


def passes(test: Test) -> bool:
    """Returns whether all of these tests pass. Exits if the selection is empty."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("BLENDER_")}
    # Blender takes relative paths from PWD, not from the folder that it runs in.
    environment |= {"GRADUS_TEST_FULL": "0", "PWD": str(COPY), "PATH": "/usr/bin:/bin:" + environment.get("PATH", "")}
    with tempfile.TemporaryDirectory() as folder:
        if test.is_native:
            command = [f"build/tests/gradus_{test.program}_tests", f"--gtest_filter={test.choice}"]
        else:
            blender = ["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3"]
            options = ["-q", "-p", "no:cacheprovider", f"--basetemp={folder}/tmp", "-k", test.choice]
            command = [*blender, "--python", str(COPY / "tests" / "run_in_host.py"), "--", test.program, *options]
        try:
            done = subprocess.run(
                command,
                cwd=COPY,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=LIMIT,
            )
        except subprocess.TimeoutExpired:
            return False
    if "Running 0 tests" in done.stdout or "GRADUS-TESTS-FINISHED 5" in done.stdout:
        sys.exit(f"there are no tests {test.name}")
    return done.returncode == 0


def require_places(faults: list[Fault]) -> None:
    for fault in faults:
        count = (COPY / fault.file).read_text().count(fault.old)
        if count != 1:
            sys.exit(f"{fault.name} ({fault.meaning}): its text occurs {count} times in {fault.file}, not once")


@contextmanager
def seeded(fault: Fault) -> Iterator[None]:
    path = COPY / fault.file
    whole = path.read_text()
    path.write_text(whole.replace(fault.old, fault.new))
    try:
        yield
    finally:
        path.write_text(whole)


def key(fault: Fault) -> str:
    """Returns the start of the table row. It includes the file: a fault whose code has moved is tried again."""
    return f"| {fault.number} | {fault.name} | {fault.meaning} | `{fault.file}` |"


def row(fault: Fault, caught: dict[Test, bool]) -> str:
    names = ", ".join(f"`{test.name}`" if found else f"**not by** `{test.name}`" for test, found in caught.items())
    return f"{key(fault)} {names} |"


HEAD = """# Seeded faults

Written by `make faults`. Each fault of tests/faults is put into a copy of the sources, one at a time. The tests in
the last column pass without the fault and fail with it.

| | fault | where | seeded in | caught by |
|---|---|---|---|---|
"""


def rows_of(table: Path) -> dict[str, str]:
    """Returns the rows that earlier runs wrote for faults that still exist."""
    lines = table.read_text().splitlines() if table.exists() else []
    return {key(fault): line for fault in FAULTS for line in lines if line.startswith(key(fault))}


def write(table: Path, rows: dict[str, str]) -> None:
    tried = [fault for fault in FAULTS if key(fault) in rows]
    kinds = len({fault.number for fault in tried})
    missed = sum("**not by**" in row for row in rows.values())
    lines = [rows[key(fault)] for fault in tried]
    summary = f"{kinds} kinds of faults in {len(tried)} of {len(FAULTS)} places, {missed} of them missed."
    table.write_text(HEAD + "\n".join([*lines, "", summary]) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="try only faults whose name or file contains this; other rows stay")
    parser.add_argument("--new", action="store_true", help="try only faults without a row in the table")
    parser.add_argument("--table", type=Path, default=ROOT / "docs" / "faults.md", help="path of the table")
    options = parser.parse_args()
    faults = [fault for fault in FAULTS if options.only in fault.name or options.only in fault.file]
    rows = rows_of(options.table)
    if options.new:
        faults = [fault for fault in faults if key(fault) not in rows]
    copy_sources()
    require_places(faults)

    tests = tuple(dict.fromkeys(test for fault in faults for test in fault.tests))
    build(tests)
    broken = [test.name for test in tests if not passes(test)]
    if broken:
        sys.exit("these tests fail without a fault: " + "; ".join(broken))
    print(f"{len(tests)} selections of tests pass without a fault", flush=True)

    for fault in faults:
        with seeded(fault):
            build(fault.tests)
            rows[key(fault)] = row(fault, {test: not passes(test) for test in fault.tests})
        print(rows[key(fault)], flush=True)
        write(options.table, rows)
    build(tests)  # of the sources without a fault
    missed = sum("**not by**" in rows[key(fault)] for fault in faults)
    print(f"{len(faults)} faults, {missed} of them missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
