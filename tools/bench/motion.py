"""Measures the motion of components: its errors, its prediction of the next frame, its effect on flicker, its cost.

    motion.py [--scenes a,b] [--measures truth,prediction,flicker,cost] [--size 320x180] [--frames 6] [--seeds 1]
              [--repeats 3] [--blur]

Every run is appended to out/bench/results/motion.jsonl with its commit and Blender; one that is there is not repeated.
Converged frames are those of animation_references.py. Pictures of the project's own scenes are stored, too
(motion_pictures.py). With motion blur only truth and cost are measured, because the others need a single vector for
each pixel. The report is made by report.py.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial

import hosts
import motion_metrics
import motion_pictures
import numpy as np
import records
from animation import several, size
from animation_references import file_of, reference
from animation_scenes import Animation, select
from animation_variants import SHUTTER, Variant, of_row
from motion_modes import DELIVERED, FLICKER, MODES, USUAL
from motion_renderer import MotionRenderer
from motion_scenes import ANIMATIONS
from records import Row
from runs import bench_each, names_of, parser_of, powers_of_two
from version import conditions

RESULTS = records.file_of("motion")
TRUTH, PREDICTION, FLICKERS, COST = MEASURES = ("truth", "prediction", "flicker", "cost")
TIMED = (FLICKERS, COST)
BLURRED = (TRUTH, COST)  # what can be measured with motion blur
SIZES = {TRUTH: (320, 180), PREDICTION: (320, 180), FLICKERS: (160, 90), COST: (320, 180)}  # pixels
CHECKED = 400  # pixels of each component that are compared with the truth
LIGHT, RENDERINGS = 256, 4  # samples per pixel of the pictures that are predicted, and renderings that share them
COST_SAMPLES = 16
PICTURES = ("components", "component_reflectance", "component_irradiance")
MOTION_PASSES = ("vector", "components", "component_motion", "component_irradiance_motion")
VECTOR_PASSES = ("components", "component_motion")

# Modes whose cost is measured, and the passes that each requests. Pictures of components are made only for passes
# that need them.
COST_MODES: dict[str, tuple[str, tuple[str, ...]]] = {
    "combined": ("combined", ()),
    "components": ("components", ("components",)),
    "components-surfaces": ("components", ("components", "component_reflectance", "component_normal")),
    "components-motion": ("components", ("components", "component_motion")),
}


@dataclass(frozen=True)
class Job:
    measure: str
    mode: str = ""
    samples: int = 0
    seed: int = 0
    frame: int = 0  # of truth, prediction and cost


def jobs_of(animation: Animation, arguments: argparse.Namespace, measures: list[str]) -> list[Job]:
    """Returns all jobs of an animation. A seed runs through all modes before the next seed begins."""
    middle = sum(animation.frames) // 2
    jobs = {
        TRUTH: [Job(TRUTH, frame=middle)],
        PREDICTION: [Job(PREDICTION, "components", arguments.light, frame=middle)],
    }
    jobs[FLICKERS] = [
        Job(FLICKERS, mode, samples, seed)
        for seed in range(arguments.seeds)
        for samples in arguments.samples
        for mode in arguments.modes
    ]
    jobs[COST] = [
        Job(COST, mode, COST_SAMPLES, seed, middle) for seed in range(arguments.repeats) for mode in COST_MODES
    ]
    return [job for measure in measures for job in jobs[measure]]


def variant_of(arguments: argparse.Namespace, measure: str) -> Variant:
    return Variant(arguments.size or SIZES[measure], arguments.frames, SHUTTER if arguments.blur else 0.0)


def measures_by_variant(arguments: argparse.Namespace) -> dict[Variant, list[str]]:
    """Returns the measures of each variant; those that motion blur makes meaningless are skipped with a message."""
    found: dict[Variant, list[str]] = {}
    for measure in arguments.measures:
        if arguments.blur and measure not in BLURRED:
            print(f"SKIP {measure}: with motion blur a pixel has more than one vector", flush=True)
        else:
            found.setdefault(variant_of(arguments, measure), []).append(measure)
    return found


def done_jobs(animation: Animation, variant: Variant, version: str, loaded: bool) -> set[Job]:
    """Returns the jobs that need not be repeated. On an idle machine, timed jobs of a loaded one are repeated."""
    wanted = (animation.name, list(animation.frames), variant, version, hosts.peer())
    rows = records.read(RESULTS)
    rows = [row for row in rows if (row["scene"], row["frames"], of_row(row), row["version"], row["blender"]) == wanted]
    rows = [row for row in rows if loaded or not row.get("loaded") or row["measure"] not in TIMED]
    return {Job(*(row[name] for name in ("measure", "mode", "samples", "seed", "frame"))) for row in rows}


class MotionBench:
    """One animation in one variant, with its process and references."""

    def __init__(self, animation: Animation, variant: Variant, arguments: argparse.Namespace, version: str) -> None:
        self.animation, self.samples, self.version = animation, arguments.reference, version
        self.variant, self.loaded = variant, arguments.loaded
        self.renderer = MotionRenderer(animation, self.variant)
        self._vectors: np.ndarray | None = None
        self._refused: dict[str, str] = {}

    def works(self, mode: str) -> bool:
        if mode in MODES and mode not in self._refused:
            self._refused[mode] = self.renderer.refusal(mode)
            if self._refused[mode]:
                print(f"SKIP {mode} in {self.animation.name}: {self._refused[mode]}", flush=True)
        return not self._refused.get(mode)

    def run(self, job: Job) -> None:
        row = {"scene": self.animation.name, "frames": self.animation.frames} | conditions(self.version)
        if self.loaded:
            row["loaded"] = True
        measure = {TRUTH: self._truth, PREDICTION: self._prediction, FLICKERS: self._flicker, COST: self._cost}[
            job.measure
        ]
        for found in measure(job):
            records.append(row | asdict(job) | self.variant.row() | found, RESULTS)
        print(
            f"{self.animation.name:18} {job.measure:11} {job.mode:32} {job.samples or '':5} seed {job.seed}", flush=True
        )

    def _truth(self, job: Job) -> Iterator[Row]:
        for name, facts in self.renderer.track(job.frame, CHECKED).items():
            if isinstance(facts, dict) and facts["chains"]:
                yield {"component": name, **{key: value for key, value in facts.items() if not key.endswith("_cpu")}}

    def _prediction(self, job: Job) -> Iterator[Row]:
        """Predicts pictures of frames by themselves, because windows make frames similar along the vectors.

        The vectors are those of an animation, because optical flow needs the frame before and the next one.
        """
        first, samples = min(self.animation.frames[0], job.frame - 1), job.samples // RENDERINGS
        frames = (first, self.animation.frames[1])
        animation = self.renderer.passes(DELIVERED, samples, 1000 + RENDERINGS, frames, MOTION_PASSES)
        motion = motion_metrics.of_frame(animation, job.frame - first)
        pair = (job.frame, job.frame + 1)
        renderings = [self.renderer.passes(job.mode, samples, 1000 + i, pair, PICTURES) for i in range(RENDERINGS)]
        found = {name: motion_metrics.predict(motion, renderings, name) for name in motion_metrics.components(motion)}
        if self.animation.scene.own:
            now = motion | motion_metrics.of_frame(renderings[0], 0)
            motion_pictures.store(self.animation.name, now, {name: kinds[""] for name, kinds in found.items()})
            motion_pictures.store_strip(self.animation.name, animation)
        for name, kinds in found.items():
            if kinds[""].counts.any():
                rows = {kind: prediction.row() for kind, prediction in kinds.items()}
                columns = {
                    f"{kind}_{key}".strip("_"): value for kind, row in rows.items() for key, value in row.items()
                }
                yield {"component": name} | columns

    def _flicker(self, job: Job) -> Iterator[Row]:
        converged, vectors = reference(self.renderer, "path", self.samples), self._component_vectors()
        images, answer = self.renderer.render(job.mode, job.samples, job.seed)
        run = f"{job.mode} in {self.animation.name}, {job.samples} samples, seed {job.seed}"
        motion_metrics.check_finite(images, run)
        motion_metrics.check_finite(converged.mean, f"converged frames of {self.animation.name}")
        measures = motion_metrics.flicker_measures(images, converged.mean, converged.variance, vectors)
        yield {"cpu": answer["cpu"], "wall": answer["wall"], **measures, "reference_samples": converged.samples}

    def _cost(self, job: Job) -> Iterator[Row]:
        mode, passes = COST_MODES[job.mode]
        out = self.renderer.folder / ("cost.npz" if passes else "cost.npy")
        frames = (job.frame, job.frame)
        answer = self.renderer.render_to(out, mode, job.samples, job.seed, frames=frames, passes=passes)
        yield {"cpu": answer["cpu"], "seconds": answer["seconds"][0]}

    def _component_vectors(self) -> np.ndarray:
        """Returns motion_metrics.component_vectors(), which is cached. A few samples suffice."""
        if self._vectors is None:
            file = file_of(self.renderer, f"component-vectors-{self.version}")
            if not file.exists():
                passes = self.renderer.passes("components", 32, 1000, self.animation.frames, VECTOR_PASSES)
                file.parent.mkdir(parents=True, exist_ok=True)
                np.savez_compressed(file, vectors=motion_metrics.component_vectors(passes).astype(np.float32))
            self._vectors = np.load(file)["vectors"].astype(np.float64)
        return self._vectors

    def close(self) -> None:
        self.renderer.close()


def bench_motion(animation: Animation, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    for variant, measures in measures_by_variant(arguments).items():
        done = done_jobs(animation, variant, version, arguments.loaded)
        jobs = [job for job in jobs_of(animation, arguments, measures) if job not in done]
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


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--measures", type=names_of(MEASURES), default=list(MEASURES))
    parser.add_argument("--size", type=size, help="pixels; by default 160x90 for flicker and 320x180 for the others")
    parser.add_argument("--frames", type=several, default=6, help="number of frames of flicker")
    parser.add_argument("--blur", action="store_true", help="motion blur, for truth and cost")
    parser.add_argument("--seeds", type=int, default=1, help="of flicker")
    parser.add_argument("--repeats", type=int, default=3, help="of cost, each with another seed")
    parser.add_argument("--reference", type=int, default=512, help="samples per pixel of converged frames")
    parser.add_argument("--loaded", action="store_true", help="the machine has other work: times are not reported")
    parser.add_argument("--light", type=int, default=LIGHT, help="samples per pixel of pictures that are predicted")
    parser.add_argument("--samples", type=powers_of_two, default=[4, 16])
    parser.add_argument("--modes", type=names_of(FLICKER), default=list(USUAL), help="of flicker")
    arguments = parser.parse_args()
    bench_each(select(ANIMATIONS, arguments.scenes, arguments.frames), bench_motion, arguments)


if __name__ == "__main__":
    main()
