"""What was aimed at, with the figure that each aim is anchored in, and what was found. Nothing is rounded in favour."""

from __future__ import annotations

import json

import numpy as np
import solve
import speed
from document import Table, number, spread
from results import FOLDER, SceneResults

PATH, GRADIENT, CYCLES, AUTO = ("path", "4.5"), ("gradient-none", "4.5"), ("cycles", "4.5"), ("auto", "4.5")
SUITE = FOLDER / "suite.json"
Found = tuple[str, bool | None]
NOT_MEASURED: Found = ("not measured", None)


def table(scenes: list[SceneResults]) -> Table:
    lines = [
        ("PT ≤ 0.7× Cycles' CPU time per sample, 1 k triangles (aim 0.5×)", "Cycles 3.4: 2.9 µs", room("room-1k", PATH, CYCLES, 0.7)),
        ("the same, 2 M triangles", "Cycles 3.4: 5.7 µs", room("room-2m", PATH, CYCLES, 0.7)),
        ("four offsets ≤ 1.6× of PT, 1 k triangles (stretch 1.4×)", "G-PT 2015: 2.5×", room("room-1k", GRADIENT, PATH, 1.6)),
        ("the same, 2 M triangles", "G-PT 2015: 2.5×", room("room-2m", GRADIENT, PATH, 1.6)),
        ("the same, on the scenes", "thesis: 2.2×–3.2× by scene", every(cost_ratios(scenes), 1.6)),
        ("AUTO within 3 % of PT's time: direct light alone", "plain PT", chosen("direct-light", 1.03)),
        ("AUTO within 3 % of PT's time: room seen through glass", "plain PT", chosen("behind-glass", 1.03)),
        ("L2, unbiased: R ≤ 0.25 on diffuse interiors", "G-BDPT 2015: 0.2–0.5 of BDPT", every(interiors(scenes), 0.25)),
        ("L2: median R ≤ 0.5 over all scenes", "path reusing 2017: almost 0.1", median(ratios(scenes, "gradient-l2", "path"), 0.5)),
        ("L2 everywhere: R never > 1.05", "G-PT 2015: worse on specular objects", every(ratios(scenes, "gradient-l2", "path"), 1.05)),
        ("L2 where the pilot keeps it: R never > 1.05", "the same", every(ratios(scenes, "auto-l2", "path"), 1.05)),
        ("AUTO: R ≤ 1.05 on every scene", "plain PT", every(ratios(scenes, "auto", "path"), 1.05)),
        ("AUTO: relMSE below Cycles without denoiser", "Cycles, its sampling as ours", every(ratios(scenes, "auto", "cycles"), 1.0)),
        ("AUTO against Cycles with denoiser: relMSE", "OpenImageDenoise High, accurate prefilter; aim later 0.5",
         every(ratios(scenes, "auto", "cycles-denoised"), 1.0)),
        ("the same by HDR-FLIP", "aim later 0.8", every(ratios(scenes, "auto", "cycles-denoised", "flip"), 1.0)),
        ("REGULARIZED of differences against L1, relMSE: median ≤ 0.6 (aim 0.3)", "thesis ch. 8: 0.2–0.67",
         median(ratios(scenes, "gradient-regularized", "gradient-l1"), 0.6)),
        ("REGULARIZED of paths, no network, against Cycles with denoiser: median ≤ 1.0 (aim 0.5)", "the same denoiser",
         median(ratios(scenes, "path-regularized", "cycles-denoised"), 1.0)),
        ("the same, ≤ 2 on every scene", "the same", every(ratios(scenes, "path-regularized", "cycles-denoised"), 2.0)),
        ("AUTO with the host's denoiser against the same: relMSE, median ≤ 0.7 (aim 0.5)", "the same",
         median(ratios(scenes, "auto-denoised", "cycles-denoised"), 0.7)),
        ("the same on every scene ≤ 1.0", "the same", every(ratios(scenes, "auto-denoised", "cycles-denoised"), 1.0)),
        ("the same by HDR-FLIP, median ≤ 0.9 (aim 0.8)", "the same",
         median(ratios(scenes, "auto-denoised", "cycles-denoised", "flip"), 0.9)),
        ("the same by HDR-FLIP on every scene ≤ 1.0", "the same", every(ratios(scenes, "auto-denoised", "cycles-denoised", "flip"), 1.0)),
        ("REGULARIZED of differences against L2 of the same samples, relMSE ≤ 1.02 on every scene and count", "unbiased, no features",
         every(same_samples(scenes), 1.02)),
        ("the same, median ≤ 0.5 (an aim)", "the same", median(same_samples(scenes), 0.5)),
        ("Error of REGULARIZED, within 30 % of the true one on average over the scenes", "one image, relMSE",
         estimated(scenes, "path-regularized")),
        ("the same, of REGULARIZED of differences", "the same", estimated(scenes, "gradient-regularized")),
        ("PT: slope over the last decade −1 ± 0.05", "any unbiased estimator", slopes(scenes, "path")),
        ("L2: slope over the last decade −1 ± 0.05", "any unbiased estimator", slopes(scenes, "gradient-l2")),
        ("L2 in ≤ 0.10 CPU-s at 1080p RGB", "50 CG steps: 0.32", solved("gradient-l2", 0.10)),
        ("L1 in ≤ 1 CPU-s at 1080p RGB", "20 × 50 CG steps: 11.6", solved("gradient-l1", 1.0)),
        ("REGULARIZED of paths in ≤ 2 CPU-s at 1080p RGB", "thesis ch. 8: a minute per megapixel, GPU", solved("path-regularized", 2.0)),
        ("REGULARIZED of differences in the same", "the same", solved("gradient-regularized", 2.0)),
        ("unbiasedness suite green in < 3 minutes", "Mitsuba: z-test, 1 % Šidák", suite()),
    ]  # fmt: skip
    words = {True: "met", False: "**missed**", None: "–"}
    return Table(["aim", "anchor", "found", ""], [[aim, anchor, found, words[met]] for aim, anchor, (found, met) in lines])


