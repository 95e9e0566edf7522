"""Measures flicker of animations against CPU time: modes frame by frame, modes over windows of frames, and Cycles.

    animation.py [--scenes a,b] [--modes path,temporal-l2] [--size 320x180] [--frames 24] [--blur] [--minutes 60]
                 [--references-only]

Every run renders the whole range of frames in one job, as `blender -b -a` does, and is appended to
out/bench/results/animations.jsonl with its commit and Blender. A run that is there already is not repeated. Each engine
is compared with its own converged frames, which are cached (animation_references.py). Strips of the project's own
scenes are stored, too (animation_strips.py). The report is made by report.py.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import animation_strips
import hosts
import numpy as np
import records
import temporal_metrics
from animation_modes import MODES, REFERENCES
from animation_references import Reference, reference, vectors
from animation_renderer import AnimationRenderer
from animation_scenes import ANIMATIONS, Animation, select
from animation_variants import SHUTTER, USUAL, Variant, of_row
from runs import bench_each, names_of, parser_of, powers_of_two
from version import conditions

RESULTS = records.file_of("animations")


@dataclass(frozen=True)
class Job:
    seed: int
    samples: int
    mode: str


def jobs_of(arguments: argparse.Namespace) -> list[Job]:
    """Returns all jobs of an animation. A seed runs through all counts and modes before the next seed begins."""
    return [
        Job(seed, samples, mode)
        for seed in range(arguments.seeds)
        for samples in arguments.samples
        for mode in arguments.modes
    ]


def variant_of(arguments: argparse.Namespace) -> Variant:
    return Variant(arguments.size, arguments.frames, SHUTTER if arguments.blur else 0.0)


def done_jobs(animation: Animation, variant: Variant, version: str) -> set[Job]:
    wanted = (animation.name, list(animation.frames), variant, version, hosts.peer())
    rows = records.read(RESULTS)
    rows = [r for r in rows if (r["scene"], r["frames"], of_row(r), r["version"], r["blender"]) == wanted]
    return {Job(r["seed"], r["samples"], r["mode"]) for r in rows}


class AnimationBench:
    """One animation in one variant, with its process and references."""

    def __init__(self, animation: Animation, arguments: argparse.Namespace, version: str) -> None:
        self.animation, self.samples, self.version = animation, arguments.reference, version
        self.variant = variant_of(arguments)
        self.renderer = AnimationRenderer(animation, self.variant)
        self._references: dict[str, Reference] = {}

    def works(self, mode: str) -> bool:
        if why := self.renderer.refusal(mode):
            print(f"SKIP {mode} in {self.animation.name}: {why}", flush=True)
        return not why

    def reference(self, mode: str) -> Reference:
        """Returns the converged frames of the engine of a mode."""
        engine = REFERENCES[MODES[mode].engine]
        if engine not in self._references:
            self._references[engine] = reference(self.renderer, engine, self.samples)
        return self._references[engine]

    def run(self, job: Job) -> None:
        images, answer = self.renderer.render(job.mode, job.samples, job.seed)
        row = {"scene": self.animation.name, "frames": self.animation.frames, "mode": job.mode}
        row |= {"samples": job.samples, "seed": job.seed} | conditions(self.version)
        records.append(row | self.variant.row() | answer | self._measures(job.mode, images), RESULTS)
        if animation_strips.wanted(self.animation, self.variant, job.mode, job.samples, job.seed):
            animation_strips.store(self.animation, job.mode, images, self.reference(job.mode).mean)
        print(
            f"{self.animation.name:18} {job.mode:27} {job.samples:5} spp seed {job.seed}: {answer['cpu']:8.2f} CPU-s",
            flush=True,
        )

    def _measures(self, mode: str, images: np.ndarray) -> dict[str, Any]:
        converged = self.reference(mode)
        found = temporal_metrics.all_measures(images, converged.mean, converged.variance, vectors(self.renderer))
        if self.animation.goes_off is not None:
            off = self.animation.goes_off - self.animation.frames[0]
            found["shares_of_light"] = temporal_metrics.shares_of_a_light(images, converged.mean, off)
        return found | {"reference_samples": converged.samples}


def bench_animation(animation: Animation, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    done = done_jobs(animation, variant_of(arguments), version)
    jobs = [job for job in jobs_of(arguments) if job not in done]
    if not jobs:
        return
    bench = AnimationBench(animation, arguments, version)
    try:
        modes = {mode for mode in dict.fromkeys(job.mode for job in jobs) if bench.works(mode)}
        for mode in modes:
            bench.reference(mode)
        for job in jobs:
            if arguments.references_only or time.monotonic() > deadline:
                return
            if job.mode in modes:
                bench.run(job)
    finally:
        bench.renderer.close()


def size(text: str) -> tuple[int, int]:
    """Converts '320x180'."""
    width, _, height = text.partition("x")
    return int(width), int(height)


def several(text: str) -> int:
    """Converts a number of frames; flicker needs two."""
    if int(text) < 2:
        raise argparse.ArgumentTypeError("at least two frames are needed")
    return int(text)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument(
        "--references-only", action="store_true", help="render the references, which are not timed, and stop"
    )
    parser.add_argument("--size", type=size, default=USUAL.size, help="pixels, as 320x180")
    parser.add_argument("--frames", type=several, default=USUAL.length, help="number of frames")
    parser.add_argument("--blur", action="store_true", help="motion blur for all engines and their converged frames")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--reference", type=int, default=512, help="samples per pixel of the references")
    parser.add_argument("--samples", type=powers_of_two, default=[4, 16, 64])
    parser.add_argument("--modes", type=names_of(MODES), default=list(MODES))
    arguments = parser.parse_args()
    bench_each(select(ANIMATIONS, arguments.scenes, arguments.frames), bench_animation, arguments)


if __name__ == "__main__":
    main()
