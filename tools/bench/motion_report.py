"""The part of the report about motion of components, from docs/benchmark/motion.jsonl alone."""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import dataclass

import motion_pictures
import numpy as np
from animation_variants import Variant, of_row
from document import Block, Figure, Table, Text, number
from motion_modes import FLICKER, MODES, compared_with
from motion_scenes import ANIMATIONS
from results import FOLDER, SceneResults

RESULTS = FOLDER / "motion.jsonl"
PREFACE = FOLDER / "motion.md"
PAPER = ("Zimmer et al. 2015: Robot", 3.72, 1.37)  # table 1: mean steps in space and in time
BARS = {"median": 0.1, "quantile_95": 0.5, "share": 0.95}
LOADED = "loaded"

TRUTH_COLUMNS = (
    "tracked", "of what can be followed", "of what is there", "invented", "error, px: median", "95 %", "steps in space", "in time",
    "flat resting mirror, px: median", "95 %", "flat moving mirror, px: median", "first surface, px: median",
)  # fmt: skip

Rows = list[dict]


def load() -> dict[str, Rows]:
    """By parts, of each scene, variant and part those of the newest version, in the order of the scenes."""
    if not RESULTS.exists():
        return {}
    found: dict[tuple, Rows] = defaultdict(list)
    for line in RESULTS.read_text().splitlines():
        row = json.loads(line)
        found[row["part"], row["scene"], of_row(row), row["mode"] if row["part"] == "flicker" else ""].append(row)
    parts: dict[str, Rows] = defaultdict(list)
    for scene in (animation.name for animation in ANIMATIONS):
        for (part, name, _, _), rows in found.items():
            if name == scene:
                parts[part] += newest(rows)
    return parts


def newest(rows: Rows) -> Rows:
    """Of the newest version; of it those of a quiet machine, if there are any."""
    last = [row for row in rows if row["version"] == rows[-1]["version"]]
    return list(filter(timed_row, last)) or last


def blocks() -> list[Block]:
    parts = load()
    if not parts:
        return []
    made: list[Block] = [Text(PREFACE.read_text()), conditions(parts), about()]
    makers = {"truth": truth, "prediction": prediction, "flicker": flicker, "cost": cost}
    for part, make in makers.items():
        if parts.get(part):
            made += make(parts[part])
    return [*made, *sheets()]


def conditions(parts: dict[str, Rows]) -> Text:
    rows = [row for found in parts.values() for row in found]
    versions, machines = (sorted({row[name] for row in rows if name in row}) for name in ("version", "machine"))
    return Text(f"Version {', '.join(versions)}; {', '.join(machines)}.")


def about() -> Table:
    made = Table(["scene", "what moves"])
    made.rows = [[animation.name, animation.moves] for animation in ANIMATIONS]
    return made


def label(row: dict) -> str:
    return row["scene"] + (", motion blur" if of_row(row).shutter > 0.0 else "")


def share(part: float, whole: float) -> str:
    return f"{100.0 * part / whole:.1f} %" if whole else "–"


def percent(value: float | None) -> str:
    return "–" if value is None else f"{100.0 * value:.1f} %"


# ------------------------------------------------------------------------------------------------ against the truth


def truth(rows: Rows) -> list[Block]:
    made = Table(["scene", "component", *TRUTH_COLUMNS])
    causes = Table(["scene", "component", *(cause for cause in rows[0]["pixels"] if cause not in ("tracked", "no path"))])
    for row in rows:
        check, error = row["check"], row["check"]["error"]
        tracked = row["pixels"]["tracked"]
        lost = [row["pixels"][cause] for cause in causes.columns[2:]]
        if any(lost):
            causes.rows.append([label(row), row["component"], *map(str, lost)])
        if not check["searched"]:
            continue
        there = check["exist"] + check["reappear"]
        cells = [share(tracked, row["chains"]), share(check["tracked"], check["exist"]), share(check["tracked"], there)]
        cells += [str(check["invented"]), number(error.get("median"), ".5f"), number(error.get("quantile_95"), ".5f")]
        cells += [number(row[f"steps_in_{what}"]) if row["searched"] else "–" for what in ("space", "time")]
        resting, moving, first = (
            check["simpler"][name] for name in ("flat_resting_mirror", "flat_moving_mirror", "motion_of_first_surface")
        )
        cells += [
            number(resting.get("median")),
            number(resting.get("quantile_95")),
            number(moving.get("median")),
            number(first.get("median")),
        ]
        made.rows.append([label(row), row["component"], *cells])
    made.rows.append([PAPER[0], *["–"] * 7, *(number(steps) for steps in PAPER[1:]), *["–"] * 4])
    return [Text("### Specular motion against the truth"), about_truth(rows), made, Text("Pixels without motion, by cause:"), causes]


