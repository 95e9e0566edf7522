"""Shows that the tests catch the seeded faults (M4): make faults.

    faults.py [--only PART_OF_A_NAME_OR_FILE] [--new] [--table FILE]

build-faults/ holds a build with the switches of all faults. For each fault of faults.toml, the tool runs the tests that
the fault names, with the fault switched on: they must fail. Before that, the same tests must pass without a fault.
Tests in Python run in a copy of the sources in build-faults/tree, where faults of the add-on are edits of a file. The
table of results goes to docs/faults.md.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fault import ROOT, Edit, Fault, Test, read_faults, switches

BUILD = ROOT / "build-faults"
COPY = BUILD / "tree"
LIMIT = 200  # seconds for one selection of tests; a selection that does not end counts as failed


def build(tests: Iterable[Test]) -> None:
    """Builds the programs of these tests, and the library in the copy of the sources if tests in Python need it."""
    if not (BUILD / "build.ninja").exists():
        run(["cmake", "-S", ".", "-B", str(BUILD), "-G", "Ninja", "-DGRADUS_FAULTS=ON"], "cmake failed")
    targets = {f"gradus_{test.program}_tests" if test.is_native else "gradus" for test in tests}
    run(["ninja", "-C", str(BUILD), *sorted(targets)], "the build failed")
    if "gradus" in targets:
        copy_sources()
        library, folder = BUILD / "native" / "libgradus.so", COPY / "addon" / "gradus" / "lib"
        run([sys.executable, "tools/bundle.py", str(library), str(folder)], "the bundle failed")


def run(command: list[str], complaint: str) -> None:
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stdout[-4000:]}\n{complaint}")


def copy_sources() -> None:
    """Copies all files that git would commit. Removes what an earlier run has copied and git does not know any more."""
    command = ["git", "ls-files", "-co", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    names = [name for name in listed if (ROOT / name).is_file()]
    for folder in {name.split("/")[0] for name in names if "/" in name}:
        for path in (COPY / folder).rglob("*.*"):
            if path.is_file() and not (ROOT / path.relative_to(COPY)).exists():
                path.unlink()
    for name in names:
        source, target = ROOT / name, COPY / name
        if target.exists() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


def passes(test: Test, switch: str = "") -> bool:
    """Returns whether all of these tests pass with a switch, or without one. Exits if the selection is empty."""
    folder = ROOT if test.is_native else COPY
    environment = {key: value for key, value in os.environ.items() if not key.startswith("BLENDER_")}
    # Blender takes relative paths from PWD, not from the folder that it runs in.
    environment |= {"GRADUS_TEST_FULL": "0", "PWD": str(folder), "PATH": "/usr/bin:/bin:" + environment.get("PATH", "")}
    environment["GRADUS_FAULT"] = switch
    with tempfile.TemporaryDirectory() as temporary:
        if test.is_native:
            command = [f"{BUILD}/tests/gradus_{test.program}_tests", f"--gtest_filter={test.choice}"]
        else:
            blender = ["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3"]
            options = ["-q", "-p", "no:cacheprovider", f"--basetemp={temporary}/tmp", "-k", test.choice]
            command = [*blender, "--python", str(COPY / "tests" / "run_in_host.py"), "--", test.program, *options]
        try:
            done = subprocess.run(
                command,
                cwd=folder,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                timeout=LIMIT,
            )
        except subprocess.TimeoutExpired:
            return False
    if "Running 0 tests" in done.stdout or (not test.is_native and done.returncode == 5):
        sys.exit(f"there are no tests {test.name}")
    if "GRADUS_FAULT: there is no fault" in done.stdout:
        sys.exit(done.stdout)
    return done.returncode == 0


@contextmanager
def edited(edit: Edit) -> Iterator[None]:
    path = COPY / edit.file
    whole = path.read_text()
    path.write_text(whole.replace(edit.old, edit.new))
    try:
        yield
    finally:
        path.write_text(whole)


def missed_tests(fault: Fault) -> list[Test]:
    """Returns the tests that pass although they should catch the fault."""
    if fault.edit is None:
        return [test for test in fault.tests if passes(test, fault.name)]
    with edited(fault.edit):
        return [test for test in fault.tests if passes(test)]


HEAD = """# Seeded faults

Written by `make faults`. Each fault of tests/faults/faults.toml is switched on in a test build of the library, or
edited into a copy of the add-on, one at a time. The tests in the last column pass without the fault and fail with it.

| fault | kind | what goes wrong | where | caught by |
|---|---|---|---|---|
"""

MISSED = "**not by** "
"""Mark in front of a test that passed with a fault."""


class Table:
    """The table of results.

    Rows of earlier runs stay until their fault is tried again, moves to another file, or is described otherwise or
    caught by other tests in faults.toml.
    """

    def __init__(self, path: Path, faults: list[Fault]) -> None:
        self._path, self._faults = path, faults
        self._file = dict(switches()) | {fault.name: fault.edit.file for fault in faults if fault.edit}
        lines = path.read_text().splitlines() if path.exists() else []
        rows = {line.replace(MISSED, ""): line for line in lines}
        self._rows = {f.name: rows[self._row(f, [])] for f in faults if self._row(f, []) in rows}

    def has(self, fault: Fault) -> bool:
        return fault.name in self._rows

    def where(self, fault: Fault) -> str:
        return self._file[fault.name]

    def _row(self, fault: Fault, missed: list[Test]) -> str:
        names = ", ".join(f"{MISSED if test in missed else ''}`{test.name}`" for test in fault.tests)
        return f"| {fault.name} | {fault.kind} | {fault.meaning} | `{self._file[fault.name]}` | {names} |"

    def add(self, fault: Fault, missed: list[Test]) -> str:
        """Adds a row, writes the table, and returns the row."""
        self._rows[fault.name] = self._row(fault, missed)
        tried = [fault for fault in self._faults if self.has(fault)]
        lines = [self._rows[fault.name] for fault in tried]
        kinds, missing = len({fault.kind for fault in tried}), sum(MISSED in line for line in lines)
        summary = f"{kinds} kinds of faults in {len(tried)} of {len(self._faults)} places, {missing} of them missed."
        self._path.write_text(HEAD + "\n".join([*lines, "", summary]) + "\n")
        return self._rows[fault.name]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="try only faults whose name or file contains this; other rows stay")
    parser.add_argument("--new", action="store_true", help="try only faults without a row in the table")
    parser.add_argument("--table", type=Path, default=ROOT / "docs" / "faults.md", help="path of the table")
    options = parser.parse_args()
    every = read_faults()
    table = Table(options.table, every)
    faults = [f for f in every if options.only in f.name or options.only in table.where(f)]
    if options.new:
        faults = [fault for fault in faults if not table.has(fault)]

    tests = tuple(dict.fromkeys(test for fault in faults for test in fault.tests))
    build(tests)
    broken = [test.name for test in tests if not passes(test)]
    if broken:
        sys.exit("these tests fail without a fault: " + "; ".join(broken))
    print(f"{len(tests)} selections of tests pass without a fault", flush=True)

    caught = 0
    for fault in faults:
        missed = missed_tests(fault)
        caught += not missed
        print(table.add(fault, missed), flush=True)
    print(f"{len(faults)} faults, {len(faults) - caught} of them missed")
    return 0 if caught == len(faults) else 1


if __name__ == "__main__":
    sys.exit(main())
