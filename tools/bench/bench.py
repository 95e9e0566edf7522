"""Error against CPU time: plain path tracing, gradient-domain modes and Cycles from the same .blend files.

    bench.py [--scenes a,b] [--minutes 60] [--quick]

Every run is appended to docs/benchmark/results.jsonl with the version that made it, so that a benchmark can be interrupted and resumed;
what is there already for this version is not run again. References (each engine against its own converged image, variance of the reference
subtracted) are cached in the user's cache folder. Report: report.py.
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
from pathlib import Path

import numpy as np
from metrics import rel_mse, rel_mse_trimmed, smape
from scenes import QUICK, ROOT, Scene, select

RESULTS = ROOT / "docs" / "benchmark" / "results.jsonl"
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "gradus" / "references"
MODES = ("path", "gradient-l2", "gradient-l1", "cycles", "cycles-denoised")
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

    def render(self, mode: str, samples: int, seed: int) -> tuple[np.ndarray, dict]:
        out = Path(self._folder.name) / "image.npy"
        job = {"mode": mode, "samples": samples, "seed": seed, "out": str(out)}
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


def version_of_build() -> str:
    commit = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    return commit or "unknown"


def done_runs(version: str) -> set[tuple]:
    if not RESULTS.exists():
        return set()
    rows = [json.loads(line) for line in RESULTS.read_text().splitlines()]
    return {(r["scene"], r["mode"], r["samples"], r["seed"], r["width"]) for r in rows if r["version"] == version}


def bench_scene(scene: Scene, arguments: argparse.Namespace, version: str, deadline: float) -> None:
    size = (arguments.width, arguments.width * 9 // 16)
    done = done_runs(version)
    jobs = [(seed, samples, mode) for seed in range(arguments.seeds) for samples in arguments.samples for mode in arguments.modes]
    jobs = [j for j in jobs if (scene.name, j[2], j[1], j[0], size[0]) not in done]
    if not jobs:
        return
    worker = Worker(scene, *size)
    try:
        references = {e: reference(worker, scene, e, size, arguments.reference, version) for e in ("path", "cycles")}
        for mode in arguments.modes:  # not counted: first use loads libraries
            worker.render(mode, 1, 999)
        for seed, samples, mode in jobs:
            if time.monotonic() > deadline:
                return
            image, timing = worker.render(mode, samples, seed)
            mean, variance = references["cycles" if mode.startswith("cycles") else "path"]
            row = {
                "scene": scene.name, "mode": mode, "samples": samples, "seed": seed, "width": size[0], "height": size[1],
                "cpu": round(timing["cpu"], 4), "wall": round(timing["wall"], 4),
                "relmse": rel_mse(image, mean, variance), "relmse_trimmed": rel_mse_trimmed(image, mean, variance),
                "smape": smape(image, mean), "reference_samples": arguments.reference, "version": version, "machine": platform.machine(),
            }  # fmt: skip
            with RESULTS.open("a") as file:
                file.write(json.dumps(row) + "\n")
            print(f"{scene.name:18} {mode:16} {samples:5} spp seed {seed}: {row['cpu']:8.2f} CPU-s  relMSE {row['relmse']:.5f}", flush=True)
            if seed == 0 and scene.own:
                save_picture(image, f"{scene.name}-{mode}-{samples}")
    finally:
        worker.close()


def save_picture(image: np.ndarray, name: str) -> None:
    folder = ROOT / "out" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / f"{name}.npy", image.astype(np.float32))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--minutes", type=float, default=600.0)
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
