"""Measures the variance of a sample and its CPU time by plain path tracing, with path guiding and without: Gradus
against Cycles, without denoisers.

    path_tracing.py [--scenes a,b] [--modes path,cycles] [--width 640] [--samples 16] [--seeds 3] [--minutes 600]

Variance needs no reference: half the squared difference of two seeds has it as its expectation. It is divided by the
squared level of the picture, a smooth picture by Gradus, and compared at the same number of samples. The time of a
sample is that of the render without export and build, over the number of samples, so that learning a guide counts. The
slope of the CPU time without a guide, from a quarter of the samples to all of them, tells what export and build take.
Modes take turns, seed by seed. Every scene appends one row to out/bench/results/path_tracing.jsonl; a scene that is
there is not repeated.
"""

from __future__ import annotations

import argparse
import statistics
from collections import defaultdict

import modes
import numpy as np
import records
import temporal_metrics
from records import Row
from renderers import Renderers
from runs import bench_each, names_of, parser_of, works
from scenes import Scene, select
from version import conditions

RESULTS = records.file_of("path_tracing")
OURS = "path"
GUIDED = "path-guided"
MODES = (OURS, GUIDED, "cycles", "cycles-guided")  # of modes.py
LEVEL, LEVEL_SAMPLES, LEVEL_SEED = "path-regularized", 8, 3000
SETUP = ("width", "samples", "seeds", "version", "blender", "machine")  # columns in which rows must agree
MEASURES = ("seconds", "variance", "variance_trimmed")  # of a sample


def measure(scene: Scene, arguments: argparse.Namespace) -> dict[str, dict[str, list[float]]]:
    """Returns the measures of each mode: times seed by seed, in CPU seconds, and variances of pairs of seeds."""
    size = (arguments.width, arguments.width * 9 // 16)
    pixels, samples, few = size[0] * size[1], arguments.samples, arguments.samples // 4
    renderers = Renderers(scene, size)
    found: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    try:
        level = renderers.render(LEVEL, LEVEL_SAMPLES, LEVEL_SEED)[0].mean(axis=-1)
        working = [mode for mode in arguments.modes if works(renderers, mode, scene.name)]
        before: dict[str, np.ndarray] = {}
        for seed in range(arguments.seeds):
            start: dict[str, float] = {}  # by engine
            for mode in working:
                image, answer = renderers.render(mode, samples, seed)
                engine = modes.MODES[mode].engine
                if mode == modes.REFERENCES[engine]:
                    quarter = renderers.render(mode, few, seed)[1]["cpu"]
                    start[engine] = (samples * quarter - few * answer["cpu"]) / (samples - few)
                found[mode]["seconds"].append((answer["cpu"] - start[engine]) / (pixels * samples))
                if mode in before:
                    noise = samples * temporal_metrics.noise_map(before[mode], image, level)
                    found[mode]["variance"].append(float(noise.mean()))
                    found[mode]["variance_trimmed"].append(temporal_metrics.trimmed_mean(noise))
                before[mode] = image
    finally:
        renderers.close()
    return found


def bench_scene(scene: Scene, arguments: argparse.Namespace, version: str, _: float) -> None:
    setup = {"scene": scene.name, "width": arguments.width, "samples": arguments.samples, "seeds": arguments.seeds}
    setup |= conditions(version)
    if any(row.items() >= setup.items() and set(row["tried"]) >= set(arguments.modes) for row in load()):
        return
    row = setup | {"tried": arguments.modes, "modes": measure(scene, arguments)}
    records.append(row, RESULTS)
    for mode in row["modes"]:
        values = " ".join(f"{name} {median_of(row, mode, name):.3g}" for name in MEASURES)
        print(f"{scene.name:18} {mode:14} {values}", flush=True)


def load() -> list[Row]:
    return records.read(RESULTS)


def newest() -> list[Row]:
    """Returns the last row of each scene, of those that were measured like the last one of all and have Gradus."""
    return records.newest([row for row in load() if OURS in row["modes"]], SETUP)


def median_of(row: Row, mode: str, name: str) -> float:
    """Returns the median of a measure over the seeds or the pairs of seeds."""
    return statistics.median(row["modes"][mode][name])


def median_ratio(row: Row, mode: str, peer: str, name: str) -> float:
    """Returns the median of the ratios to a peer within each seed or pair of seeds, where the pace cancels."""
    pairs = zip(row["modes"][mode][name], row["modes"][peer][name], strict=True)
    return statistics.median(ours / theirs for ours, theirs in pairs)


def ratios(row: Row, mode: str, peer: str) -> dict[str, float] | None:
    """Returns the measures of a mode over those of a peer, and `work`, the product of time and trimmed variance."""
    if not {mode, peer} <= row["modes"].keys():
        return None
    found = {name: median_ratio(row, mode, peer, name) for name in MEASURES}
    return found | {"work": found["seconds"] * found["variance_trimmed"]}


def modes_of(text: str) -> list[str]:
    """Converts names of modes ('path,cycles'), and adds the modes without a guide, each before the one with it."""
    chosen = names_of(MODES)(text)
    plain = {modes.REFERENCES[modes.MODES[mode].engine] for mode in chosen}
    return [mode for mode in MODES if mode in plain.union(chosen)]


def seeds_of(text: str) -> int:
    """Converts a number of seeds; variance needs two."""
    if int(text) < 2:
        raise argparse.ArgumentTypeError("at least two seeds are needed")
    return int(text)


def samples_of(text: str) -> int:
    """Converts a number of samples of which a quarter is a power of two, too: sequences are stratified for these."""
    count = int(text)
    if count < 4 or count & (count - 1):
        raise argparse.ArgumentTypeError("a power of two from 4 on is needed")
    return count


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--samples", type=samples_of, default=16)
    parser.add_argument("--seeds", type=seeds_of, default=3)
    parser.add_argument("--modes", type=modes_of, default=list(MODES))
    arguments = parser.parse_args()
    bench_each(select(arguments.scenes), bench_scene, arguments)


if __name__ == "__main__":
    main()
