"""The part of the report about animations, from docs/benchmark/animation.jsonl alone."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import animation_strips
import numpy as np
import temporal_metrics
from animation_modes import MODES, is_temporal, per_frame
from animation_scenes import ANIMATIONS, Animation
from animation_variants import USUAL, Variant, of_row
from document import Block, HtmlOnly, Table, Text, number
from modes import GRADUS
from results import FOLDER, Point, SceneResults

RESULTS = FOLDER / "animation.jsonl"
PREFACE = FOLDER / "animation.md"
PEER = "cycles-denoised"


class AnimationResults(SceneResults):
    """The newest runs of one animation in one variant."""

    def __init__(self, animation: Animation, rows: list[dict]) -> None:
        super().__init__(animation.name, rows)
        self.animation = animation

    def modes(self) -> list[str]:
        return [mode for mode in MODES if mode in self.points]

    def steadiness(self, point: Point) -> float | None:
        """F / (2 relMSE): 1 for errors that are independent between frames."""
        flicker, independent = point.median("flicker"), point.median("flicker_if_independent")
        return flicker / independent if flicker is not None and independent and independent > 0.0 else None

    def lag_and_lead(self, point: Point) -> tuple[int, int] | None:
        """Of the mean over the seeds, whose noise is least."""
        found = [row["shares_of_light"] for row in point.rows if "shares_of_light" in row]
        if self.animation.goes_off is None or not found:
            return None
        off = self.animation.goes_off - self.animation.frames[0]
        shares = [float(share) for share in np.mean(found, axis=0)]
        return temporal_metrics.lag(shares, off), temporal_metrics.lead(shares, off)


@dataclass(frozen=True)
class Aim:
    """A measure of a mode over that of another one at equal CPU time."""

    measure: str
    other: Callable[[str], str]
    label: str
    most: float

    def ratio(self, scene: AnimationResults, mode: str) -> float | None:
        return scene.ratio(mode, self.other(mode), self.measure)


AIMS = (
    Aim("flicker", lambda _: "path", "F / PT", 0.1),
    Aim("flicker_warped", lambda _: "path", "F warped / PT", 0.1),
    Aim("flicker", per_frame, "F / the same frame by frame", 0.4),
    Aim("flicker_warped", per_frame, "F warped / the same frame by frame", 0.4),
    Aim("relmse", per_frame, "relMSE / the same frame by frame", 0.8),
    Aim("flicker", lambda _: PEER, "F / Cycles + denoiser", 0.6),
    Aim("flicker_warped", lambda _: PEER, "F warped / Cycles + denoiser", 0.6),
)


def load() -> dict[Variant, list[AnimationResults]]:
    """By variants, the newest runs of each mode."""
    if not RESULTS.exists():
        return {}
    by_mode: dict[tuple[Variant, str, str], list[dict]] = defaultdict(list)
    for line in RESULTS.read_text().splitlines():
        row = json.loads(line)
        by_mode[of_row(row), row["scene"], row["mode"]].append(row)
    found: dict[Variant, dict[str, list[dict]]] = defaultdict(lambda: defaultdict(list))
    for (variant, scene, mode), rows in by_mode.items():
        if mode in MODES:
            found[variant][scene] += newest(rows)
    return {variant: _animations(variant, found[variant]) for variant in sorted(found)}


def newest(rows: list[dict]) -> list[dict]:
    """Of one mode, those of its newest version. Our versions do not change peers: of these, counts of samples that the newest one lacks are
    taken from those before, if they have as many seeds. So a curve can be made longer."""
    last = [row for row in rows if row["version"] == rows[-1]["version"]]
    if MODES[rows[-1]["mode"]].engine == GRADUS:
        return last
    found, seeds = list(last), len({row["seed"] for row in last})
    for samples in sorted({row["samples"] for row in rows} - {row["samples"] for row in last}):
        before = [row for row in rows if row["samples"] == samples]
        before = [row for row in before if row["version"] == before[-1]["version"]]
        found += before if len(before) >= seeds else []
    return found


def _animations(variant: Variant, by_scene: dict[str, list[dict]]) -> list[AnimationResults]:
    """Over the frames that each has in a variant."""
    made = []
    for animation in (animation.lasting(variant.length) for animation in ANIMATIONS):
        if rows := [row for row in by_scene[animation.name] if tuple(row["frames"]) == animation.frames]:
            made.append(AnimationResults(animation, of_same_limits(rows)))
    return made


def has_own_limits(row: dict) -> bool:
    """Gradus once kept its own bounce limits where Cycles had those of the file. In one file both are the same."""
    return MODES[row["mode"]].engine == GRADUS and row["scene"] != "animated" and "limits" not in row


def of_same_limits(rows: list[dict]) -> list[dict]:
    """Without the rows of other limits, as soon as any of ours has those of the file."""
    if any(MODES[row["mode"]].engine == GRADUS and not has_own_limits(row) for row in rows):
        return [row for row in rows if not has_own_limits(row)]
    return rows


def blocks() -> list[Block]:
    found = load()
    made = usual(found.pop(USUAL)) if USUAL in found else []
    for variant, scenes in found.items():
        made += varied(variant, scenes)
    return made


def usual(scenes: list[AnimationResults]) -> list[Block]:
    made: list[Block] = [Text(PREFACE.read_text()), *shorter_paths(scenes), about(scenes), Text("### Aims at equal CPU time"), aims(scenes)]
    made += [HtmlOnly(Text("The same without the worst 0.1 % of the pixels:")), HtmlOnly(aims(scenes, "_trimmed"))]
    made += [Text("Modes frame by frame and peers, F over that of Gradus PT and of Cycles with its denoiser at equal CPU time:")]
    made += [frame_by_frame(scenes), *lags(scenes)]
    for scene in scenes:
        made += details(scene)
    return made


def shorter_paths(scenes: list[AnimationResults]) -> list[Block]:
    names = [scene.name for scene in scenes if any(map(has_own_limits, scene.rows))]
    text = (
        "Not yet measured again: in {} Gradus had its own bounce limits, four diffuse and four glossy ones, and Cycles those of the file, "
        "eight. Its paths were shorter, which takes less time: figures against Cycles flatter it, those within Gradus are not concerned."
    )
    return [Text(text.format(", ".join(names)))] if names else []


def about(scenes: list[AnimationResults]) -> Table:
    made = Table(["animation", "frames", "moves", "samples of the converged frames", "seeds", "versions"])
    for scene in scenes:
        first, last = scene.animation.frames
        seeds = sorted({len(point.rows) for points in scene.points.values() for point in points})
        converged, versions = ({str(row[name]) for row in scene.rows} for name in ("reference_samples", "version"))
        seeds_range = str(seeds[0]) if len(seeds) == 1 else f"{seeds[0]}–{seeds[-1]}"
        made.rows.append(
            [scene.name, f"{first}–{last}", scene.animation.moves, ", ".join(sorted(converged)), seeds_range, ", ".join(sorted(versions))]
        )
    return made


def aims(scenes: list[AnimationResults], suffix: str = "") -> Table:
    """Of every temporal mode that was measured."""
    made = Table(["mode", "ratio", "aim", *(scene.name for scene in scenes), "met"])
    for mode in filter(is_temporal, MODES):
        if not any(mode in scene.points for scene in scenes):
            continue
        for aim in AIMS:
            aimed = Aim(aim.measure + suffix, aim.other, aim.label, aim.most)
            ratios = [aimed.ratio(scene, mode) for scene in scenes]
            known = [ratio for ratio in ratios if ratio is not None]
            met = f"{sum(ratio <= aim.most for ratio in known)} of {len(known)}"
            made.rows.append([MODES[mode].label, aim.label, f"≤ {aim.most:g}", *map(number, ratios), met])
    return made


def frame_by_frame(scenes: list[AnimationResults]) -> Table:
    made = Table(["mode", *(f"{scene.name}: / PT" for scene in scenes), *(f"{scene.name}: / Cycles + denoiser" for scene in scenes)])
    for mode in (mode for mode in MODES if not is_temporal(mode)):
        ratios = [scene.ratio(mode, other, "flicker") for other in ("path", PEER) for scene in scenes]
        if any(ratio is not None for ratio in ratios):
            made.rows.append([MODES[mode].label, *map(number, ratios)])
    return made


def lags(scenes: list[AnimationResults]) -> list[Block]:
    """At the most samples that were run."""
    made = Table(["animation", "mode", "samples", "frames too late", "frames too early"])
    for scene in scenes:
        for mode in scene.modes():
            point = scene.points[mode][-1]
            if (found := scene.lag_and_lead(point)) is not None:
                made.rows.append([scene.name, MODES[mode].label, str(point.samples), *map(str, found)])
    text = "A light goes off: frames in which more than 5 % of it is wrong, from then on and before (mean over the seeds)."
    return [Text(text), made] if made.rows else []


VARIED = tuple(aim for aim in AIMS if "warped" not in aim.measure)


def varied(variant: Variant, scenes: list[AnimationResults]) -> list[Block]:
    """The main figures; all measures on the page alone."""
    made: list[Block] = [Text(f"### Animations: {variant.title}"), about(scenes), figures(scenes)]
    for scene in scenes:
        made += [HtmlOnly(Text(f"Measures of {scene.name}:")), HtmlOnly(measures(scene))]
    return made


def figures(scenes: list[AnimationResults]) -> Table:
    made = Table(["animation", "mode", "spp", "seeds", *(f"{aim.label}, ≤ {aim.most:g}" for aim in VARIED), "late", "early"])
    for scene in scenes:
        for mode in scene.modes():
            points = scene.points[mode]
            counts, seeds = ", ".join(str(point.samples) for point in points), min(len(point.rows) for point in points)
            ratios = [aim.ratio(scene, mode) if is_temporal(mode) or aim.other is not per_frame else None for aim in VARIED]
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
    made = Table(
        ["mode", "spp", "seeds", "CPU-s a frame", "relMSE", "relMSE-t", "F", "F-t", "F/(2 relMSE)", "F-t warped", "where it moves", "fast"]
    )
    for mode in scene.modes():
        for point in scene.points[mode]:
            cpu = (point.median("cpu") or 0.0) / scene.animation.length
            names = ("relmse", "relmse_trimmed", "flicker", "flicker_trimmed")
            cells = [number(cpu), *(number(point.median(name), ".4f") for name in names), number(scene.steadiness(point))]
            cells += [number(point.median(name), ".4f") for name in ("flicker_warped_trimmed", "flicker_warped_moving")]
            made.rows.append([MODES[mode].label, str(point.samples), str(len(point.rows)), *cells, number(point.median("fast_share"))])
    return made
