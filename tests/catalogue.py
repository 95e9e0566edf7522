"""Lists the tests of each entry of the test catalogue and writes docs/tests.md.

Tests carry the id of their entry in their name: A2_WhiteFurnace, test_h5_missing. For entries without such tests,
ELSEWHERE names the place.
"""

from __future__ import annotations

import re
import sys
from collections import defaultdict
from pathlib import Path

from support import shortened

ROOT = Path(__file__).resolve().parents[1]

# Short meanings of the entries.
ENTRIES = {
    "A1": "furnace spheres: every integrator, sampler and camera sees 1",
    "A2": "white furnace of every BSDF",
    "A3": "chi² of every sampler: BSDF, lights, environment, lens",
    "A4": "densities agree with sampling, values with weights; reciprocity; choice of lights",
    "A5": "z-tests of noisy images against an independent path tracer",
    "A6": "global bias: means and sign ratio; a bias of 1 % is detected",
    "A7": "four times the samples, a quarter of the error",
    "A8": "the reported variance is that of the spread over seeds",
    "A9": "agreement with Cycles",
    "A10": "seeds, threads and neighbours are uncorrelated",
    "B1": "reconstruction of an image with its own gradients",
    "B2": "the solvers on known systems",
    "B3": "L2 without bias, L1 within their bound",
    "B4": "shifts: Jacobians, inverse shifts, swapped ends",
    "B5": "gradients gain at equal time",
    "B6": "values that are not finite are dropped before the solve",
    "B7": "gradients are differences of the image",
    "B8": "MIS weights sum to 1; float against double",
    "C1": "motion vectors, analytic",
    "C2": "a job of one frame is a still",
    "C3": "every frame of any range is delivered, including the first and the last",
    "C4": "flicker, and the remaining noise over time",
    "C5": "ghosts and lag",
    "C6": "topology, simulations, objects that appear and disappear",
    "C7": "an animation resumed or rendered in parts",
    "C8": "shot changes",
    "C9": "frames ahead show what handlers and drivers set for them",
    "C10": "a shot that is edited and rendered again into its frame store",
    "D1": "watertight far from the origin",
    "D2": "no self-hits",
    "D3": "meshes of random bits",
    "D4": "rays with invalid values",
    "D5": "scenes of any scale",
    "D6": "scenes far away",
    "D7": "degenerate and coincident triangles",
    "D8": "a hundred thousand instances",
    "E1": "empty scenes: no objects, hidden objects, no lights",
    "E2": "broken meshes, matrices and cameras",
    "E3": "cameras with extreme settings",
    "E4": "lights with extreme settings, and many lights",
    "E5": "materials: none, unknown nodes, odd values",
    "E7": "names with any characters",
    "E8": "sizes, borders, percentages, no samples",
    "F1": "images that are missing or damaged",
    "F2": "fuzzing of all files that are read",
    "F3": "readers of images",
    "F5": "colour configurations that are missing or wrong",
    "F6": "stored frames: exact, and complete or absent",
    "F7": "folders that cannot be written, full disks",
    "G1": "wrong handles and calls at random",
    "G2": "wrong pointers and counts",
    "G3": "the first error of each thread is kept",
    "G4": "exceptions become codes",
    "G5": "every allocation may be refused",
    "G6": "any order of calls and releases",
    "G8": "progress rises from 0 to 1",
    "G9": "options and versions",
    "G10": "100,000 pairs of create and release",
    "H1": "layout of structs in C and in Python",
    "H2": "every function is declared with its types",
    "H3": "older and newer callers",
    "H4": "exported names; the SONAME changes with the layout",
    "H5": "a library that is missing, outdated or invalid",
    "H6": "buffers of the host",
    "H7": "the add-on enabled and disabled, loaded once",
    "I1": "every failure ends with code 1 and no file",
    "I2": "an error in frame 5 of 10, and the rerun",
    "I3": "killed at any moment, and the rerun",
    "I4": "frames rendered independently, in order, and by several workers",
    "I5": "environments: no home, other locales, odd paths",
    "I6": "the output that farms read",
    "I7": "options on the command line",
    "I8": "unchanged frames are not sampled again",
    "I9": "files have metadata about how they were rendered",
    "J1": "memory over many frames",
    "J2": "memory over changes of topology, repeated exports and cancels",
    "K1": "cancelled within a second",
    "K2": "every phase polls for cancellation",
    "K3": "many cancels have no effect on later renders",
    "K4": "edits in the viewport",
    "K5": "a cancelled render stays readable",
    "L1": "equal bits for any number of threads",
    "L2": "equal bits in other processes and folders",
    "L3": "16 + 48 samples, tiles, borders",
    "L4": "random numbers by key",
    "L5": "no flag that assumes finite numbers; other compilers and levels",
    "L6": "valgrind",
    "M1": "stored pictures, bit by bit",
    "M2": "stored pictures on other machines",
    "M3": "every fixed bug stays tested",
    "M4": "seeded faults",
}
# Entries that are tested elsewhere, or by tests without the id in their name: entry -> (where, how often).
ELSEWHERE = {
    "A9": [("docs/benchmark/README.md, Agreement (`make bench`)", "on demand")],
    "A10": [("L1: threads", "every change")],
    "B5": [("docs/benchmark/README.md (`make bench`)", "on demand")],
    "L5": [("`make compilers`: A1, A2, A4 to A6, B8 at -O0 and with clang", "on demand")],
    "L6": [
        ("tools/runner/plan.py: some native tests under sanitizers", "every change"),
        ("all of them, and L6, L3, G2 and passes under valgrind", "make test-full"),
    ],
    "M3": [("regression tests in all files", "every change")],
    "M4": [("tests/faults/faults.toml (`make faults`), result in docs/faults.md", "on demand")],
}

