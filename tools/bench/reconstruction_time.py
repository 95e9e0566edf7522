"""Measures the CPU time of the reconstructions at 1920×1080: the room of 1 k triangles with a few samples, several
times each.

    reconstruction_time.py [--repeats 3]

Appends what the library says that its solver took (`cpu_seconds.reconstruct` of the stats) to
out/bench/results/reconstructions.jsonl.
"""

from __future__ import annotations

import argparse

import records
from renderers import RefusedError, blender_worker
from version import conditions, version_of_build

RESULTS = records.file_of("reconstructions")
MODES = ("gradient-l2", "gradient-l1", "path-regularized", "gradient-regularized")
SIZE = (1920, 1080)
SAMPLES = 2


def newest() -> list[records.Row]:
    """Returns the runs of the commit and Blender that were measured last."""
    return records.like_last(records.read(RESULTS), ("version", "blender"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    worker = blender_worker("speed_worker.py", "room-1k", *SIZE)
    try:
        worker.answer()  # the size of the room
        for repeat in range(arguments.repeats):
            for mode in MODES:
                try:
                    answer = worker.ask({"mode": mode, "samples": SAMPLES, "seed": repeat})
                except RefusedError as error:
                    print(f"SKIP {mode}: {error}")
                    continue
                row = {
                    "mode": mode,
                    "repeat": repeat,
                    "samples": SAMPLES,
                    "reconstruct": answer["stages"]["reconstruct"],
                }
                records.append(row | conditions(version_of_build()), RESULTS)
                print(f"{mode:20} {row['reconstruct']:.3f} CPU-s", flush=True)
    finally:
        worker.close()


if __name__ == "__main__":
    main()
