"""Determines which tests run where.

Every test of the add-on and of the tools runs once: in plain Python where it does not need Blender, else in bpy45. The
other hosts run the tests of tests/smoke.txt, and Blender 3.4 also every test that needs the application. The full run
has every file in every host.
"""

from __future__ import annotations

from pathlib import Path

from .hosts import HOSTS, TestFile
from .imports import needs_blender
from .programs import Program, parts

ROOT = Path(__file__).resolve().parent.parent.parent
SMOKE = ROOT / "tests" / "smoke.txt"
COMPLETE = "bpy45"

LIMIT = {"native": 900, "host": 300, "full": 3600}  # seconds for one program or file

# Programs by the number of processes that share their tests, so that no long program ends beside an idle core.
PARTS = {
    "gradus_native_tests": 12,
    "gradus_statistics_tests": 4,
    "gradus_stress_tests": 3,
    "gradus_regression_tests": 2,
}
# Tests that compare elapsed time with a limit run alone.
ALONE = "K1_*:K2_Cancel.*:Preview.*:Loop.ReadingDoesNotWaitForABatch:Loop.StopsByTime*:*TimeLimit*"
# Time limits of these tests are exceeded under ThreadSanitizer, which is ten times slower. Other tests cover threads.
LIMITS = (
    "*TimeLimit*:K2_Cancel.*:Preview.TakesATwentiethOfTheTime:Preview.ACancelEndsTheQuarterSizedPicture"
    ":Preview.ACancelOfTheReconstructionLeavesTheSamples:Loop.StopsByTime*"
)
# These compare pictures with converged ones, which takes minutes under ThreadSanitizer: a part of the full run.
CONVERGED = "WatchedScene.*"
# L6: a picture of 160 x 120 pixels with all passes, and scenes, commits, renders, reconstruction and frames in the
# tests of the C API; nothing of them depends on the clock. J2: animations that change or are cancelled. Memory that is
# lost is an error, too.
VALGRIND = (
    "valgrind",
    "-q",
    "--error-exitcode=9",
    "--num-callers=20",
    "--leak-check=full",
    f"--suppressions={ROOT / 'tests/support/valgrind.supp'}",
)
VALGRIND_TESTS = (
    "L6_*:J2_*:Integrators/L1_Determinism.L3_Border*:G2_Pointers.*"
    ":All/Passes.LightAddsUp*/World:All/Passes.LightAddsUp*/RoughGlass"
)


# Environments of the sanitizers. The lists of suppressions name their reasons.
ADDRESS = {"LSAN_OPTIONS": f"suppressions={ROOT / 'tests/support/lsan.supp'} print_suppressions=0"}
THREAD = {"TSAN_OPTIONS": f"suppressions={ROOT / 'tests/support/tsan.supp'} die_after_fork=0"}
# Programs with sanitizers of every change (False) and of the full run (True), and the tests that they leave out here.
# Renders of hard scenes have no threads that other tests lack.
SANITIZED = {
    False: (
        (ROOT / "build-sanitize/tests/gradus_sanitized_tests", ADDRESS, ALONE),
        (ROOT / "build-thread/tests/gradus_thread_tests", THREAD, f"{ALONE}:{CONVERGED}"),
    ),
    True: (
        (ROOT / "build-address/tests/gradus_native_tests", ADDRESS, ALONE),
        (ROOT / "build-address/tests/gradus_stress_tests", ADDRESS, ALONE),
        (ROOT / "build-thread/tests/gradus_native_tests", THREAD, ALONE),
    ),
}


def test_files(selection: str) -> list[Path]:
    if selection:
        return [ROOT / name for name in selection.split(",")]
    folders = (ROOT / "tests" / name for name in ("addon", "robustness", "tools"))
    patterns = ("*_test.py", "test_*.py")
    return sorted({path for folder in folders for pattern in patterns for path in folder.rglob(pattern)})


