"""CPU time of the reconstructions at 1920×1080, RGB: the room of 1 k triangles with a few samples, several times each.

    solve.py [--repeats 3]

Appends to docs/benchmark/solve.jsonl what the library says its solver took (`cpu_seconds.reconstruct` of the stats).
"""

from __future__ import annotations

import argparse
import json

from scenes import ROOT
from speed import HOSTS, Host
from version import cpu_name, version_of_build

RESULTS = ROOT / "docs" / "benchmark" / "solve.jsonl"
MODES = ("gradient-l2", "gradient-weighted", "gradient-l1", "path-regularized", "gradient-regularized")
SIZE = (1920, 1080)
SAMPLES = 2


def newest() -> list[dict]:
    """The runs of the newest version."""
    rows = [json.loads(line) for line in RESULTS.read_text().splitlines()] if RESULTS.exists() else []
    return [row for row in rows if row["version"] == rows[-1]["version"]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--samples", type=int, default=SAMPLES)
    arguments = parser.parse_args()
    host = Host(HOSTS["4.5"], "room-1k", SIZE)
    try:
        for repeat in range(arguments.repeats):
            for mode in MODES:
                answer = host.render(mode, arguments.samples, repeat)
                if "error" in answer:
                    print(f"SKIP {mode}: {answer['error']}")
                    continue
                row = {"mode": mode, "repeat": repeat, "samples": arguments.samples, "reconstruct": answer["stages"]["reconstruct"]}
                row |= {"version": version_of_build(), "machine": cpu_name()}
                with RESULTS.open("a") as file:
                    file.write(json.dumps(row) + "\n")
                print(f"{mode:18} {row['reconstruct']:.3f} CPU-s", flush=True)
    finally:
        host.close()


if __name__ == "__main__":
    main()