NATIVE = re.compile(r"^(?:INSTANTIATE_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", re.M)
PYTHON = re.compile(r"^def (test_([a-m]\d+)_\w+)", re.M)
ID = re.compile(r"([A-M]\d+)_")


def how_often(is_shortened: bool, is_full: bool = False) -> str:
    if is_full:
        return "make test-full"
    return "a part with every change, all with make test-full" if is_shortened else "every change"


def find_tests() -> dict[str, list[tuple[str, str]]]:
    """Returns, for each entry, pairs of "file: names of tests" and how often they run."""
    found: dict[str, dict[tuple[str, str], list[str]]] = defaultdict(lambda: defaultdict(list))
    for path in sorted((ROOT / "tests").rglob("*.cpp")):
        short = shortened.cpp_tests(path)
        for match in NATIVE.finditer(path.read_text()):
            name = f"{match[1]}.{match[2]}"
            entries = [id[1] for id in (ID.match(match[1]), ID.match(match[2])) if id]
            for entry in dict.fromkeys(entries):
                found[entry][str(path.relative_to(ROOT)), how_often(name in short)].append(name)
    for path in sorted((ROOT / "tests").rglob("*_test.py")):
        source, short = path.read_text(), shortened.python_tests(path)
        for match in PYTHON.finditer(source):
            is_full = source[: match.start()].rstrip().endswith("pytest.mark.full")
            often = how_often(match[1] in short, is_full)
            found[match[2].upper()][str(path.relative_to(ROOT)), often].append(match[1])
    lines = {
        entry: [(f"{file}: {', '.join(names)}", often) for (file, often), names in files.items()]
        for entry, files in found.items()
    }
    for entry, places in ELSEWHERE.items():
        lines.setdefault(entry, []).extend(places)
    return lines


def unknown_entries() -> list[str]:
    """Returns ids in names of tests that have no entry: their tests would be missing in the table."""
    return [entry for entry in find_tests() if entry not in ENTRIES]


def table() -> str:
    tests = find_tests()
    rows = []
    for entry, meaning in ENTRIES.items():
        rows += [
            f"| {entry} | {meaning} | {where} | {often} |" for where, often in tests.get(entry, [("**none**", "")])
        ]
    title = "# Tests by the entries of the catalogue\n\nWritten by `python3 tests/catalogue.py`.\n\n"
    return title + "| | what | test | when |\n|---|---|---|---|\n" + "\n".join(rows) + "\n"


if __name__ == "__main__":
    if unknown := unknown_entries():
        sys.exit(f"no entry of the catalogue: {', '.join(unknown)}")
    (ROOT / "docs" / "tests.md").write_text(table())
    sys.exit(0)
