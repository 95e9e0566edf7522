"""CPU time of a sample in the room (room.py): Gradus against Cycles, and gradients against plain path tracing.

    speed.py [--rooms room-1k,room-2m] [--width 1280] [--repeats 3] [--modes path,cycles] [--minutes 60]

The measure is the slope of the process's CPU time between 4 and 16 samples of four bounces, so that export and build drop out. All modes
and both hosts take turns, repeat by repeat; what counts are the ratios inside one repeat. Every render is appended to
docs/benchmark/speed.jsonl; what is there for this version is not run again. The table: speed_report.py.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rooms import ROOMS
from scenes import ROOT
from version import cpu_name, version_of_build

RESULTS = ROOT / "docs" / "benchmark" / "speed.jsonl"
WORKER = str(Path(__file__).with_name("speed_worker.py"))
SAMPLES = (4, 16)
Spread = tuple[float, float, float]
HOSTS = {
    "4.5": [str(ROOT / ".venv/bpy45/bin/python3"), WORKER],
    "3.4": [os.environ.get("BLENDER") or "blender", "-b", "--factory-startup", "-noaudio", "--python", WORKER],
}


class Host:
    """One Blender with the room in it."""

    def __init__(self, command: list[str], room: str, size: tuple[int, int]) -> None:
        self._process = subprocess.Popen(
            [*command, "--", room, *map(str, size)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self.facts = self._answer()

    def _answer(self) -> dict:
        assert self._process.stdout
        for line in self._process.stdout:
            if line.startswith("RESULT "):
                return json.loads(line[7:])
        raise RuntimeError(f"Blender ended with code {self._process.wait()}")

    def render(self, mode: str, samples: int, seed: int) -> dict:
        assert self._process.stdin
        self._process.stdin.write(json.dumps({"mode": mode, "samples": samples, "seed": seed}) + "\n")
        self._process.stdin.flush()
        return self._answer()

    def close(self) -> None:
        if self._process.stdin:
            self._process.stdin.close()
        self._process.wait(timeout=60)


def load() -> list[dict]:
    return [json.loads(line) for line in RESULTS.read_text().splitlines()] if RESULTS.exists() else []


def measure(room: str, arguments: argparse.Namespace, deadline: float) -> None:
    size = (arguments.width, arguments.width * 9 // 16)
    version = version_of_build()
    identity = ("room", "width", "version", "mode", "host", "samples", "repeat")
    done = {tuple(row[k] for k in identity) for row in load()}
    turns = [turn for turn in ROOMS[room].turns if not arguments.modes or turn[0] in arguments.modes]
    jobs = [
        {"room": room, "width": size[0], "version": version, "mode": mode, "host": host, "samples": samples, "repeat": repeat}
        for repeat in range(arguments.repeats)
        for samples in SAMPLES
        for mode, host in turns
    ]
    jobs = [job for job in jobs if tuple(job[k] for k in identity) not in done]
    hosts = {name: Host(HOSTS[name], room, size) for name in sorted({job["host"] for job in jobs})}
    try:
        for mode, host in sorted({(job["mode"], job["host"]) for job in jobs}):  # not counted: first use loads libraries
            hosts[host].render(mode, 1, 999)
        for job in jobs:
            if time.monotonic() > deadline:
                return
            answer = hosts[job["host"]].render(job["mode"], job["samples"], job["repeat"])
            if "error" in answer:
                print(f"SKIP {job['mode']} in Blender {job['host']}: {answer['error']}", flush=True)
                continue
            row = job | {"height": size[1], "triangles": hosts[job["host"]].facts["triangles"], "machine": cpu_name()} | answer
            with RESULTS.open("a") as file:
                file.write(json.dumps(row) + "\n")
            print(f"{room:10} {job['mode']:14} {job['host']} {job['samples']:3} spp {row['cpu']:8.2f} CPU-s", flush=True)
    finally:
        for host in hosts.values():
            host.close()


@dataclass
class Cost:
    """CPU microseconds per sample of one mode in one room, one figure per repeat, and what is counted besides."""

    per_sample: dict[int, float] = field(default_factory=dict)
    total: dict[int, float] = field(default_factory=dict)  # CPU seconds of the larger count, export, build and what AUTO tries included
    rays: dict[str, float] = field(default_factory=dict)  # per sample
    peak_memory_bytes: int = 0

    def median(self) -> float | None:
        return float(np.median(list(self.per_sample.values()))) if self.per_sample else None

    def over(self, other: Cost) -> Spread | None:
        return ratio(self.per_sample, other.per_sample)

    def total_over(self, other: Cost) -> Spread | None:
        return ratio(self.total, other.total)


def ratio(ours: dict[int, float], theirs: dict[int, float]) -> Spread | None:
    """Repeat by repeat: median, lowest, highest."""
    found = [ours[repeat] / theirs[repeat] for repeat in ours.keys() & theirs.keys()]
    return (float(np.median(found)), min(found), max(found)) if found else None


def costs(rows: list[dict]) -> dict[str, dict[tuple[str, str], Cost]]:
    """room -> (mode, host) -> cost, of the newest version and size of each room."""
    newest = {row["room"]: (row["version"], row["width"]) for row in rows}  # in order of time
    rows = [row for row in rows if newest[row["room"]] == (row["version"], row["width"])]
    table: dict[str, dict[tuple[str, str], Cost]] = {}
    low = {(r["room"], r["mode"], r["host"], r["repeat"]): r for r in rows if r["samples"] == SAMPLES[0]}
    for row in (r for r in rows if r["samples"] == SAMPLES[-1]):
        first = low.get((row["room"], row["mode"], row["host"], row["repeat"]))
        if first is None:
            continue
        count = row["width"] * row["height"] * (SAMPLES[-1] - SAMPLES[0])
        cost = table.setdefault(row["room"], {}).setdefault((row["mode"], row["host"]), Cost())
        cost.per_sample[row["repeat"]] = 1e6 * (row["cpu"] - first["cpu"]) / count
        cost.total[row["repeat"]] = row["cpu"]
        cost.rays = {kind: (n - first["rays"][kind]) / count for kind, n in row.get("rays", {}).items()}
        cost.peak_memory_bytes = max(cost.peak_memory_bytes, row["peak_memory_bytes"])
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=lambda t: t.split(","), default=list(ROOMS))
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--modes", type=lambda t: t.split(","), default=[])
    parser.add_argument("--minutes", type=float, default=600.0)
    arguments = parser.parse_args()
    deadline = time.monotonic() + 60.0 * arguments.minutes
    for room in arguments.rooms:
        measure(room, arguments, deadline)


if __name__ == "__main__":
    main()