def about_truth(rows: Rows) -> Text:
    """Which bars are met."""
    smooth = [row for row in rows if row["component"] in ("Reflection", "Transmission") and row["check"]["searched"]]
    medians, quantiles = ([row["check"]["error"].get(name, np.inf) for row in smooth] for name in ("median", "quantile_95"))
    shares = [row["pixels"]["tracked"] / row["chains"] for row in smooth]
    followed = [row["check"]["tracked"] / max(row["check"]["exist"], 1) for row in smooth]
    near = sum(value <= BARS["median"] for value in medians), sum(value <= BARS["quantile_95"] for value in quantiles)
    many = [sum(value >= BARS["share"] for value in found) for found in (shares, followed)]
    return Text(
        f"Of {len(smooth)} reflections and refractions the median is at most {BARS['median']:g} pixels in {near[0]} and 95 % at most "
        f"{BARS['quantile_95']:g} in {near[1]}; 95 % of all their pixels are tracked in {many[0]}, of what can be followed in {many[1]}."
    )


# ------------------------------------------------------------------------------------------------ as a prediction


PREDICTED = (
    ("light", "all"),
    ("light where it moves", "moving"),
    ("reflectance", "reflectance_all"),
    ("where it moves", "reflectance_moving"),
)
BY = {"own": "own way", "surface": "surface's", "noise": "noise"}


def prediction(rows: Rows) -> list[Block]:
    """Two tables of the same rows: of light, and of what is lit."""
    made: list[Block] = [Text("### Vectors as a prediction\n\nShare of the pixels that are predicted to 2 %:"), about_prediction(rows)]
    for kinds in (PREDICTED[:2], PREDICTED[2:]):
        columns = [f"{what}: {BY['own']}" if by == "own" else BY[by] for what, _ in kinds for by in BY]
        table = Table(["scene", "pixels", "samples", "component", *columns, "moving: of the pixels"])
        for row in rows:
            parts = [row[name] for _, name in kinds]
            cells = [percent(part.get(by)) for part in parts for by in BY] + [share(parts[1]["pixels"], parts[0]["pixels"])]
            table.rows.append([label(row), f"{row['width']}×{row['height']}", str(row["samples"]), row["component"], *cells])
        made.append(table)
    return made


def about_prediction(rows: Rows) -> Text:
    """In how many the bar is met: at all, and where noise alone would let it."""
    light, shown = ([(row[name]["own"], row[name]["noise"]) for row in rows if "own" in row[name]] for name in ("all", "reflectance_all"))
    counts = [(len(found), sum(own >= BARS["share"] for own, _ in found), sum(own >= min(noise, BARS["share"]) for own, noise in found))
              for found in (light, shown)]  # fmt: skip
    texts = [f"of {what} in {met} of {count} ({close} where noise is the reason for less)" for what, (count, met, close) in
             zip(("light", "reflectance"), counts, strict=True)]  # fmt: skip
    return Text("95 % of the tracked pixels are predicted " + ", and ".join(texts) + ".")


# ------------------------------------------------------------------------------------------------ flicker


@dataclass
class Flicker(SceneResults):
    """Runs of one scene in one variant."""

    def __init__(self, name: str, variant: Variant, rows: Rows) -> None:
        super().__init__(name, rows)
        self.variant = variant


def by_scene(rows: Rows) -> list[Flicker]:
    found: dict[tuple[str, Variant], Rows] = defaultdict(list)
    for row in rows:
        if row["mode"] in MODES:
            found[row["scene"], of_row(row)].append(row)
    return [Flicker(name, variant, of_one) for (name, variant), of_one in found.items()]


