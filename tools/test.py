"""Runs the tests and sums them up; the last line is "N passed, N failed[, N skipped]". `make test` builds before.

    test.py [--full] [--hosts plain,3.4,bpy45,bpy50,bpy52] [--files a_test.py,b_test.py] [--jobs 2] all | native | addon

Native tests are GoogleTest programs. The others are pytest files: those that need no Blender run in plain Python, the
others in one process per host. A file that crashes or hangs counts as one failure and costs a new process, and the rest
goes on. runner/plan.py says which files run in which host.
"""

from __future__ import annotations

import argparse
import os
import sys

from runner import plan
from runner.checks import CHECKS
from runner.hosts import environment_of_hosts, is_missing
from runner.pool import Pool
from runner.results import Report, Result

ROOT = plan.ROOT


def environment_of_tests(full: bool) -> dict[str, str]:
    return environment_of_hosts(dict(os.environ)) | {"GRADUS_TEST_FULL": "1" if full else "0"}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("all", "native", "addon"))
    parser.add_argument("--full", action="store_true", help="with tests that take long, and everything in all hosts")
    parser.add_argument("--hosts", default=os.environ.get("HOSTS", ""), help="run everything in these hosts only")
    parser.add_argument("--files", default=os.environ.get("TESTS", ""), help="test files; default: all")
    parser.add_argument("--jobs", type=int, default=2, help="how many programs and hosts run at a time")
    options = parser.parse_args()

    report = Report()
    environment = environment_of_tests(options.full)
    together: dict[str, list] = {}
    alone: dict[str, list] = {}
    if options.what in ("all", "native"):
        together["native"], alone["native"] = plan.native_plan(options.full)
        if options.what == "all" or options.full:
            sanitized, sanitized_alone = plan.sanitized_plan(options.full)
            together["checks"] = [*CHECKS, *sanitized]
            alone["native"] += sanitized_alone
    if options.what in ("all", "addon"):
        hosts = [host for host in options.hosts.split(",") if host]
        lanes = plan.hosts_plan(hosts, plan.test_files(options.files), options.full)
        for host in [host for host in lanes if is_missing(host)]:
            del lanes[host]
            note = f"{host} is skipped: no Python 3.13 was found (tools/setup/setup bpy)"
            report.add(Result(host, skipped=1, notes=[note]))
        shared, separate = plan.split_alone(lanes)
        together |= shared
        alone |= separate
    Pool(together, report, environment).run(options.jobs)
    Pool(alone, report, environment).run(1)
    return 0 if report.finish() else 1


if __name__ == "__main__":
    sys.exit(main())
