"""Error against CPU time: plain path tracing, gradient-domain modes and Cycles from the same .blend files.

    bench.py [--scenes a,b] [--minutes 60] [--quick] [--references-only]

Besides the modes, each scene has a few runs with four bounces, for the CPU time per sample alone (no error is measured there).
Every run is appended to docs/benchmark/results.jsonl with the version that made it, so that a benchmark can be interrupted and resumed;
what is there already for this version is not run again. References (each engine against its own converged image, variance of the
reference subtracted) are cached in the user's cache folder. Report: report.py.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from metrics import rel_mse, rel_mse_trimmed, smape
from scenes import QUICK, ROOT, Scene, select
from version import version_of_build

RESULTS = ROOT / "docs" / "benchmark" / "results.jsonl"
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "gradus" / "references"
MODES = ("path", "gradient-l2", "gradient-l1", "cycles", "cycles-denoised", "cycles-default")
SPEED_MODES = ("path", "gradient-none", "cycles")
SPEED_SAMPLES, SPEED_BOUNCES = (4, 36), 4
SEEDS = 5
REFERENCE_PARTS = 8  # independent renders whose mean is the reference and whose spread is its variance


class Worker:
    """One process with one scene loaded; renders jobs one after another."""

    def __init__(self, scene: Scene, width: int, height: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("worker.py")), str(scene.path), str(width), str(height)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        self._folder = tempfile.TemporaryDirectory()

    def render(self, mode: str, samples: int, seed: int, bounces: int | None = None) -> tuple[np.ndarray, dict]:
        out = Path(self._folder.name) / "image.npy"
        job = {"mode": mode, "samples": samples, "seed": seed, "out": str(out)}
        if bounces is not None:
            job["bounces"] = bounces
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps(job) + "\n")
        self._process.stdin.flush()
        for line in self._process.stdout:
            if line.startswith("RESULT "):
                answer = json.loads(line[7:])
                if "error" in answer:
                    raise RuntimeError(answer["error"])
                return np.load(out).astype(np.float64), answer
        raise RuntimeError(f"the renderer ended with code {self._process.wait()}")

    def close(self) -> None:
        if self._process.stdin:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._folder.cleanup()


def reference(
    worker: Worker, scene: Scene, engine: str, size: tuple[int, int], samples: int, version: str
) -> tuple[np.ndarray, np.ndarray]:
    """Converged image of an engine and the variance of its mean. Seeds 1000 and up are never used by the runs."""
    content = hashlib.sha256(scene.path.read_bytes()).hexdigest()[:12]
    key = f"{scene.name}-{content}-{engine}-{size[0]}x{size[1]}-{samples}-{version if engine == 'path' else 'cycles'}"
    path = CACHE / f"{key}.npz"
    if path.exists():
        stored = np.load(path)
        return stored["mean"], stored["variance"]
    parts = np.stack([worker.render(engine, samples // REFERENCE_PARTS, 1000 + i)[0] for i in range(REFERENCE_PARTS)])
    mean, variance = parts.mean(axis=0), parts.var(axis=0, ddof=1) / REFERENCE_PARTS
    CACHE.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(path.with_suffix(".part.npz"), mean=mean, variance=variance)
    path.with_suffix(".part.npz").rename(path)
    return mean, variance


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


def bench_scene(scene: Scene, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    size = (arguments.width, arguments.width * 9 // 16)
    done = done_jobs(scene, size[0], version)
    jobs = [job for job in jobs_of(arguments) if job not in done]
    if not jobs:
        return
    worker = Worker(scene, *size)
    try:
        references = {e: reference(worker, scene, e, size, arguments.reference, version) for e in ("path", "cycles")}
        if arguments.references_only:
            return
        for mode in {job.mode for job in jobs}:  # not counted: first use loads libraries
            worker.render(mode, 1, 999)
        for job in jobs:
            if time.monotonic() > deadline:
                return
            image, timing = worker.render(job.mode, job.samples, job.seed, job.bounces)
            row = {
                "scene": scene.name, "mode": job.mode, "samples": job.samples, "seed": job.seed, "width": size[0], "height": size[1],
                "cpu": round(timing["cpu"], 4), "wall": round(timing["wall"], 4), "version": version, "machine": platform.machine(),
            }  # fmt: skip
            if job.bounces is not None:
                row["bounces"] = job.bounces
            else:
                row |= errors(image, *references["cycles" if job.mode.startswith("cycles") else "path"])
                row["reference_samples"] = arguments.reference
                if job.seed == 0 and scene.own:
                    save_picture(image, f"{scene.name}-{job.mode}-{job.samples}")
            with RESULTS.open("a") as file:
                file.write(json.dumps(row) + "\n")
            print(f"{scene.name:18} {job.mode:16} {job.samples:5} spp seed {job.seed}: {row['cpu']:8.2f} CPU-s", flush=True)
        if scene.own:
            save_picture(references["path"][0], f"{scene.name}-reference")
    finally:
        worker.close()


def errors(image: np.ndarray, mean: np.ndarray, variance: np.ndarray) -> dict[str, float]:
    return {
        "relmse": rel_mse(image, mean, variance),
        "relmse_trimmed": rel_mse_trimmed(image, mean, variance),
        "smape": smape(image, mean),
    }


def save_picture(image: np.ndarray, name: str) -> None:
    folder = ROOT / "out" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / f"{name}.npy", image.astype(np.float32))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--minutes", type=float, default=600.0)
    parser.add_argument("--references-only", action="store_true", help="compute what is not timed, and stop")
    parser.add_argument("--quick", action="store_true", help="two scenes in under five minutes")
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--reference", type=int, default=4096, help="samples per pixel of the references")
    parser.add_argument("--samples", type=lambda t: [int(x) for x in t.split(",")], default=[4, 16, 64])
    parser.add_argument("--modes", type=lambda t: t.split(","), default=list(MODES))
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.scenes = arguments.scenes or ",".join(QUICK)
        arguments.width, arguments.reference, arguments.samples, arguments.seeds = 160, 1024, [4, 16], 3
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    version, deadline = version_of_build(), time.monotonic() + 60.0 * arguments.minutes
    for scene in select(arguments.scenes):
        try:
            bench_scene(scene, arguments, version, deadline)
        except RuntimeError as error:
            print(f"FAILED {scene.name}: {error}", flush=True)
        if time.monotonic() > deadline:
            print("time is up; run again to go on")
            break


if __name__ == "__main__":
    main()
