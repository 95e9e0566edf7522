"""Renders the rows of the coverage table and writes docs/coverage.md.

    PYTHONPATH=tools python3 -m coverage [--hosts bpy45,3.4] [--rows 'ShaderNodeMath*'] [--again]

Results go to out/coverage/HOST.jsonl as they come. A run that was interrupted resumes where it stopped; --again starts
over, as a change of the rows themselves requires.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

from runner.hosts import is_missing

from . import document, host, reasons

ROOT = document.ROOT
OUT = ROOT / "out" / "coverage"


def version_of_build() -> str:
    """Returns the last commit that changed what is compared."""
    command = ["git", "-C", str(ROOT), "log", "-1", "--format=%h", "--", "native", "addon"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or "unknown"


def kept(path: Path, version: str) -> list[dict[str, Any]]:
    """Returns the stored outcomes of this version."""
    stored = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    return [outcome for outcome in stored if outcome["version"] == version]


def run(name: str, rows: str, again: bool) -> None:
    """Renders the rows of a host and puts their verdicts into the document. All rows replace what it had."""
    OUT.mkdir(parents=True, exist_ok=True)
    path, version = OUT / f"{name}.jsonl", version_of_build()
    found = [] if again else kept(path, version)
    done = {outcome["name"] for outcome in found}
    start, counts = time.monotonic(), Counter()
    with path.open("a") as stored:
        for outcome in host.outcomes(name, rows, done, OUT / f"{name}.log"):
            if "rows" in outcome:
                print(f"{name}: {outcome['rows']} rows to render", flush=True)
                continue
            found.append(outcome)
            counts[outcome["verdict"]] += 1
            stored.write(json.dumps(outcome | {"version": version}) + "\n")
            stored.flush()
            if outcome["verdict"] not in document.AGREEMENT | {"falls back"}:
                print(f"  {outcome['verdict']}: {outcome['name']}: {outcome['note']}", flush=True)
    table = document.read()
    if rows == "*":
        table.forget(name)
    for outcome in found:
        table.put(name, reasons.explained(outcome))
    document.write(table)
    listed = ", ".join(f"{count} {verdict}" for verdict, count in counts.most_common())
    print(f"{name}: {listed}; {time.monotonic() - start:.0f} s", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hosts", default=",".join(document.HOSTS), help="default: all that are installed")
    parser.add_argument("--rows", default="*", help="a pattern of names, as in a shell")
    parser.add_argument("--again", action="store_true", help="render rows that were rendered before, too")
    options = parser.parse_args()
    for name in options.hosts.split(","):
        if name not in document.HOSTS:
            parser.error(f"unknown host {name}: there are {', '.join(document.HOSTS)}")
        if is_missing(name):
            print(f"{name} is skipped: no Python 3.13 was found", file=sys.stderr)
            continue
        run(name, options.rows, options.again)
    return 0


if __name__ == "__main__":
    sys.exit(main())
