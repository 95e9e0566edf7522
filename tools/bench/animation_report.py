"""The part of the report about animations, from out/bench/results/animations.jsonl alone."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import animation_strips
import numpy as np
import records
import temporal_metrics
from animation_modes import MODES, is_temporal, per_frame
from animation_scenes import ANIMATIONS, Animation
from animation_variants import USUAL, Variant, of_row
from document import Block, HtmlOnly, Table, Text, number
from modes import GRADUS
from records import Row
from results import Point, SceneResults

RESULTS = records.file_of("animations")
PEER = "cycles-denoised"
PREFACE = """## Animations: flicker against CPU time

Every run renders all frames in one job, 160×90 pixels, without motion blur. F is the flicker energy; -t leaves out
the worst 0.1 % of the pixels. F/(2 relMSE) is 1 if errors of frames are independent, and 0 for an error that stays. F
warped is F along the motion of surfaces. "fast" is the share of the error's energy above a quarter of the frame rate,
0.5 if errors of frames are independent. T-GPT and "over windows" mean that frames are reconstructed together with
their neighbors in time. Other sizes, numbers of frames and motion blur have tables of their own below; nothing is
compared across them."""


class AnimationResults(SceneResults):
    """The newest runs of one animation in one variant."""

    def __init__(self, animation: Animation, rows: list[Row]) -> None:
        super().__init__(animation.name, rows)
        self.animation = animation

    def modes(self) -> list[str]:
        return [mode for mode in MODES if mode in self.points]

    def steadiness(self, point: Point) -> float | None:
        """Returns F / (2 relMSE), which is 1 if errors of frames are independent."""
        flicker, independent = point.median("flicker"), point.median("flicker_if_independent")
        return flicker / independent if flicker is not None and independent and independent > 0.0 else None

    def lag_and_lead(self, point: Point) -> tuple[int, int] | None:
        """Returns lag and lead of the mean over the seeds, in frames, if a light goes off."""
        found = [row["shares_of_light"] for row in point.rows if "shares_of_light" in row]
        if self.animation.goes_off is None or not found:
            return None
        off = self.animation.goes_off - self.animation.frames[0]
        shares = [float(share) for share in np.mean(found, axis=0)]
        return temporal_metrics.lag(shares, off), temporal_metrics.lead(shares, off)


@dataclass(frozen=True)
class Target:
    """A maximum of the ratio of a measure to that of another mode at equal CPU time."""

    measure: str
    other: Callable[[str], str]
    label: str
    maximum: float

    def ratio(self, scene: AnimationResults, mode: str) -> float | None:
        return scene.ratio(mode, self.other(mode), self.measure)


TARGETS = (
    Target("flicker", lambda _: "path", "F / PT", 0.1),
    Target("flicker_warped", lambda _: "path", "F warped / PT", 0.1),
    Target("flicker", per_frame, "F / the same frame by frame", 0.4),
    Target("flicker_warped", per_frame, "F warped / the same frame by frame", 0.4),
    Target("relmse", per_frame, "relMSE / the same frame by frame", 0.8),
    Target("flicker", lambda _: PEER, "F / Cycles + denoiser", 0.6),
    Target("flicker_warped", lambda _: PEER, "F warped / Cycles + denoiser", 0.6),
)


def load() -> dict[Variant, list[AnimationResults]]:
    """Returns the newest runs of each mode by variant."""
    by_mode: dict[tuple[Variant, str, str], list[Row]] = defaultdict(list)
    for row in of_last_blender(records.read(RESULTS)):
        by_mode[of_row(row), row["scene"], row["mode"]].append(row)
    found: dict[Variant, dict[str, list[Row]]] = defaultdict(lambda: defaultdict(list))
    for (variant, scene, mode), rows in by_mode.items():
        if mode in MODES:
            found[variant][scene] += newest(rows)
    return {variant: _animations(variant, found[variant]) for variant in sorted(found)}


def of_last_blender(rows: list[Row]) -> list[Row]:
    """Returns the rows of the Blender in which each scene and variant was measured last; others have other peers."""
    last = {(of_row(row), row["scene"]): row["blender"] for row in rows}
    return [row for row in rows if row["blender"] == last[of_row(row), row["scene"]]]


def newest(rows: list[Row]) -> list[Row]:
    """Returns the rows of the newest commit of one mode.

    Commits of Gradus do not change peers. Their sample counts that the newest commit lacks are taken from earlier ones
    with as many seeds, so that a curve can be extended.
    """
    last = [row for row in rows if row["version"] == rows[-1]["version"]]
    if MODES[rows[-1]["mode"]].engine == GRADUS:
        return last
    found, seeds = list(last), len({row["seed"] for row in last})
    for samples in sorted({row["samples"] for row in rows} - {row["samples"] for row in last}):
        before = [row for row in rows if row["samples"] == samples]
        before = [row for row in before if row["version"] == before[-1]["version"]]
        found += before if len(before) >= seeds else []
    return found


def _animations(variant: Variant, by_scene: dict[str, list[Row]]) -> list[AnimationResults]:
    """Returns the results of each animation, from runs over the frames that it has in a variant."""
    made = []
    for animation in (animation.lasting(variant.length) for animation in ANIMATIONS):
        if rows := [row for row in by_scene[animation.name] if tuple(row["frames"]) == animation.frames]:
            made.append(AnimationResults(animation, rows))
    return made


def blocks() -> list[Block]:
    found = load()
    made = usual(found.pop(USUAL)) if USUAL in found else []
    for variant, scenes in found.items():
        made += varied(variant, scenes)
    return made


def usual(scenes: list[AnimationResults]) -> list[Block]:
    """Tables of the usual variant."""
    made: list[Block] = [Text(PREFACE), about(scenes), Text("### Targets at equal CPU time"), target_table(scenes)]
    made += [
        HtmlOnly(Text("The same without the worst 0.1 % of the pixels:")),
        HtmlOnly(target_table(scenes, "_trimmed")),
    ]
    made += [
        Text("Modes frame by frame and peers: F over that of Gradus PT and of Cycles + denoiser at equal CPU time:")
    ]
    made += [frame_by_frame(scenes), *lags(scenes)]
    for scene in scenes:
        made += details(scene)
    return made


def about(scenes: list[AnimationResults]) -> Table:
    """Table of the animations and of the conditions of their runs."""
    made = Table(
        ["animation", "frames", "what moves", "samples of the converged frames", "seeds", "commits", "Blender"]
    )
    for scene in scenes:
        first, last = scene.animation.frames
        seeds = sorted({len(point.rows) for points in scene.points.values() for point in points})
        names = ("reference_samples", "version", "blender")
        facts = [", ".join(sorted({str(row[name]) for row in scene.rows})) for name in names]
        seeds_range = str(seeds[0]) if len(seeds) == 1 else f"{seeds[0]}–{seeds[-1]}"
        made.rows.append([scene.name, f"{first}–{last}", scene.animation.moves, facts[0], seeds_range, *facts[1:]])
    return made


def target_table(scenes: list[AnimationResults], suffix: str = "") -> Table:
    """Table of the targets of every temporal mode that was measured."""
    made = Table(["mode", "ratio", "target", *(scene.name for scene in scenes), "met"])
    for mode in filter(is_temporal, MODES):
        if not any(mode in scene.points for scene in scenes):
            continue
        for target in TARGETS:
            limited = Target(target.measure + suffix, target.other, target.label, target.maximum)
            ratios = [limited.ratio(scene, mode) for scene in scenes]
            known = [ratio for ratio in ratios if ratio is not None]
            met = f"{sum(ratio <= target.maximum for ratio in known)} of {len(known)}"
            made.rows.append([MODES[mode].label, target.label, f"≤ {target.maximum:g}", *map(number, ratios), met])
    return made


def frame_by_frame(scenes: list[AnimationResults]) -> Table:
    """Table of F of the other modes, over that of path tracing and over that of Cycles with its denoiser."""
    columns = [f"{scene.name}: / {other}" for other in ("PT", "Cycles + denoiser") for scene in scenes]
    made = Table(["mode", *columns])
    for mode in (mode for mode in MODES if not is_temporal(mode)):
        ratios = [scene.ratio(mode, other, "flicker") for other in ("path", PEER) for scene in scenes]
        if any(ratio is not None for ratio in ratios):
            made.rows.append([MODES[mode].label, *map(number, ratios)])
    return made


def lags(scenes: list[AnimationResults]) -> list[Block]:
    """Table of lag and lead at the highest sample count."""
    made = Table(["animation", "mode", "samples", "frames too late", "frames too early"])
    for scene in scenes:
        for mode in scene.modes():
            point = scene.points[mode][-1]
            if (found := scene.lag_and_lead(point)) is not None:
                made.rows.append([scene.name, MODES[mode].label, str(point.samples), *map(str, found)])
    text = (
        "A light goes off: frames in which more than 5 % of it is wrong, afterwards and before (mean over the seeds)."
    )
    return [Text(text), made] if made.rows else []


UNWARPED = tuple(target for target in TARGETS if "warped" not in target.measure)


def varied(variant: Variant, scenes: list[AnimationResults]) -> list[Block]:
    """Tables of another variant."""
    made: list[Block] = [Text(f"### Animations: {variant.title}"), about(scenes), main_ratios(scenes)]
    for scene in scenes:
        made += [HtmlOnly(Text(f"Measures of {scene.name}:")), HtmlOnly(measures(scene))]
    return made


def main_ratios(scenes: list[AnimationResults]) -> Table:
    made = Table(
        [
            "animation",
            "mode",
            "spp",
            "seeds",
            *(f"{target.label}, ≤ {target.maximum:g}" for target in UNWARPED),
            "late",
            "early",
        ]
    )
    for scene in scenes:
        for mode in scene.modes():
            points = scene.points[mode]
            counts, seeds = ", ".join(str(point.samples) for point in points), min(len(point.rows) for point in points)
            ratios = [
                target.ratio(scene, mode) if is_temporal(mode) or target.other is not per_frame else None
                for target in UNWARPED
            ]
            lag = scene.lag_and_lead(points[-1])
            made.rows.append(
                [scene.name, MODES[mode].label, counts, str(seeds), *map(number, ratios)]
                + (["–", "–"] if lag is None else [str(frames) for frames in lag])
            )
    return made


def details(scene: AnimationResults) -> list[Block]:
    made: list[Block] = [Text(f"### Animation {scene.name}")]
    if strips := animation_strips.table(scene.name):
        made.append(strips)
    return [*made, measures(scene)]


def measures(scene: AnimationResults) -> Table:
    columns = [
        "CPU-s a frame",
        "relMSE",
        "relMSE-t",
        "F",
        "F-t",
        "F/(2 relMSE)",
        "F-t warped",
        "where it moves",
        "fast",
    ]
    made = Table(["mode", "spp", "seeds", *columns])
    for mode in scene.modes():
        for point in scene.points[mode]:
            cpu = (point.median("cpu") or 0.0) / scene.animation.length
            names = ("relmse", "relmse_trimmed", "flicker", "flicker_trimmed")
            cells = [
                number(cpu),
                *(number(point.median(name), ".4f") for name in names),
                number(scene.steadiness(point)),
            ]
            cells += [number(point.median(name), ".4f") for name in ("flicker_warped_trimmed", "flicker_warped_moving")]
            made.rows.append(
                [
                    MODES[mode].label,
                    str(point.samples),
                    str(len(point.rows)),
                    *cells,
                    number(point.median("fast_share")),
                ]
            )
    return made
