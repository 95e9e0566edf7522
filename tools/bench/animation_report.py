"""The part of the report about animations, from out/bench/results/animations.jsonl alone."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import animation_strips
import figures
import numpy as np
import records
import temporal_metrics
from animation_modes import DELIVERED, MODES, ONE_BY_ONE, PEER, STILL_SEED, is_temporal, per_frame
from animation_scenes import ANIMATIONS, STATIC, Animation
from animation_variants import USUAL, Variant, of_row
from document import Block, Figure, Table, Text, number
from modes import GRADUS
from records import Row
from results import Point, SceneResults

RESULTS = records.file_of("animations")
PREFACE = """## Animations: error and flicker against CPU time

Every run renders all frames in one job. relMSE and F, the flicker energy, are noise (variance over seeds, all frames)
plus bias² (frames with a reference); -t leaves out the worst 0.1 % of the pixels. `docs/benchmark/README.md` defines
them. Other sizes, numbers of frames and motion blur have a part of their own; nothing is compared across them."""
USUAL_TITLE = f"{USUAL.size[0]}×{USUAL.size[1]} pixels, {USUAL.length} frames"
PARTS = ("", "_noise", "_bias", "_bias_error", "_trimmed")
MAXIMUM_SAMPLING = 1.3  # of a frame, which a static shot may take


class AnimationResults(SceneResults):
    """The newest runs of one animation in one variant."""

    def __init__(self, animation: Animation, rows: list[Row]) -> None:
        super().__init__(animation.name, rows)
        self.animation = animation

    def modes(self) -> list[str]:
        return [mode for mode in MODES if mode in self.points]

    def mean_share(self, point: Point) -> float | None:
        """Returns the share of the old light in the first frame after a light has changed, mean over the seeds."""
        shares = self._shares(point)
        return None if shares is None else shares[self._change()]

    def lag_and_lead(self, point: Point) -> tuple[int, int] | None:
        """Returns lag and lead of the mean over the seeds, in frames, if a light changes."""
        shares = self._shares(point)
        if shares is None:
            return None
        return temporal_metrics.lag(shares, self._change()), temporal_metrics.lead(shares, self._change())

    def light_off_by(self, mode: str, samples: int) -> float | None:
        """Returns by what share the mean of the pictures deviates from that of the reference, mean over the seeds."""
        found = self._values("mean_light", mode, samples)
        return float(np.mean(found)) - 1.0 if found else None

    def frames_of_sampling(self, samples: int) -> float | None:
        """Returns the sampling time of all joined frames over that of one frame by itself."""
        joined, alone = (self._values("sampling", mode, samples) for mode in (DELIVERED, ONE_BY_ONE))
        return float(np.median(joined) / np.median(alone)) * self.animation.length if joined and alone else None

    def _values(self, name: str, mode: str, samples: int) -> list[float]:
        return [row[name] for row in self.rows if (row["mode"], row["samples"]) == (mode, samples)]

    def _change(self) -> int:
        """Returns the index of the first frame after the change among the frames that have a reference."""
        assert self.animation.changes is not None
        return self.animation.changes - self.rows[-1]["checked"][0]

    def _shares(self, point: Point) -> list[float] | None:
        found = [row["shares_of_light"] for row in point.rows if "shares_of_light" in row]
        return [float(share) for share in np.mean(found, axis=0)] if found else None


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
    Target("flicker_trimmed", per_frame, "F-t / the same frame by frame", 0.25),
    Target("flicker", per_frame, "F / the same frame by frame", 0.5),
    Target("relmse_trimmed", per_frame, "relMSE-t / the same frame by frame", 0.5),
    Target("relmse", per_frame, "relMSE / the same frame by frame", 0.5),
    Target("relmse_wake", per_frame, "relMSE in the wake of a shadow / the same frame by frame", 1.05),
    Target("flicker_trimmed", lambda _: PEER, "F-t / Cycles + denoiser", 0.3),
    Target("flicker", lambda _: PEER, "F / Cycles + denoiser", 0.5),
    Target("flicker", lambda _: STILL_SEED, "F / Cycles + denoiser, one seed", 0.5),
    Target("relmse", lambda _: PEER, "relMSE / Cycles + denoiser", 0.5),
    Target("flip", lambda _: PEER, "HDR-FLIP / Cycles + denoiser", 0.8),
)


def load() -> dict[Variant, list[AnimationResults]]:
    """Returns the newest runs of each mode by variant. Those of one seed so far have no errors and are left out."""
    by_mode: dict[tuple[Variant, str, str], list[Row]] = defaultdict(list)
    rows = [row for row in records.read(RESULTS) if "checked" in row]  # earlier ones have other measures
    for row in of_last_blender(rows):
        by_mode[of_row(row), row["scene"], row["mode"]].append(row)
    found: dict[Variant, dict[str, list[Row]]] = defaultdict(lambda: defaultdict(list))
    for (variant, scene, mode), rows in by_mode.items():
        last = newest(rows) if mode in MODES else []
        if any("relmse" in row for row in last):
            found[variant][scene] += last
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
    """Returns the results of each animation, from runs over the frames that it has in a variant.

    Runs whose reference has other frames than that of the last one are left out.
    """
    made = []
    for animation in (animation.lasting(variant.length) for animation in ANIMATIONS):
        if rows := [row for row in by_scene[animation.name] if tuple(row["frames"]) == animation.frames]:
            made.append(AnimationResults(animation, [row for row in rows if row["checked"] == rows[-1]["checked"]]))
    return made


def blocks() -> list[Block]:
    found = load()
    first = [USUAL] if USUAL in found else []
    made: list[Block] = [Text(PREFACE)] if found else []
    for variant in [*first, *(variant for variant in found if variant != USUAL)]:
        made += page(variant, found[variant])
    return made


def page(variant: Variant, scenes: list[AnimationResults]) -> list[Block]:
    """Everything about one variant."""
    made: list[Block] = [Text(f"### Animations: {variant.title or USUAL_TITLE}"), about(scenes)]
    made += [Text("Ratios at equal CPU time. A dash stands where the curves share no range of time."), ratios(scenes)]
    made += [*frame_by_frame(scenes), *changes(scenes), *light(scenes), *static_shots(scenes)]
    for scene in scenes:
        made += details(variant, scene)
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


def ratios(scenes: list[AnimationResults]) -> Table:
    """Table of the targets of every temporal mode that was measured."""
    made = Table(["mode", "ratio", "target", *(scene.name for scene in scenes), "met"])
    for mode in filter(is_temporal, MODES):
        if not any(mode in scene.points for scene in scenes):
            continue
        for target in TARGETS:
            found = [target.ratio(scene, mode) for scene in scenes]
            if known := [ratio for ratio in found if ratio is not None]:
                met = f"{sum(ratio <= target.maximum for ratio in known)} of {len(known)}"
                made.rows.append([MODES[mode].label, target.label, f"≤ {target.maximum:g}", *map(number, found), met])
    return made


def frame_by_frame(scenes: list[AnimationResults]) -> list[Block]:
    """Table of F of the other modes, over that of path tracing and over that of Cycles with its denoiser."""
    columns = [f"{scene.name}: / {other}" for other in ("PT", "Cycles + denoiser") for scene in scenes]
    made = Table(["mode", *columns])
    for mode in (mode for mode in MODES if not is_temporal(mode)):
        found = [scene.ratio(mode, other, "flicker") for other in ("path", PEER) for scene in scenes]
        if any(ratio is not None for ratio in found):
            made.rows.append([MODES[mode].label, *map(number, found)])
    text = "Modes frame by frame and peers: F over that of Gradus PT and of Cycles + denoiser:"
    return [Text(text), made] if made.rows else []


def changes(scenes: list[AnimationResults]) -> list[Block]:
    """Table of what is left of the old light where a light goes off or on."""
    made = Table(["animation", "mode", "samples", "wrong in the first frame", "frames too late", "frames too early"])
    for scene, mode, point in points_of(scenes):
        share, frames = scene.mean_share(point), scene.lag_and_lead(point)
        if share is not None and frames is not None:
            cells = [str(point.samples), f"{100.0 * share:.1f} %", *map(str, frames)]
            made.rows.append([scene.name, MODES[mode].label, *cells])
    text = (
        "A light goes off or on: the share of it that is left or missing in the first frame after the change, and the "
        "frames in which more than 5 % of it is wrong (mean over the seeds)."
    )
    return [Text(text), made] if made.rows else []


def light(scenes: list[AnimationResults]) -> list[Block]:
    """Table of the deviation of the pictures' mean."""
    made = Table(["mode", "samples", *(scene.name for scene in scenes)])
    measured = {(mode, point.samples) for _, mode, point in points_of(scenes)}
    for mode, samples in sorted(measured, key=lambda pair: (list(MODES).index(pair[0]), pair[1])):
        found = [scene.light_off_by(mode, samples) for scene in scenes]
        shares = ["–" if share is None else f"{100.0 * share:+.2f} %" for share in found]
        made.rows.append([MODES[mode].label, str(samples), *shares])
    return [Text("Deviation of the pictures' mean from that of the reference:"), made] if made.rows else []


