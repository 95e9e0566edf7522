"""Times the statistical tests of the library: unbiasedness and its bounds. Writes docs/benchmark/suite.json."""

from __future__ import annotations

import json
import re
import resource
import subprocess
import sys
import time

from scenes import ROOT

PROGRAMS = {  # program -> tests: z-tests with Šidák, Welch and bounds of bias; chi² of closures and emitters
    "gradus_statistics_tests": "*",
    "gradus_native_tests": "A3_*:A4_*",
}
RESULTS = ROOT / "docs" / "benchmark" / "suite.json"


def count(word: str, output: str) -> int:
    found = re.search(rf"\[  {word}  \] (\d+) test", output)
    return int(found[1]) if found else 0


def outcome(code: int, output: str) -> tuple[int, int]:
    """Tests that passed and failed. A program that crashed does not say what failed, and one that found no such tests has not tested:
    either counts as a failure."""
    passed, failed = count("PASSED", output), count("FAILED", output)
    return passed, failed or int(code != 0 or passed == 0)


def main() -> None:
    facts = {"passed": 0, "failed": 0, "wall": 0.0, "cpu": 0.0}
    for program, tests in PROGRAMS.items():
        wall, cpu = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        run = subprocess.run([str(ROOT / "build/tests" / program), f"--gtest_filter={tests}"], capture_output=True, text=True)
        facts["wall"] += time.perf_counter() - wall
        facts["cpu"] += resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - cpu
        passed, failed = outcome(run.returncode, run.stdout)
        facts["passed"] += passed
        facts["failed"] += failed
    facts |= {"wall": round(facts["wall"], 1), "cpu": round(facts["cpu"], 1)}
    RESULTS.write_text(json.dumps(facts) + "\n")
    print(facts)
    sys.exit(1 if facts["failed"] else 0)


if __name__ == "__main__":
    main()
