"""Motion of components: against the truth, as a prediction of the next frame, for what it does to flicker, and at what price.

    motion.py [--scenes a,b] [--parts truth,prediction,flicker,cost] [--size 320x180] [--frames 6] [--seeds 1] [--repeats 3] [--blur]

Every run is appended to docs/benchmark/motion.jsonl with the version that made it: an interrupted benchmark goes on. Converged frames are
those of animation_references.py, cached with their components' motion. Pictures of the project's own scenes are stored on the way
(motion_pictures.py). Motion blur is for truth and cost alone: the others need one vector for each pixel. CPU seconds are those of the
moment: on a machine with other work they say nothing. Report: report.py.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial

import motion_metrics
import motion_pictures
import numpy as np
from animation import several, size
from animation_references import file_of, reference
from animation_scenes import Animation, select
from animation_variants import SHUTTER, Variant, of_row
from bench import append, bench_each, powers_of_two
from motion_modes import DELIVERED, FLICKER, MODES, USUAL
from motion_renderer import MotionRenderer
from motion_scenes import ANIMATIONS
from results import FOLDER
from version import cpu_name

RESULTS = FOLDER / "motion.jsonl"
TRUTH, PREDICTION, FLICKERS, COST = PARTS = ("truth", "prediction", "flicker", "cost")
TIMED = (FLICKERS, COST)
BLURRED = (TRUTH, COST)  # what motion blur leaves a meaning
SIZES = {TRUTH: (320, 180), PREDICTION: (320, 180), FLICKERS: (160, 90), COST: (320, 180)}  # pixels
CHECKED = 400  # pixels of each component that are held against the truth
LIGHT, LIGHT_PARTS = 256, 4  # samples of the pictures whose change is predicted, and renderings that share them
COST_SAMPLES = 16
PICTURES = ("components", "component_reflectance", "component_irradiance")
WAYS = ("vector", "components", "component_motion", "component_irradiance_motion")
OWN_WAYS = ("components", "component_motion")
COST_MODES: dict[str, tuple[str, tuple[str, ...]]] = {
    "whole": ("whole", ()),
    "parts": ("parts", ("components",)),
    "parts-surfaces": ("parts", ("components", "component_reflectance", "component_normal")),
    "parts-motion": ("parts", ("components", "component_motion")),
}
"""Modes and the passes that are asked for: of components that nobody asks for no picture is made."""


@dataclass(frozen=True)
class Job:
    part: str
    mode: str = ""
    samples: int = 0
    seed: int = 0
    frame: int = 0  # of truth and prediction


def jobs_of(animation: Animation, arguments: argparse.Namespace, parts: list[str]) -> list[Job]:
    """Truth and prediction in the middle; flicker and cost interleaved, a seed through all modes before the next one begins."""
    middle = sum(animation.frames) // 2
    jobs = {TRUTH: [Job(TRUTH, frame=middle)], PREDICTION: [Job(PREDICTION, "parts", arguments.light, frame=middle)]}
    jobs[FLICKERS] = [
        Job(FLICKERS, mode, samples, seed) for seed in range(arguments.seeds) for samples in arguments.samples for mode in arguments.modes
    ]
    jobs[COST] = [Job(COST, mode, COST_SAMPLES, seed, middle) for seed in range(arguments.repeats) for mode in COST_MODES]
    return [job for part in parts for job in jobs[part]]


def variant_of(arguments: argparse.Namespace, part: str) -> Variant:
    return Variant(arguments.size or SIZES[part], arguments.frames, SHUTTER if arguments.blur else 0.0)


def parts_of(arguments: argparse.Namespace) -> dict[Variant, list[str]]:
    """Parts by variants; those that motion blur leaves without a meaning are named on standard output."""
    found: dict[Variant, list[str]] = {}
    for part in arguments.parts:
        if arguments.blur and part not in BLURRED:
            print(f"SKIP {part}: with motion blur a pixel has more than one vector", flush=True)
        else:
            found.setdefault(variant_of(arguments, part), []).append(part)
    return found


def done_jobs(animation: Animation, variant: Variant, version: str, loaded: bool) -> set[Job]:
    """Runs whose times say nothing are run again where they would."""
    if not RESULTS.exists():
        return set()
    wanted = (animation.name, list(animation.frames), variant, version)
    rows = [json.loads(line) for line in RESULTS.read_text().splitlines()]
    rows = [row for row in rows if (row["scene"], row["frames"], of_row(row), row["version"]) == wanted]
    rows = [row for row in rows if loaded or not row.get("loaded") or row["part"] not in TIMED]
    return {Job(*(row[name] for name in ("part", "mode", "samples", "seed", "frame"))) for row in rows}


class MotionBench:
    """One animation in one variant, with its process and references."""

    def __init__(self, animation: Animation, variant: Variant, arguments: argparse.Namespace, version: str) -> None:
        self.animation, self.samples, self.version = animation, arguments.reference, version
        self.variant, self.loaded = variant, arguments.loaded
        self.renderer = MotionRenderer(animation, self.variant)
        self._ways: np.ndarray | None = None
        self._refused: dict[str, str] = {}

    def works(self, mode: str) -> bool:
        if mode in MODES and mode not in self._refused:
            self._refused[mode] = self.renderer.refusal(mode)
            if self._refused[mode]:
                print(f"SKIP {mode} in {self.animation.name}: {self._refused[mode]}", flush=True)
        return not self._refused.get(mode)

    def run(self, job: Job) -> None:
        row = {"scene": self.animation.name, "frames": self.animation.frames, "version": self.version, "machine": cpu_name()}
        if self.loaded:
            row["loaded"] = True
        for found in {TRUTH: self._truth, PREDICTION: self._prediction, FLICKERS: self._flicker, COST: self._cost}[job.part](job):
            append(row | asdict(job) | self.variant.row() | found, RESULTS)
        print(f"{self.animation.name:18} {job.part:11} {job.mode:32} {job.samples or '':5} seed {job.seed}", flush=True)

    def _truth(self, job: Job) -> Iterator[dict]:
        found = self.renderer.track(job.frame, CHECKED)
        for name, part in found.items():
            if isinstance(part, dict) and part["chains"]:
                yield {"component": name, **{key: value for key, value in part.items() if not key.endswith("_cpu")}}

    def _prediction(self, job: Job) -> Iterator[dict]:
        """Pictures of frames by themselves, where windows would have made the next one like what their vectors lead to. Vectors as an
        animation has them: flow needs the frame before and the next one."""
        first, samples = min(self.animation.frames[0], job.frame - 1), job.samples // LIGHT_PARTS
        animation = self.renderer.passes(DELIVERED, samples, 1000 + LIGHT_PARTS, (first, self.animation.frames[1]), WAYS)
        motion = motion_metrics.of_frame(animation, job.frame - first)
        frames = (job.frame, job.frame + 1)
        parts = [self.renderer.passes(job.mode, samples, 1000 + part, frames, PICTURES) for part in range(LIGHT_PARTS)]
        found = {name: motion_metrics.predict(motion, parts, name) for name in motion_metrics.components(motion)}
        if self.animation.scene.own:
            now = motion | motion_metrics.of_frame(parts[0], 0)
            motion_pictures.store(self.animation.name, now, {name: kinds[""] for name, kinds in found.items()})
            motion_pictures.store_strip(self.animation.name, animation)
        for name, kinds in found.items():
            if kinds[""].counts.any():
                rows = {kind: prediction.row() for kind, prediction in kinds.items()}
                yield {"component": name, **{f"{kind}_{key}".strip("_"): value for kind, row in rows.items() for key, value in row.items()}}

    def _flicker(self, job: Job) -> Iterator[dict]:
        converged, ways = reference(self.renderer, "path", self.samples), self._own_ways()
        images, answer = self.renderer.render(job.mode, job.samples, job.seed)
        motion_metrics.check_finite(images, f"{job.mode} in {self.animation.name}, {job.samples} samples, seed {job.seed}")
        motion_metrics.check_finite(converged.mean, f"converged frames of {self.animation.name}")
        measures = motion_metrics.flicker_measures(images, converged.mean, converged.variance, ways)
        yield {"cpu": answer["cpu"], "wall": answer["wall"], **measures, "reference_samples": converged.samples}

    def _cost(self, job: Job) -> Iterator[dict]:
        mode, passes = COST_MODES[job.mode]
        out = self.renderer.folder / ("cost.npz" if passes else "cost.npy")
        answer = self.renderer.render_to(out, mode, job.samples, job.seed, frames=(job.frame, job.frame), passes=passes)
        yield {"cpu": answer["cpu"], "seconds": answer["seconds"][0]}

    def _own_ways(self) -> np.ndarray:
        """Cached, since only what the scene shows decides about them: few samples tell what a pixel mostly shows."""
        if self._ways is None:
            file = file_of(self.renderer, f"own-ways-{self.version}")
            if not file.exists():
                passes = self.renderer.passes("parts", 32, 1000, self.animation.frames, OWN_WAYS)
                file.parent.mkdir(parents=True, exist_ok=True)
                np.savez_compressed(file, ways=motion_metrics.own_ways(passes).astype(np.float32))
            self._ways = np.load(file)["ways"].astype(np.float64)
        return self._ways

    def close(self) -> None:
        self.renderer.close()


def bench_motion(animation: Animation, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    for variant, parts in parts_of(arguments).items():
        done = done_jobs(animation, variant, version, arguments.loaded)
        jobs = [job for job in jobs_of(animation, arguments, parts) if job not in done]
        if jobs:
            run_all(jobs, partial(MotionBench, animation, variant, arguments, version), deadline)


def run_all(jobs: list[Job], start: Callable[[], MotionBench], deadline: float) -> None:
    bench = start()
    try:
        for job in jobs:
            if time.monotonic() > deadline:
                return
            if bench.works(job.mode):
                bench.run(job)
    finally:
        bench.close()


def _chosen(known: tuple[str, ...], text: str) -> list[str]:
    if unknown := set(text.split(",")) - set(known):
        raise argparse.ArgumentTypeError(f"unknown: {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    return text.split(",")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--parts", type=lambda text: _chosen(PARTS, text), default=list(PARTS))
    parser.add_argument("--minutes", type=float, default=600.0)
    parser.add_argument("--size", type=size, help="pixels, 160x90 of flicker and 320x180 of the others")
    parser.add_argument("--frames", type=several, default=6, help="how many, of flicker")
    parser.add_argument("--blur", action="store_true", help="motion blur, of truth and cost")
    parser.add_argument("--seeds", type=int, default=1, help="of flicker")
    parser.add_argument("--repeats", type=int, default=3, help="of cost, with seeds of their own")
    parser.add_argument("--reference", type=int, default=512, help="samples per pixel of converged frames")
    parser.add_argument("--loaded", action="store_true", help="the machine has other work: times are stored, but not shown")
    parser.add_argument("--light", type=int, default=LIGHT, help="samples per pixel of pictures that are predicted")
    parser.add_argument("--samples", type=powers_of_two, default=[4, 16])
    parser.add_argument("--modes", type=lambda text: _chosen(FLICKER, text), default=list(USUAL))
    arguments = parser.parse_args()
    bench_each(select(ANIMATIONS, arguments.scenes, arguments.frames), bench_motion, arguments)


if __name__ == "__main__":
    main()