def ratios(scenes: list[SceneResults], mode: str, other: str, measure: str = "relmse") -> dict[str, float]:
    """By scene, at equal CPU time, export included."""
    found = {scene.name: scene.ratio(mode, other, measure) for scene in scenes}
    return {name: value for name, value in found.items() if value is not None}


def interiors(scenes: list[SceneResults]) -> dict[str, float]:
    return ratios([scene for scene in scenes if scene.diffuse_interior], "gradient-l2", "path")


def cost_ratios(scenes: list[SceneResults]) -> dict[str, float]:
    found = {scene.name: scene.cost_ratio("gradient-none@4", "path@4") for scene in scenes}
    return {name: value for name, value in found.items() if value is not None}


def every(found: dict[str, float], most: float) -> Found:
    """The median and the worst, and how many keep the limit."""
    if not found:
        return NOT_MEASURED
    worst = max(found, key=lambda name: found[name])
    kept = sum(value <= most for value in found.values())
    text = f"{kept} of {len(found)}; median {np.median(list(found.values())):.2f}, most {found[worst]:.2f} ({worst})"
    return text, kept == len(found)


def same_samples(scenes: list[SceneResults]) -> dict[str, float]:
    """By scene and sample count."""
    found = {scene.name: scene.same_samples_ratios("gradient-regularized", "gradient-l2") for scene in scenes}
    return {f"{name}, {samples} samples": ratio for name, ratios in found.items() for samples, ratio in ratios.items()}


def estimated(scenes: list[SceneResults], mode: str) -> Found:
    """How far the estimate is from the true error on average over the scenes, up or down."""
    found = {scene.name: ratio for scene in scenes if (ratio := scene.estimate_ratio(mode)) is not None}
    if not found:
        return NOT_MEASURED
    off = float(np.mean([abs(ratio - 1.0) for ratio in found.values()]))
    low, high = min(found, key=lambda name: found[name]), max(found, key=lambda name: found[name])
    spread_over = (
        f"estimated over true: median {np.median(list(found.values())):.2f}, {found[low]:.2f} ({low}) to {found[high]:.2f} ({high})"
    )
    return f"{100 * off:.0f} % off; {spread_over}", off <= 0.3


def median(found: dict[str, float], most: float) -> Found:
    if not found:
        return NOT_MEASURED
    value = float(np.median(list(found.values())))
    return f"{value:.2f} over {len(found)}", value <= most


def slopes(scenes: list[SceneResults], mode: str) -> Found:
    found = {scene.name: value for scene in scenes if (value := scene.slope(mode)) is not None}
    if not found:
        return NOT_MEASURED
    kept = sum(abs(value + 1.0) <= 0.05 for value in found.values())
    low, high = min(found.values()), max(found.values())
    return f"{kept} of {len(found)}; median {np.median(list(found.values())):.2f} ({low:.2f} to {high:.2f})", kept == len(found)


def room(name: str, ours: tuple[str, str], theirs: tuple[str, str], most: float) -> Found:
    costs = speed.costs(speed.load()).get(name, {})
    ratio = costs[ours].over(costs[theirs]) if ours in costs and theirs in costs else None
    if ratio is None:
        return NOT_MEASURED
    micros = f"{number(costs[ours].median())} against {number(costs[theirs].median())} µs"
    return f"{ratio[0]:.2f} ({ratio[1]:.2f}–{ratio[2]:.2f}); {micros}", ratio[0] <= most


def chosen(name: str, most: float) -> Found:
    costs = speed.costs(speed.load()).get(name, {})
    found = costs[AUTO].total_over(costs[PATH]) if AUTO in costs and PATH in costs else None
    return (spread(found, ".3f"), found[0] <= most) if found else NOT_MEASURED


def solved(mode: str, most: float) -> Found:
    times = [row["reconstruct"] for row in solve.newest() if row["mode"] == mode]
    return (f"{np.median(times):.3f} ({min(times):.3f}–{max(times):.3f})", bool(np.median(times) <= most)) if times else NOT_MEASURED


def suite() -> Found:
    if not SUITE.exists():
        return NOT_MEASURED
    facts = json.loads(SUITE.read_text())
    green = facts["failed"] == 0
    text = f"{facts['passed']} passed, {facts['failed']} failed in {facts['wall']:.0f} s, {facts['cpu']:.0f} CPU-s"
    return text, green and facts["wall"] < 180.0