def static_shots(scenes: list[AnimationResults]) -> list[Block]:
    """Table of how many frames' sampling time an animation takes in which nothing changes."""
    made = Table(["samples", "frames", "frames of sampling", "target"])
    for scene in (scene for scene in scenes if scene.name == STATIC):
        for point in scene.points.get(DELIVERED, []):
            cells = [str(scene.animation.length), number(scene.frames_of_sampling(point.samples))]
            made.rows.append([str(point.samples), *cells, f"≤ {MAXIMUM_SAMPLING:g}"])
    return [Text("A static shot: sampling time over that of one frame by itself."), made] if made.rows else []


def details(variant: Variant, scene: AnimationResults) -> list[Block]:
    made: list[Block] = [Text(f"#### Animation {scene.name}")]
    name = "-".join(filter(None, ("animation", scene.name, re.sub(r"\W+", "-", variant.title))))
    made.append(Figure(figures.animation_figure(scene, MODES, f"{name}.svg"), "relMSE and F against CPU time"))
    if (variant.size, variant.shutter) == (USUAL.size, USUAL.shutter):
        made += animation_strips.films(scene.name)
        made += filter(None, [animation_strips.table(scene.name)])
    return [*made, measures(scene)]


def measures(scene: AnimationResults) -> Table:
    """Table of all measures. Noise and bias² are those of all pixels; ± is the standard error of bias²."""
    columns = [f"{measure}{part}" for measure in ("relMSE", "F") for part in ("", " noise", " bias²", "-t")]
    made = Table(["mode", "spp", "seeds", "CPU-s a frame", *columns, "HDR-FLIP"])
    for _, mode, point in points_of([scene]):
        cells = [number((point.median("cpu") or 0.0) / scene.animation.length)]
        for measure in ("relmse", "flicker"):
            found = {part: number(point.median(f"{measure}{part}"), ".5f") for part in PARTS}
            cells += [found[""], found["_noise"], f"{found['_bias']} ± {found['_bias_error']}", found["_trimmed"]]
        cells.append(number(point.median("flip"), ".4f"))
        made.rows.append([MODES[mode].label, str(point.samples), str(len(point.rows)), *cells])
    return made


def points_of(scenes: list[AnimationResults]) -> list[tuple[AnimationResults, str, Point]]:
    return [(scene, mode, point) for scene in scenes for mode in scene.modes() for point in scene.points[mode]]