def smoke() -> dict[str, dict[Path, tuple[str, ...]]]:
    """Returns, by host and file, the names of tests in tests/smoke.txt; without names, the whole file runs."""
    found: dict[str, dict[Path, tuple[str, ...]]] = {host: {} for host in HOSTS}
    others = [host for host in HOSTS if host not in ("plain", COMPLETE)]
    for number, line in enumerate(SMOKE.read_text().splitlines(), 1):
        entry, _, reason = line.partition("#")
        if not entry.strip():
            continue
        hosts, name = entry.split()
        file, _, test = name.partition("::")
        path = ROOT / file
        if not reason.strip() or not path.is_file() or not set(hosts.split(",")) <= {"all", *HOSTS}:
            raise SystemExit(f"{SMOKE}:{number}: expected hosts, an existing test file and a reason: {line}")
        for host in others if hosts == "all" else hosts.split(","):
            tests = found[host].get(path, ())
            found[host][path] = (*tests, test) if test else ()
    return found


def hosts_plan(hosts: list[str] | None, files: list[Path], full: bool) -> dict[str, list[TestFile]]:
    """Returns the files of each host. Hosts that are named run all files that they can run."""
    limit = LIMIT["full" if full else "host"]
    chosen = smoke()
    result: dict[str, list[TestFile]] = {}
    for host in hosts or HOSTS:
        for path in files:
            everything = TestFile(path, limit)
            if needs_blender(path):
                file = everything if hosts or full or host == COMPLETE else in_other_host(host, path, limit, chosen)
            elif host == "plain" or hosts:
                file = everything
            else:
                file = TestFile(path, limit, "not application") if full else None
            if file and not (host == "plain" and needs_blender(path)):
                result.setdefault(host, []).append(file)
    return result


def in_other_host(
    host: str, path: Path, limit: float, chosen: dict[str, dict[Path, tuple[str, ...]]]
) -> TestFile | None:
    """Returns the tests of a file for a host that does not run everything, or None."""
    if path in chosen[host]:
        return TestFile(path, limit, tests=chosen[host][path])
    return TestFile(path, limit, "application") if host == "3.4" and has_application_tests(path) else None


def has_application_tests(path: Path) -> bool:
    """Returns whether a file has the mark or the fixture for tests of the application (tests/conftest.py)."""
    text = path.read_text()
    return "mark.application" in text or "blender" in text


def split_alone(
    lanes: dict[str, list[TestFile]],
) -> tuple[dict[str, list[TestFile]], dict[str, list[TestFile]]]:
    """Separates the tests that measure time (mark "alone") from the others."""
    together: dict[str, list[TestFile]] = {}
    alone: dict[str, list[TestFile]] = {}
    for host, files in lanes.items():
        for file in files:
            if "mark.alone" not in file.path.read_text():
                together.setdefault(host, []).append(file)
                continue
            for lane, mark in ((together, "not alone"), (alone, "alone")):
                marks = f"{file.marks} and {mark}" if file.marks else mark
                lane.setdefault(host, []).append(TestFile(file.path, file.limit, marks, file.tests))
    return together, alone


def native_plan(full: bool) -> tuple[list[Program], list[Program]]:
    """Returns the native programs in parts, and their tests that must run alone."""
    limit = LIMIT["full" if full else "native"]
    together, alone = [], []
    for path in sorted((ROOT / "build" / "tests").glob("gradus_*_tests")):
        together += parts(path, limit, ALONE, PARTS.get(path.name, 1), {})
        alone.append(Program(path, limit, ALONE))
    return together, alone


def sanitized_plan(full: bool) -> tuple[list[Program], list[Program]]:
    """Returns the programs under sanitizers, and those of their tests that run alone.

    Every change runs those tests under a sanitizer for which it is the best witness (tests/CMakeLists.txt). The
    full run has all native tests under all sanitizers, stress tests, and some under valgrind. All counts are short.
    """
    limit = LIMIT["full" if full else "native"]
    programs, alone = [], []
    for path, variables, without in SANITIZED[full]:
        environment = variables | {"GRADUS_TEST_FULL": "0"}
        programs += parts(path, limit, without, PARTS.get(path.name, 1), environment)
        # Tests with time limits would exceed them in instrumented programs.
        alone.append(Program(path, limit, f"{ALONE}-{LIMITS}", environment=environment))
    if full:
        native = ROOT / "build" / "tests" / "gradus_native_tests"
        environment = {"GRADUS_TEST_FULL": "0"}
        programs.append(Program(native, limit, VALGRIND_TESTS, under=VALGRIND, environment=environment))
    return programs, alone
