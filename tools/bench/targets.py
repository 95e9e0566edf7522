"""The table of targets, with the published or measured figure that each is derived from, and what was found."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import path_tracing
import profiles
import reconstruction_time
import speed
from bounds import NOT_MEASURED, Found, at_least, every, median, middle_of, within
from document import Table, number, spread
from results import SceneResults

WORDS = {True: "met", False: "**missed**", None: "–"}
SAME_DENOISER = "OpenImageDenoise, High, accurate prefilter"
MINUTE_ON_GPU = "thesis ch. 8: a minute per megapixel on a GPU"


def table(scenes: list[SceneResults]) -> Table:
    def ratio(mode: str, other: str, measure: str = "relmse") -> dict[str, float]:
        return ratios(scenes, mode, other, measure)

    lines: list[tuple[str, str, Found]] = [
        *plain_paths(),
        ("PT: CPU time per sample / Cycles ≤ 0.6, 1 k triangles", "Cycles", room("room-1k", "path", "cycles", 0.6)),
        ("PT: CPU time per sample / Cycles ≤ 0.6, 2 M triangles", "Cycles", room("room-2m", "path", "cycles", 0.6)),
        ("start-up / Cycles ≤ 0.7, 2 M triangles", "Cycles", start("room-2m", 0.7)),
        ("four offset paths: time / PT ≤ 1.6, 1 k triangles", "G-PT 2015: 2.5",
         room("room-1k", "gradient-none", "path", 1.6)),
        ("four offset paths: time / PT ≤ 1.6, 2 M triangles", "G-PT 2015: 2.5",
         room("room-2m", "gradient-none", "path", 1.6)),
        ("four offset paths: CPU time / PT ≤ 1.6, scenes", "thesis: 2.2 to 3.2", every(cost_ratios(scenes), 1.6)),
        ("pilot: time of AUTO + L2 / PT ≤ 1.03, direct light", "PT", whole_render("direct-light", 1.03)),
        ("pilot: time of AUTO + L2 / PT ≤ 1.03, room behind glass", "PT", whole_render("behind-glass", 1.03)),
        ("L2: relMSE / PT ≤ 0.25, diffuse interiors", "G-BDPT 2015: 0.2 to 0.5 of BDPT",
         every(interiors(scenes), 0.25)),
        ("L2: median relMSE / PT ≤ 0.5", "path reusing 2017: almost 0.1", median(ratio("gradient-l2", "path"), 0.5)),
        ("L2: relMSE / PT ≤ 1.05", "G-PT 2015: worse on specular objects", every(ratio("gradient-l2", "path"), 1.05)),
        ("AUTO + L2: relMSE / PT ≤ 1.05", "PT", every(ratio("auto-l2", "path"), 1.05)),
        ("AUTO without its denoiser: relMSE / PT ≤ 1.05", "PT", every(ratio("auto", "path"), 1.05)),
        ("AUTO without its denoiser: relMSE / Cycles ≤ 1", "Cycles", every(ratio("auto", "cycles"), 1.0)),
        ("AUTO without its denoiser: relMSE / Cycles + denoiser ≤ 1", SAME_DENOISER,
         every(ratio("auto", "cycles-denoised"), 1.0)),
        ("AUTO without its denoiser: HDR-FLIP / Cycles + denoiser ≤ 1", SAME_DENOISER,
         every(ratio("auto", "cycles-denoised", "flip"), 1.0)),
        ("G-PT + REGULARIZED: median relMSE / L1 ≤ 0.6", "thesis ch. 8: 0.2 to 0.67",
         median(ratio("gradient-regularized", "gradient-l1"), 0.6)),
        ("PT + REGULARIZED: median relMSE / Cycles + denoiser ≤ 1", SAME_DENOISER,
         median(ratio("path-regularized", "cycles-denoised"), 1.0)),
        ("PT + REGULARIZED: relMSE / Cycles + denoiser ≤ 2", SAME_DENOISER,
         every(ratio("path-regularized", "cycles-denoised"), 2.0)),
        ("AUTO without its denoiser: median relMSE / Cycles + denoiser ≤ 0.9", SAME_DENOISER,
         median(ratio("auto", "cycles-denoised"), 0.9)),
        ("AUTO: median relMSE / Cycles + denoiser ≤ 0.6", SAME_DENOISER,
         median(ratio("auto-denoised", "cycles-denoised"), 0.6)),
        ("AUTO: relMSE / Cycles + denoiser ≤ 0.9", SAME_DENOISER,
         every(ratio("auto-denoised", "cycles-denoised"), 0.9)),
        ("AUTO: median HDR-FLIP / Cycles + denoiser ≤ 0.9", SAME_DENOISER,
         median(ratio("auto-denoised", "cycles-denoised", "flip"), 0.9)),
        ("AUTO: HDR-FLIP / Cycles + denoiser ≤ 1", SAME_DENOISER,
         every(ratio("auto-denoised", "cycles-denoised", "flip"), 1.0)),
        ("AUTO: mean light at 8 samples within 2 %", "PT", within(mean_lights(scenes, "auto-denoised", 8), 0.02)),
        ("G-PT + REGULARIZED: relMSE / L2 of the same samples ≤ 1.02", "L2 is unbiased",
         every(same_samples(scenes), 1.02)),
        ("G-PT + REGULARIZED: median relMSE / L2 of the same samples ≤ 0.5", "L2", median(same_samples(scenes), 0.5)),
        ("pass Error of PT + REGULARIZED within 30 % of the true error", "relMSE",
         estimated(scenes, "path-regularized")),
        ("pass Error of G-PT + REGULARIZED within 30 % of the true error", "relMSE",
         estimated(scenes, "gradient-regularized")),
        ("PT: slope over the last decade of time −1 ± 0.05", "any unbiased estimator", slopes(scenes, "path")),
        ("L2: slope over the last decade of time −1 ± 0.05", "any unbiased estimator", slopes(scenes, "gradient-l2")),
        ("L2: ≤ 0.10 CPU-s at 1080p", "50 CG steps: 0.32", reconstructed("gradient-l2", 0.10)),
        ("L1: ≤ 1 CPU-s at 1080p", "20 × 50 CG steps: 11.6", reconstructed("gradient-l1", 1.0)),
        ("PT + REGULARIZED: ≤ 2 CPU-s at 1080p", MINUTE_ON_GPU, reconstructed("path-regularized", 2.0)),
        ("G-PT + REGULARIZED: ≤ 2 CPU-s at 1080p", MINUTE_ON_GPU, reconstructed("gradient-regularized", 2.0)),
    ]  # fmt: skip
    return Table(
        ["target", "derived from", "found", ""],
        [[name, source, text, WORDS[met]] for name, source, (text, met) in lines],
    )


GUIDED_SCENES = ("door-ajar", "breakfast-room", "kitchen")


def plain_paths() -> list[tuple[str, str, Found]]:
    """Returns the lines about plain paths in scenes: variance and time of a sample, guiding, and ray tracing."""
    rows = {row["scene"]: row for row in path_tracing.newest()}

    def over(mode: str, peer: str, measure: str) -> dict[str, float]:
        found = {name: path_tracing.ratios(row, mode, peer) for name, row in rows.items()}
        return {name: of_scene[measure] for name, of_scene in found.items() if of_scene}

    plain, guided, cycles, both = path_tracing.MODES
    work, time, variance = (over(plain, cycles, name) for name in ("work", "seconds", "variance_trimmed"))
    gain = {name: value for name, value in over(guided, plain, "work").items() if name in GUIDED_SCENES}
    rays = {row["scene"]: row["rays"] for row in profiles.newest()}
    return [
        ("PT in scenes: median variance × time / Cycles ≤ 0.6", "Cycles", median(work, 0.6)),
        ("PT in scenes: variance × time / Cycles ≤ 0.9", "Cycles", every(work, 0.9)),
        ("PT in scenes: median CPU time per sample / Cycles ≤ 0.6", "Cycles", median(time, 0.6)),
        ("PT in scenes: CPU time per sample / Cycles ≤ 0.8", "Cycles", every(time, 0.8)),
        ("PT in scenes: variance per sample / Cycles ≤ 1", "Cycles", every(variance, 1.0)),
        ("guided PT: median variance × time / Cycles ≤ 0.6", "Cycles", median(over(guided, cycles, "work"), 0.6)),
        ("guided PT: variance × time / Cycles ≤ 0.9", "Cycles", every(over(guided, cycles, "work"), 0.9)),
        ("guided PT: median variance × time / guided Cycles ≤ 0.6", "Cycles", median(over(guided, both, "work"), 0.6)),
        ("guided PT: variance × time / PT ≤ 0.5, hard indirect light", "PT", every(gain, 0.5)),
        ("PT in scenes: share of ray tracing ≥ 0.3", "PT", at_least(rays, 0.3)),
    ]


def mean_lights(scenes: list[SceneResults], mode: str, samples: int) -> dict[str, float]:
    """Returns by how much the mean of a mode exceeds that of the reference, median over the seeds, by scene."""

    def value(scene: SceneResults) -> float | None:
        points = [point for point in scene.points.get(mode, []) if point.samples == samples]
        return points[0].median("mean_light") if points else None

    return by_scene(scenes, value)


def ratios(scenes: list[SceneResults], mode: str, other: str, measure: str = "relmse") -> dict[str, float]:
    """Returns the ratios of errors at equal CPU time by scene."""
    return by_scene(scenes, lambda scene: scene.ratio(mode, other, measure))


def interiors(scenes: list[SceneResults]) -> dict[str, float]:
    return ratios([scene for scene in scenes if scene.diffuse_interior], "gradient-l2", "path")


def cost_ratios(scenes: list[SceneResults]) -> dict[str, float]:
    """Returns the time of a sample with four offset paths over that of a plain sample by scene, with four bounces."""
    return by_scene(scenes, lambda scene: scene.cost_ratio("gradient-none@4", "path@4"))


def same_samples(scenes: list[SceneResults]) -> dict[str, float]:
    """Returns relMSE of REGULARIZED over that of L2 by scene and sample count."""
    found = {scene.name: scene.same_samples_ratios("gradient-regularized", "gradient-l2") for scene in scenes}
    return {f"{name}, {count} samples": ratio for name, counts in found.items() for count, ratio in counts.items()}


def by_scene(scenes: list[SceneResults], value: Callable[[SceneResults], float | None]) -> dict[str, float]:
    """Returns the values that are known."""
    found = {scene.name: value(scene) for scene in scenes}
    return {name: known for name, known in found.items() if known is not None}


def start(room: str, maximum: float) -> Found:
    """Tests the CPU time of a start-up over that of Cycles."""
    found = speed.starts(room)
    ratio = speed.ratio(*(found[mode] for mode in speed.START_MODES))
    return (spread(ratio), ratio[0] <= maximum) if ratio else NOT_MEASURED


def estimated(scenes: list[SceneResults], mode: str) -> Found:
    """Tests how far the estimated error is from the true one, up or down, on average over the scenes."""
    found = by_scene(scenes, lambda scene: scene.estimate_ratio(mode))
    if not found:
        return NOT_MEASURED
    off = float(np.mean([abs(ratio - 1.0) for ratio in found.values()]))
    low, high = min(found, key=lambda name: found[name]), max(found, key=lambda name: found[name])
    extremes = f"{found[low]:.2f} ({low}) to {found[high]:.2f} ({high})"
    return f"{100 * off:.0f} % off; estimated / true: median {middle_of(found):.2f}, {extremes}", off <= 0.3


def slopes(scenes: list[SceneResults], mode: str) -> Found:
    found = by_scene(scenes, lambda scene: scene.slope(mode))
    if not found:
        return NOT_MEASURED
    met = sum(abs(value + 1.0) <= 0.05 for value in found.values())
    low, high = min(found.values()), max(found.values())
    return f"{met} of {len(found)}; median {middle_of(found):.2f} ({low:.2f} to {high:.2f})", met == len(found)


def room(name: str, ours: str, theirs: str, maximum: float) -> Found:
    """Tests the time per sample in a room over that of another mode."""
    costs = speed.costs(speed.load()).get(name, {})
    ratio = costs[ours].over(costs[theirs]) if ours in costs and theirs in costs else None
    if ratio is None:
        return NOT_MEASURED
    return f"{spread(ratio)}; {number(costs[ours].median())} against {number(costs[theirs].median())} µs", ratio[
        0
    ] <= maximum


def whole_render(name: str, maximum: float) -> Found:
    """Tests the time of a whole render by AUTO + L2, pilot included, over that of plain path tracing."""
    costs = speed.costs(speed.load()).get(name, {})
    found = costs["auto-l2"].total_over(costs["path"]) if {"auto-l2", "path"} <= costs.keys() else None
    return (spread(found, ".3f"), found[0] <= maximum) if found else NOT_MEASURED


def reconstructed(mode: str, maximum: float) -> Found:
    """Tests the CPU seconds of a reconstruction."""
    times = [row["reconstruct"] for row in reconstruction_time.newest() if row["mode"] == mode]
    if not times:
        return NOT_MEASURED
    middle = float(np.median(times))
    return spread((middle, min(times), max(times)), ".3f"), middle <= maximum
