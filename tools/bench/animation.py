"""Measures error and flicker of animations against CPU time: frames one by one, frames joined, and Cycles.

    animation.py [--scenes a,b] [--modes path,temporal-auto] [--size 640x360] [--frames 24] [--blur] [--minutes 60]
                 [--quick] [--references-only]

Every run renders the whole range of frames in one job, as `blender -b -a` does, and is appended to
out/bench/results/animations.jsonl with its commit and Blender. A run that is there already is not repeated. From the
second seed on, a run is compared with the frames of the seed before, which gives the noise; its bias is that of a few
frames in the middle against the engine's own converged frames, which are cached (animation_references.py). Strips of
the project's own scenes are stored, too (animation_strips.py). The report is made by report.py.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import animation_strips
import hosts
import metrics
import numpy as np
import records
import seeds
import temporal_metrics
from animation_modes import MODES, REFERENCES
from animation_modes import QUICK as QUICK_MODES
from animation_references import Reference, file_of, level, reference
from animation_renderer import AnimationRenderer
from animation_scenes import ANIMATIONS, QUICK, Animation, select
from animation_variants import SHUTTER, USUAL, Variant, of_row
from runs import bench_each, names_of, parser_of, powers_of_two, works
from version import conditions

RESULTS = records.file_of("animations")
FLIP_SAMPLES = 256  # of converged frames, from which HDR-FLIP is that of the picture and not of their noise


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
        if not arguments.quick or samples in QUICK_MODES[mode]
    ]


def variant_of(arguments: argparse.Namespace) -> Variant:
    return Variant(arguments.size, arguments.frames, SHUTTER if arguments.blur else 0.0)


def done_jobs(animation: Animation, arguments: argparse.Namespace, version: str) -> set[Job]:
    checked = list(animation.middle(arguments.checked))
    wanted = (animation.name, list(animation.frames), checked, variant_of(arguments), version, hosts.peer())
    rows = [row for row in records.read(RESULTS) if "checked" in row]  # earlier ones have other measures
    columns = ("scene", "frames", "checked")
    rows = [r for r in rows if (*(r[name] for name in columns), of_row(r), r["version"], r["blender"]) == wanted]
    return {Job(r["seed"], r["samples"], r["mode"]) for r in rows}


class AnimationBench:
    """One animation in one variant, with its process and references."""

    def __init__(self, animation: Animation, arguments: argparse.Namespace, version: str) -> None:
        self.animation, self.arguments, self.version = animation, arguments, version
        self.variant = variant_of(arguments)
        self.checked = animation.middle(arguments.checked)
        self.renderer = AnimationRenderer(animation, self.variant)
        self._references: dict[str, Reference] = {}
        self._level: np.ndarray | None = None

    def works(self, mode: str) -> bool:
        return works(self.renderer, mode, self.animation.name)

    def level(self) -> np.ndarray:
        if self._level is None:
            self._level = level(self.renderer)
        return self._level

    def reference(self, mode: str) -> Reference:
        """Returns the converged frames of the engine of a mode."""
        engine = REFERENCES[MODES[mode].engine]
        if engine not in self._references:
            self._references[engine] = reference(self.renderer, engine, self.arguments.reference, self.checked)
        return self._references[engine]

    def run(self, job: Job) -> None:
        images, answer = self.renderer.render(job.mode, job.samples, job.seed)
        row = {"scene": self.animation.name, "frames": self.animation.frames, "mode": job.mode}
        row |= {"samples": job.samples, "seed": job.seed} | conditions(self.version)
        row |= self.variant.row() | answer | self._measures(job.mode, images)
        if job.seed > 0:
            row |= self._measures_of_seeds(job.mode, self._frames_before(job), images)
        self._keep(job, images)
        records.append(row, RESULTS)
        if animation_strips.wanted(self.animation, self.variant, job.mode, job.samples, job.seed):
            animation_strips.store(self.animation, job.mode, images, self.reference(job.mode).mean, self._slice())
        print(
            f"{self.animation.name:18} {job.mode:27} {job.samples:5} spp seed {job.seed}: {answer['cpu']:8.2f} CPU-s",
            flush=True,
        )

    def _measures(self, mode: str, images: np.ndarray) -> dict[str, Any]:
        """Returns what the frames of one seed show."""
        converged, shown = self.reference(mode), images[self._slice()]
        found: dict[str, Any] = {"reference_samples": converged.samples, "checked": self.checked}
        found["mean_light"] = temporal_metrics.mean_light(shown, converged.halves)
        if converged.samples >= FLIP_SAMPLES:
            pairs = zip(shown, converged.mean, strict=True)
            found["flip"] = float(np.mean([metrics.flip(image, mean) for image, mean in pairs]))
        if self.animation.changes is not None:
            change = self.animation.changes - self.checked[0]
            found["shares_of_light"] = temporal_metrics.shares_of_old_light(shown, converged.halves, change)
        return found

    def _measures_of_seeds(self, mode: str, before: np.ndarray, images: np.ndarray) -> dict[str, float]:
        """Returns what two seeds tell together."""
        halves, checked, pair = self.reference(mode).halves, self._slice(), (before, images)
        found = temporal_metrics.error_measures(pair, halves, self.level(), checked)
        if self.animation.has_shadow:
            wake = temporal_metrics.wake(self.level())[checked]
            shown = (before[checked], images[checked])
            found["relmse_wake"] = temporal_metrics.error_in(wake, shown, halves, self.level()[checked])
        return found

    def _slice(self) -> slice:
        """Returns the frames of a run that converged frames show."""
        first, last = self.checked
        return slice(first - self.animation.frames[0], last - self.animation.frames[0] + 1)

    def _frames_before(self, job: Job) -> np.ndarray:
        """Returns the frames of the seed before, which are rendered again if they are no longer kept."""
        file = self._kept(replace(job, seed=job.seed - 1))
        if not file.exists():
            return self.renderer.render(job.mode, job.samples, job.seed - 1)[0]
        images = np.load(file).astype(np.float64)
        file.unlink()
        return images

    def _keep(self, job: Job, images: np.ndarray) -> None:
        """Keeps the frames for the next seed, if there is one."""
        if job.seed + 1 < self.arguments.seeds:
            file = self._kept(job)
            file.parent.mkdir(parents=True, exist_ok=True)
            np.save(file, images.astype(np.float32))

    def _kept(self, job: Job) -> Path:
        name = file_of(self.renderer, f"{job.mode}-{job.samples}-{job.seed}-{self.version}-{hosts.peer()}").stem
        return seeds.CACHE / f"{name}.npy"


def bench_animation(animation: Animation, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    done = done_jobs(animation, arguments, version)
    jobs = [job for job in jobs_of(arguments) if job not in done]
    if not jobs:
        return
    bench = AnimationBench(animation, arguments, version)
    try:
        modes = {mode for mode in dict.fromkeys(job.mode for job in jobs) if bench.works(mode)}
        for mode in modes:
            bench.reference(mode)
        bench.level()
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
    parser.add_argument("--quick", action="store_true", help="two animations of 9 frames in under 30 minutes")
    parser.add_argument("--size", type=size, default=USUAL.size, help="pixels, as 320x180")
    parser.add_argument("--frames", type=several, default=USUAL.length, help="number of frames")
    parser.add_argument("--blur", action="store_true", help="motion blur for all engines and their converged frames")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--reference", type=int, default=512, help="samples per pixel of the references")
    parser.add_argument("--checked", type=several, default=8, help="number of frames of the references")
    parser.add_argument("--samples", type=powers_of_two, default=[4, 8, 32])
    parser.add_argument("--modes", type=names_of(MODES), default=list(MODES))
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.scenes = arguments.scenes or ",".join(QUICK)
        arguments.modes, arguments.seeds = list(QUICK_MODES), 2
        arguments.samples = sorted({count for counts in QUICK_MODES.values() for count in counts})
        arguments.frames, arguments.checked, arguments.reference = 9, 3, 256
    bench_each(select(ANIMATIONS, arguments.scenes, arguments.frames), bench_animation, arguments)


if __name__ == "__main__":
    main()