def flicker(rows: Rows) -> list[Block]:
    scenes = by_scene(rows)
    made = Table(
        ["scene", "mode", "spp", "seeds", "CPU-s a frame", "F along", "where it moves", "relMSE there", "relMSE of all", "F / windows",
         "relMSE / windows", "F at equal time"]
    )  # fmt: skip
    for scene in scenes:
        for mode in (mode for mode in FLICKER if mode in scene.points):
            for point in scene.points[mode]:
                names = ("flicker_own", "flicker_own_moving", "relmse_smooth", "relmse")
                cells = [number(point.median(name), ".4f") for name in names]
                same = [at_equal_samples(scene, mode, point.samples, name) for name in ("flicker_own", "relmse")]
                frames = point.rows[0]["frames"]
                cpu = number((point.median("cpu") or 0.0) / (frames[1] - frames[0] + 1)) if timed(point.rows) else "–"
                equal = scene.ratio(mode, compared_with(mode), "flicker_own") if all(map(timed_row, scene.rows)) else None
                made.rows.append(
                    [
                        scene.name,
                        MODES[mode].label,
                        str(point.samples),
                        str(len(point.rows)),
                        cpu,
                        *cells,
                        *map(number, same),
                        number(equal),
                    ]
                )
    return [Text("### Flicker along the components' own ways"), made]


def timed_row(row: dict) -> bool:
    return not row.get(LOADED, False)


def timed(rows: Rows) -> bool:
    return all(map(timed_row, rows))


def at_equal_samples(scene: Flicker, mode: str, samples: int, measure: str) -> float | None:
    """Over that of the same solver in windows without components; median over the seeds."""
    ours, theirs = (
        {row["seed"]: row[measure] for point in scene.points.get(name, []) if point.samples == samples for row in point.rows}
        for name in (mode, compared_with(mode))
    )
    ratios = [ours[seed] / theirs[seed] for seed in ours if seed in theirs]
    return float(np.median(ratios)) if ratios else None


# ------------------------------------------------------------------------------------------------ cost


def cost(rows: Rows) -> list[Block]:
    """Ratios of the same seed, medians over the seeds; of quiet machines alone."""
    made = Table(["scene", "sampling with components / without", "reconstruction of all / of one", "motion / sampling", "repeats"])
    by_place: dict[tuple[str, Variant], Rows] = defaultdict(list)
    for row in filter(timed_row, rows):
        by_place[label(row), of_row(row)].append(row)
    for (name, _), found in by_place.items():
        seconds = {mode: {row["seed"]: row["seconds"] for row in found if row["mode"] == mode} for mode in {row["mode"] for row in found}}
        whole, parts, moving = (seconds.get(mode, {}) for mode in ("whole", "parts", "parts-motion"))
        both, all_three = whole.keys() & parts.keys(), parts.keys() & moving.keys()
        ratios = [
            [parts[seed][phase] / whole[seed][phase] for seed in both if whole[seed][phase] > 0.0] for phase in ("sample", "reconstruct")
        ]
        ratios.append([moving[seed]["links"] / moving[seed]["sample"] for seed in all_three])
        made.rows.append([name, *(number(float(np.median(r)) if r else None, ".3f") for r in ratios), str(len(both))])
    return [Text("### Cost of components and of their motion\n\nCPU time, frames of 16 samples:"), made] if made.rows else []


def sheets() -> list[Block]:
    """Pictures of the project's own scenes."""
    names = [animation.name for animation in ANIMATIONS if animation.scene.own]
    files = {motion_pictures.file_name(name): f"{name}: its components, their motion, and errors of what it predicts" for name in names}
    strips = {motion_pictures.strip_name(name): f"{name}: one component over the frames, what the next one differs" for name in names}
    shown = [Figure(file, caption) for name in zip(files.items(), strips.items(), strict=True) for file, caption in name]
    found = [figure for figure in shown if (FOLDER / figure.file).exists()]
    legend = [Figure("error-scale.svg", "errors of prediction; grey: nothing to predict, or not tracked")]
    return [Text("### Components, their motion, and what it predicts"), *legend, *found] if found else []
