"""Measures error against CPU time of stills: Gradus' modes, Cycles and Mitsuba on the same scenes.

    stills.py [--scenes a,b] [--modes path,auto] [--minutes 60] [--quick] [--references-only]

Each scene also has a few runs with four bounces, for the CPU time of a sample alone; their error is not measured. Every
run is appended to out/bench/results/stills.jsonl with the commit and the Blender that it was made with. A run that is
there already is not repeated, so that an interrupted benchmark goes on. References and sums over seeds are cached in
the user's cache folder. The report is made by report.py.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import hosts
import numpy as np
import records
from agreement import SHARE, share_and_ratio
from metrics import all_errors, relative_to
from modes import ESTIMATES_ERROR, MITSUBA, MODES, REFERENCES, WITHOUT_ERRORS
from references import reference
from renderers import Renderers
from results import STILLS
from runs import bench_each, names_of, parser_of, powers_of_two, works
from scenes import QUICK, Scene, select
from seeds import SeedSum
from version import conditions

ERROR_MODES = [name for name in MODES if name not in WITHOUT_ERRORS]
SPEED_MODES = ("path", "gradient-none", "cycles")
SPEED_SAMPLES, SPEED_BOUNCES = (4, 32), 4


@dataclass(frozen=True)
class Job:
    seed: int
    samples: int
    mode: str
    bounces: int | None = None  # replaces all bounce limits of the file


def jobs_of(arguments: argparse.Namespace) -> list[Job]:
    """Returns all jobs of a scene. A seed runs through all counts and modes before the next seed begins."""
    jobs = []
    for seed in range(arguments.seeds):
        jobs += [Job(seed, samples, mode) for samples in arguments.samples for mode in arguments.modes]
        jobs += [Job(seed, samples, mode, SPEED_BOUNCES) for samples in SPEED_SAMPLES for mode in SPEED_MODES]
    return jobs


def done_jobs(scene: Scene, width: int, version: str) -> set[Job]:
    wanted = (scene.name, width, version, hosts.peer())
    rows = [r for r in records.read(STILLS) if (r["scene"], r["width"], r["version"], r["blender"]) == wanted]
    return {Job(r["seed"], r["samples"], r["mode"], r.get("bounces")) for r in rows}


class SceneBench:
    """One scene at one size, with its processes and references."""

    def __init__(self, scene: Scene, arguments: argparse.Namespace, version: str) -> None:
        self.scene, self.arguments, self.version = scene, arguments, version
        self.size = (arguments.width, arguments.width * 9 // 16)
        self.renderers = Renderers(scene, self.size)
        self._references: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def works(self, mode: str) -> bool:
        return works(self.renderers, mode, self.scene.name)

    def is_comparable(self, mode: str) -> bool:
        """Returns whether the engine of a mode renders the same picture.

        Mitsuba gets a translation of the scene, which may differ.
        """
        if MODES[mode].engine != MITSUBA:
            return True
        share, _ = share_and_ratio(self.reference("path"), self.reference(mode))
        if share < SHARE:
            percent = f"{100 * share:.0f} %"
            print(f"SKIP {mode} in {self.scene.name}: only {percent} of its blocks agree with Gradus", flush=True)
        return share >= SHARE

    def reference(self, mode: str) -> tuple[np.ndarray, np.ndarray]:
        """Returns the converged image of the engine of a mode and the variance of its mean."""
        engine = REFERENCES[MODES[mode].engine]
        if engine not in self._references:
            samples = self.arguments.reference
            self._references[engine] = reference(self.renderers, self.scene, engine, self.size, samples, self.version)
        return self._references[engine]

    def run(self, job: Job) -> None:
        image, answer = self.renderers.render(job.mode, job.samples, job.seed, job.bounces)
        row: dict[str, Any] = {"scene": self.scene.name, "mode": job.mode, "samples": job.samples, "seed": job.seed}
        row |= {"width": self.size[0], "height": self.size[1], "cpu": answer["cpu"], "wall": answer["wall"]}
        row |= conditions(self.version)
        if job.bounces is not None:
            row["bounces"] = job.bounces
        else:
            row |= self._errors(job, image)
        if job.seed == 0:  # ray counts and memory hardly differ between seeds
            row |= {"peak_memory_bytes": answer["peak_memory_bytes"]} | answer.get("stats", {})
            if job.bounces is None and job.mode in ESTIMATES_ERROR:
                row["estimated"] = self._estimated_error(job)
        records.append(row, STILLS)
        print(
            f"{self.scene.name:18} {job.mode:20} {job.samples:5} spp seed {job.seed}: {row['cpu']:8.2f} CPU-s",
            flush=True,
        )

    def _estimated_error(self, job: Job) -> float:
        """Returns relMSE as the pass Error estimates it."""
        error = self.renderers.estimated_error(job.mode, job.samples, job.seed)
        return float((error / relative_to(self.reference(job.mode)[0])).mean())

    def _errors(self, job: Job, image: np.ndarray) -> dict[str, Any]:
        mean, variance = self.reference(job.mode)
        parts = (self.scene.name, job.mode, job.samples, f"{self.size[0]}x{self.size[1]}", self.arguments.reference)
        sums = SeedSum("-".join(map(str, (*parts, self.version, hosts.peer()))))
        sums.add(job.seed, image)
        found = all_errors(image, mean, variance) | sums.errors(mean, variance)
        return found | {"reference_samples": self.arguments.reference}


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


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument(
        "--references-only", action="store_true", help="render the references, which are not timed, and stop"
    )
    parser.add_argument("--quick", action="store_true", help="two scenes in under five minutes")
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--reference", type=int, default=1024, help="samples per pixel of the references")
    parser.add_argument("--samples", type=powers_of_two, default=[4, 16, 64])
    parser.add_argument("--modes", type=names_of(ERROR_MODES), default=ERROR_MODES)
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.scenes = arguments.scenes or ",".join(QUICK)
        arguments.width, arguments.reference, arguments.samples, arguments.seeds = 160, 1024, [4, 16], 3
    bench_each(select(arguments.scenes), bench_scene, arguments)


if __name__ == "__main__":
    main()
