"""Error against CPU time: plain path tracing, gradient-domain modes, Cycles and Mitsuba on the same scenes.

    bench.py [--scenes a,b] [--modes path,auto] [--minutes 60] [--quick] [--references-only]

Besides, each scene has a few runs with four bounces, for the CPU time per sample alone (no error is measured there).
Every run is appended to docs/benchmark/results.jsonl with the version that made it, so that a benchmark can be interrupted and resumed;
what is there already for this version is not run again. References (each engine against its own converged image, variance of the
reference subtracted) and sums over seeds are cached in the user's cache folder. Report: report.py.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from agreement import SHARE, share_and_ratio
from metrics import all_errors, relative_to, shortened
from modes import ESTIMATES_ERROR, MITSUBA, MODES, REFERENCES
from references import reference
from renderers import RefusedError, Renderers
from scenes import QUICK, ROOT, Scene, select
from seeds import SeedSum
from version import cpu_name, version_of_build

RESULTS = ROOT / "docs" / "benchmark" / "results.jsonl"
ERROR_MODES = [name for name in MODES if name != "gradient-none"]
SPEED_MODES = ("path", "gradient-none", "cycles")
SPEED_SAMPLES, SPEED_BOUNCES = (4, 32), 4


@dataclass(frozen=True)
class Job:
    seed: int
    samples: int
    mode: str
    bounces: int | None = None  # None: as the file says


def jobs_of(arguments: argparse.Namespace) -> list[Job]:
    """Interleaved: a seed runs through all counts and modes before the next one begins."""
    jobs = []
    for seed in range(arguments.seeds):
        jobs += [Job(seed, samples, mode) for samples in arguments.samples for mode in arguments.modes]
        jobs += [Job(seed, samples, mode, SPEED_BOUNCES) for samples in SPEED_SAMPLES for mode in SPEED_MODES]
    return jobs


def done_jobs(scene: Scene, width: int, version: str) -> set[Job]:
    if not RESULTS.exists():
        return set()
    rows = [json.loads(line) for line in RESULTS.read_text().splitlines()]
    rows = [r for r in rows if (r["scene"], r["width"], r["version"]) == (scene.name, width, version)]
    return {Job(r["seed"], r["samples"], r["mode"], r.get("bounces")) for r in rows}


class SceneBench:
    """One scene at one size, with its processes and references."""

    def __init__(self, scene: Scene, arguments: argparse.Namespace, version: str) -> None:
        self.scene, self.arguments, self.version = scene, arguments, version
        self.size = (arguments.width, arguments.width * 9 // 16)
        self.renderers = Renderers(scene, self.size)
        self._references: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def works(self, mode: str) -> bool:
        if why := self.renderers.refusal(mode):
            print(f"SKIP {mode} in {self.scene.name}: {why}", flush=True)
        return not why

    def is_comparable(self, mode: str) -> bool:
        """Mitsuba gets a translation of the scene: its converged image must be that of Gradus before anything is compared."""
        if MODES[mode].engine != MITSUBA:
            return True
        share, _ = share_and_ratio(self.reference("path"), self.reference(mode))
        if share < SHARE:
            print(f"SKIP {mode} in {self.scene.name}: only {100 * share:.0f} % of its blocks agree with Gradus", flush=True)
        return share >= SHARE

    def reference(self, mode: str) -> tuple[np.ndarray, np.ndarray]:
        """Of the engine of a mode."""
        engine = REFERENCES[MODES[mode].engine]
        if engine not in self._references:
            self._references[engine] = reference(self.renderers, self.scene, engine, self.size, self.arguments.reference, self.version)
        return self._references[engine]

    def run(self, job: Job) -> None:
        image, answer = self.renderers.render(job.mode, job.samples, job.seed, job.bounces)
        row: dict[str, Any] = {
            "scene": self.scene.name, "mode": job.mode, "samples": job.samples, "seed": job.seed, "width": self.size[0],
            "height": self.size[1], "cpu": answer["cpu"], "wall": answer["wall"], "version": self.version, "machine": cpu_name(),
        }  # fmt: skip
        if job.bounces is not None:
            row["bounces"] = job.bounces
        else:
            row |= self._errors(job, image)
        if job.seed == 0:  # counts hardly differ between seeds
            row |= {"peak_memory_bytes": answer["peak_memory_bytes"]} | answer.get("stats", {})
            if job.bounces is None and job.mode in ESTIMATES_ERROR:
                row["estimated"] = self._estimated_error(job)
        append(row, RESULTS)
        print(f"{self.scene.name:18} {job.mode:17} {job.samples:5} spp seed {job.seed}: {row['cpu']:8.2f} CPU-s", flush=True)

    def _estimated_error(self, job: Job) -> float:
        """relMSE as the pass Error has it."""
        error = self.renderers.estimated_error(job.mode, job.samples, job.seed)
        return float((error / relative_to(self.reference(job.mode)[0])).mean())

    def _errors(self, job: Job, image: np.ndarray) -> dict[str, Any]:
        mean, variance = self.reference(job.mode)
        key = f"{self.scene.name}-{job.mode}-{job.samples}-{self.size[0]}x{self.size[1]}-{self.arguments.reference}-{self.version}"
        sums = SeedSum(key)
        sums.add(job.seed, image)
        return {
            **all_errors(image, mean, variance), **sums.errors(mean, variance), "reference_samples": self.arguments.reference,
        }  # fmt: skip


def bench_scene(scene: Scene, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    done = done_jobs(scene, arguments.width, version)
    jobs = [job for job in jobs_of(arguments) if job not in done]
    if not jobs:
        return
    bench = SceneBench(scene, arguments, version)
    try:
        modes = {mode for mode in dict.fromkeys(job.mode for job in jobs) if bench.works(mode)}
        for mode in modes & set(arguments.modes):
            bench.reference(mode)
        modes = {mode for mode in modes if bench.is_comparable(mode)}
        if arguments.references_only:
            return
        for job in jobs:
            if time.monotonic() > deadline:
                return
            if job.mode in modes:
                bench.run(job)
    finally:
        bench.renderers.close()


def append(row: dict[str, Any], results: Path) -> None:
    with results.open("a") as file:
        file.write(json.dumps(shortened(row), separators=(",", ":")) + "\n")


def names(text: str) -> list[str]:
    if unknown := set(text.split(",")) - set(MODES):
        raise argparse.ArgumentTypeError(f"unknown modes {', '.join(sorted(unknown))}; there are {', '.join(ERROR_MODES)}")
    return text.split(",")


def powers_of_two(text: str) -> list[int]:
    counts = [int(part) for part in text.split(",")]
    if any(count < 1 or count & (count - 1) for count in counts):
        raise argparse.ArgumentTypeError("sample counts are powers of two, for which the sequences are made")
    return counts


def bench_each(scenes: list[Any], bench_one: Callable[[Any, argparse.Namespace, str, float], None], arguments: argparse.Namespace) -> None:
    """One after the other, until the time is up; one that fails does not end the others."""
    version, deadline = version_of_build(), time.monotonic() + 60.0 * arguments.minutes
    for scene in scenes:
        try:
            bench_one(scene, arguments, version, deadline)
        except (RuntimeError, RefusedError) as error:
            print(f"FAILED {scene.name}: {error}", flush=True)
        if time.monotonic() > deadline:
            print("time is up; run again to go on")
            break


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--minutes", type=float, default=600.0)
    parser.add_argument("--references-only", action="store_true", help="compute what is not timed, and stop")
    parser.add_argument("--quick", action="store_true", help="two scenes in under five minutes")
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--reference", type=int, default=4096, help="samples per pixel of the references")
    parser.add_argument("--samples", type=powers_of_two, default=[4, 16, 64])
    parser.add_argument("--modes", type=names, default=ERROR_MODES)
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.scenes = arguments.scenes or ",".join(QUICK)
        arguments.width, arguments.reference, arguments.samples, arguments.seeds = 160, 1024, [4, 16], 3
    Path(RESULTS).parent.mkdir(parents=True, exist_ok=True)
    bench_each(select(arguments.scenes), bench_scene, arguments)


if __name__ == "__main__":
    main()
