"""Measures the CPU time of a sample in a room (room.py): Gradus against Cycles, and gradients against plain paths.

    speed.py [--rooms room-1k,room-2m] [--width 1280] [--repeats 3] [--minutes 60] [--starts]

The measure is the slope of the process's CPU time between 4 and 16 samples, so that export and build drop out. Modes
take turns, repeat by repeat; ratios are taken within a repeat. Every render is appended to
out/bench/results/speed.jsonl; one that is there is not repeated.

With --starts it measures what comes before the first sample instead: the CPU time of one sample of a tiny picture, in a
new process for each render. These renders are appended to out/bench/results/start.jsonl.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, field

import numpy as np
import records
from document import spread
from records import Row
from renderers import RefusedError, Worker, blender_worker
from rooms import ROOMS
from runs import names_of
from version import conditions, version_of_build

RESULTS = records.file_of("speed")
STARTS = records.file_of("start")
START_MODES = ("path", "cycles")
START_SIZE = (64, 36)
SAMPLES = (4, 16)
IDENTITY = ("room", "width", "version", "blender", "mode", "samples", "repeat")  # columns that identify a run
Spread = tuple[float, float, float]  # median, minimum, maximum


def load() -> list[Row]:
    return records.read(RESULTS)


def jobs_of(room: str, width: int, repeats: int) -> list[Row]:
    """Returns the runs that are not stored yet."""
    done = {tuple(row[name] for name in IDENTITY) for row in load()}
    fixed = {"room": room, "width": width} | conditions(version_of_build())
    jobs = [
        fixed | {"mode": mode, "samples": samples, "repeat": repeat}
        for repeat in range(repeats)
        for samples in SAMPLES
        for mode in ROOMS[room].modes
    ]
    return [job for job in jobs if tuple(job[name] for name in IDENTITY) not in done]


def measure(room: str, width: int, repeats: int, deadline: float) -> None:
    jobs = jobs_of(room, width, repeats)
    if not jobs:
        return
    height = width * 9 // 16
    worker = blender_worker("speed_worker.py", room, width, height)
    try:
        facts = worker.answer() | {"height": height}
        modes = [mode for mode in dict.fromkeys(job["mode"] for job in jobs) if works(worker, mode)]
        for job in (job for job in jobs if job["mode"] in modes):
            if time.monotonic() > deadline:
                return
            answer = worker.ask({"mode": job["mode"], "samples": job["samples"], "seed": job["repeat"]})
            records.append(job | facts | answer, RESULTS)
            print(f"{room:12} {job['mode']:14} {job['samples']:3} spp {answer['cpu']:8.2f} CPU-s", flush=True)
    finally:
        worker.close()


def measure_start(room: str, repeats: int) -> None:
    """Measures the start-up of each engine and prints the medians and their ratio."""
    fixed = {"room": room} | conditions(version_of_build())
    for repeat in range(repeats):
        for mode in START_MODES:
            worker = blender_worker("speed_worker.py", room, *START_SIZE)
            try:
                facts = worker.answer()
                answer = worker.ask({"mode": mode, "samples": 1, "seed": repeat})
            finally:
                worker.close()
            records.append(fixed | facts | {"mode": mode, "repeat": repeat} | answer, STARTS)
    found = starts(room)
    ours, theirs = (float(np.median(list(found[mode].values()))) for mode in START_MODES)
    over = spread(ratio(found[START_MODES[0]], found[START_MODES[1]]))
    print(f"{room:12} start-up {ours:.2f} CPU-s, Cycles {theirs:.2f} CPU-s, ratio {over}", flush=True)


def starts(room: str) -> dict[str, dict[int, float]]:
    """Returns the CPU seconds of start-ups by mode and repeat, of the commit and Blender that were measured last."""
    rows = [row for row in records.read(STARTS) if row["room"] == room]
    newest = records.like_last(rows, ("version", "blender"))
    return {mode: {row["repeat"]: row["cpu"] for row in newest if row["mode"] == mode} for mode in START_MODES}


def works(worker: Worker, mode: str) -> bool:
    """Renders one sample, which also loads libraries and is not counted."""
    try:
        worker.ask({"mode": mode, "samples": 1, "seed": 999})
    except RefusedError as error:
        print(f"SKIP {mode}: {error}", flush=True)
        return False
    return True


@dataclass
class Cost:
    """The cost of one mode in one room, by repeat where it is a time."""

    per_sample: dict[int, float] = field(default_factory=dict)  # CPU microseconds
    total: dict[int, float] = field(default_factory=dict)  # CPU seconds of a whole render with the larger count
    rays: dict[str, float] = field(default_factory=dict)  # per sample
    peak_memory_bytes: int = 0

    def median(self) -> float | None:
        return float(np.median(list(self.per_sample.values()))) if self.per_sample else None

    def over(self, other: Cost) -> Spread | None:
        return ratio(self.per_sample, other.per_sample)

    def total_over(self, other: Cost) -> Spread | None:
        return ratio(self.total, other.total)


def ratio(ours: dict[int, float], theirs: dict[int, float]) -> Spread | None:
    """Returns median, minimum and maximum of the ratios within each repeat."""
    found = [ours[repeat] / theirs[repeat] for repeat in ours.keys() & theirs.keys()]
    return (float(np.median(found)), min(found), max(found)) if found else None


def costs(rows: list[Row]) -> dict[str, dict[str, Cost]]:
    """Returns the costs by room and mode, from the commit, Blender and size that each room was measured with last."""
    newest = {row["room"]: _conditions(row) for row in rows}
    rows = [row for row in rows if newest[row["room"]] == _conditions(row)]
    low = {(r["room"], r["mode"], r["repeat"]): r for r in rows if r["samples"] == SAMPLES[0]}
    table: dict[str, dict[str, Cost]] = {}
    for row in (r for r in rows if r["samples"] == SAMPLES[-1]):
        first = low.get((row["room"], row["mode"], row["repeat"]))
        if first is None:
            continue
        count = row["width"] * row["height"] * (SAMPLES[-1] - SAMPLES[0])
        cost = table.setdefault(row["room"], {}).setdefault(row["mode"], Cost())
        cost.per_sample[row["repeat"]] = 1e6 * (row["cpu"] - first["cpu"]) / count
        cost.total[row["repeat"]] = row["cpu"]
        cost.rays = {kind: (n - first["rays"][kind]) / count for kind, n in row.get("rays", {}).items()}
        cost.peak_memory_bytes = max(cost.peak_memory_bytes, row["peak_memory_bytes"])
    return table


def _conditions(row: Row) -> tuple[str, str, int]:
    return row["version"], row["blender"], row["width"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=names_of(ROOMS), default=list(ROOMS))
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--minutes", type=float, default=600.0)
    parser.add_argument("--starts", action="store_true", help="measure start-up instead")
    arguments = parser.parse_args()
    if arguments.starts:
        for room in (name for name in arguments.rooms if set(START_MODES) <= set(ROOMS[name].modes)):
            measure_start(room, arguments.repeats)
        return
    deadline = time.monotonic() + 60.0 * arguments.minutes
    for room in arguments.rooms:
        measure(room, arguments.width, arguments.repeats, deadline)


if __name__ == "__main__":
    main()
