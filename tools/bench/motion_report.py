"""The part of the report about motion of components, from docs/benchmark/motion.jsonl alone."""

from __future__ import annotations

import json
from collections import defaultdict

import motion_flicker
import motion_pictures
import numpy as np
from animation_variants import of_row
from document import Block, Figure, Table, Text, number
from motion_flicker import Rows, is_timed
from motion_metrics import SMOOTH
from motion_scenes import ANIMATIONS
from results import FOLDER

RESULTS = FOLDER / "motion.jsonl"
PREFACE = FOLDER / "motion.md"
PAPER = ("Zimmer et al. 2015: Robot", 3.72, 1.37)  # table 1: mean steps in space and in time
BARS = {"median": 0.1, "quantile_95": 0.5, "share": 0.95}
FLICKER = "flicker"

TRUTH_COLUMNS = (
    "tracked", "of what can be followed", "of what is there", "invented", "error, px: median", "95 %", "steps in space", "in time",
    "flat resting mirror, px: median", "95 %", "flat moving mirror, px: median", "first surface, px: median",
)  # fmt: skip


def load() -> dict[str, Rows]:
    """By parts, in the order of the scenes: of each scene, with and without motion blur, those of the newest version; of flicker those of
    each size and mode."""
    if not RESULTS.exists():
        return {}
    found: dict[tuple, Rows] = defaultdict(list)
    for line in RESULTS.read_text().splitlines():
        row = json.loads(line)
        apart = (of_row(row), row["mode"]) if row["part"] == FLICKER else of_row(row).shutter
        found[row["part"], row["scene"], apart].append(row)
    parts: dict[str, Rows] = defaultdict(list)
    for scene in (animation.name for animation in ANIMATIONS):
        for (part, name, _), rows in found.items():
            if name == scene:
                parts[part] += newest(rows)
    return parts


def newest(rows: Rows) -> Rows:
    """Of the newest version; of it those of a quiet machine, if there are any."""
    last = [row for row in rows if row["version"] == rows[-1]["version"]]
    return [row for row in last if is_timed([row])] or last


def blocks() -> list[Block]:
    parts = load()
    if not parts:
        return []
    made: list[Block] = [Text(PREFACE.read_text()), conditions(parts), about()]
    makers = {"truth": truth, "prediction": prediction, FLICKER: motion_flicker.blocks, "cost": cost}
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


def percent(value: float | None, form: str = ".1f") -> str:
    return "–" if value is None else f"{100.0 * value:{form}} %"


def listed(names: list[str]) -> str:
    return "; ".join(names) or "none"


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
    """Which bars are met, and where not."""
    smooth = [row for row in rows if row["component"] in SMOOTH and row["check"]["searched"]]
    medians, quantiles = ([row["check"]["error"].get(name, np.inf) for row in smooth] for name in ("median", "quantile_95"))
    shares = [row["pixels"]["tracked"] / row["chains"] for row in smooth]
    followed = [row["check"]["tracked"] / max(row["check"]["exist"], 1) for row in smooth]
    near = sum(value <= BARS["median"] for value in medians), sum(value <= BARS["quantile_95"] for value in quantiles)
    many = [sum(value >= BARS["share"] for value in found) for found in (shares, followed)]
    missed = [
        f"{label(row)}, {row['component']} ({percent(found, '.2f')})"
        for row, found in zip(smooth, shares, strict=True)
        if found < BARS["share"]
    ]
    return Text(
        f"Of {len(smooth)} reflections and refractions the median is at most {BARS['median']:g} pixels in {near[0]} and 95 % at most "
        f"{BARS['quantile_95']:g} in {near[1]}, the most {max(quantiles, default=0.0):.5f}; 95 % of all their pixels are tracked in "
        f"{many[0]}, of what can be followed in {many[1]}. Less of all pixels: {listed(missed)}."
    )


# ------------------------------------------------------------------------------------------------ as a prediction


TABLES = (
    {"light": "all", "light where it moves": "moving"},
    {"reflectance": "reflectance_all", "reflectance where it moves": "reflectance_moving"},
    {"irradiance": "irradiance_all", "irradiance where it moves": "irradiance_moving"},
)
BY = {"own": "own way", "surface": "surface's", "noise": "noise"}


def prediction(rows: Rows) -> list[Block]:
    """Tables of the same rows: of light, of what is lit, and of what falls on it."""
    made: list[Block] = [Text("### Vectors as a prediction\n\nShare of the pixels that are predicted to 2 %:"), *about_prediction(rows)]
    return [*made, *filter(lambda table: table.rows, (predicted(rows, kinds) for kinds in TABLES))]


def predicted(rows: Rows, kinds: dict[str, str]) -> Table:
    """Columns by what is predicted, each with three ways to do so."""
    columns = [f"{what}: {BY['own']}" if by == "own" else BY[by] for what in kinds for by in BY]
    table = Table(["scene", "pixels", "samples", "component", "counted", *columns, "moving: of the pixels"])
    whole, moving = kinds.values()
    for row in (row for row in rows if row.get(whole, {}).get("pixels")):
        parts, lit = [row[whole], row[moving]], row.get(whole.replace("all", "lit"))
        cells = [percent(part.get(by)) for part in parts for by in BY] + [share(parts[1]["pixels"], parts[0]["pixels"])]
        counted = share(parts[0]["pixels"], lit) if lit else "–"
        table.rows.append([label(row), f"{row['width']}×{row['height']}", str(row["samples"]), row["component"], counted, *cells])
    return table


def about_prediction(rows: Rows) -> list[Text]:
    """In how many the bar is met: at all, and where noise alone would let it; and how often more than by the surface's motion."""
    texts = []
    for what, name in ((what, name) for kinds in TABLES for what, name in kinds.items() if name.endswith("all")):
        found = [(row[name]["own"], row[name]["noise"]) for row in rows if "own" in row.get(name, {})]
        met, close = (sum(own >= bar for (own, _), bar in zip(found, most, strict=True)) for most in bars_of(found))
        texts += [f"of {what} in {met} of {len(found)} ({close} where noise is the reason for less)"] if found else []
    made = [Text("95 % of the pixels that count are predicted " + ", ".join(texts) + ".")]
    return made + [Text(f"- {times_as_many(rows, *of)}") for of in COMPARED if times_as_many(rows, *of)]


def bars_of(found: list[tuple[float, float]]) -> tuple[list[float], list[float]]:
    """The bar, and what noise lets of it."""
    return [BARS["share"]] * len(found), [min(noise, BARS["share"]) for _, noise in found]


COMPARED = (
    ("reflectance where it moves, reflections and refractions", "reflectance_moving", SMOOTH),
    ("reflectance where it moves, Residual", "reflectance_moving", ("Residual",)),
    ("irradiance where it or what it falls on moves, all components", "irradiance_moving", ()),
)
LEAST = 100  # pixels that a ratio of shares is told of


def times_as_many(rows: Rows, what: str, name: str, components: tuple[str, ...]) -> str:
    """How many times as many pixels own ways predict as the surface's motion; nothing where nothing is told."""
    chosen = [row for row in rows if row["component"] in components or not components]
    chosen = [row for row in chosen if row.get(name, {}).get("pixels", 0) >= LEAST]
    found = {f"{label(row)}, {row['component']}": (row[name]["own"], row[name]["surface"]) for row in chosen}
    ratios = {row: own / surface for row, (own, surface) in found.items() if surface > 0.0}
    if not ratios:
        return ""
    (least, least_of), (most, most_of) = (choose((ratio, row) for row, ratio in ratios.items()) for choose in (min, max))
    fewer = sum(own < surface for own, surface in found.values())
    none = sum(surface == 0.0 < own for own, surface in found.values())
    extremes = f"least {least:.2f} ({least_of}), most {most:.2f} ({most_of})"
    return (
        f"Pixels that own ways predict, over those that the surface's motion does, of {what}: median "
        f"{np.median(list(ratios.values())):.2f}, {extremes}; fewer in {fewer} of {len(found)}; "
        f"in {none} the surface's predicts none, and there is no such figure."
    )


# ------------------------------------------------------------------------------------------------ cost


COST = {
    "sampling of components / whole": ("parts", "sample", "whole", "sample", 1.05),
    "with surfaces, too": ("parts-surfaces", "sample", "whole", "sample", None),
    "reconstruction of components / whole": ("parts", "reconstruct", "whole", "reconstruct", 1.5),
    "motion / sampling": ("parts-motion", "links", "parts-motion", "sample", 0.03),
}
"""Column → mode and phase, mode and phase that they are divided by, and the most that they may be."""


def cost(rows: Rows) -> list[Block]:
    """Ratios of the same seed, medians over the seeds; of quiet machines alone."""
    made = Table(["scene", *(f"{column}, ≤ {most:g}" if most else column for column, (*_, most) in COST.items()), "repeats"])
    by_place: dict[str, Rows] = defaultdict(list)
    for row in (row for row in rows if is_timed([row])):
        by_place[label(row)].append(row)
    found = {place: {column: cost_ratios(of_one, *wanted[:4]) for column, wanted in COST.items()} for place, of_one in by_place.items()}
    for place, columns in found.items():
        repeats = str(max(map(len, columns.values())))
        made.rows.append([place, *(number(float(np.median(ratios)) if ratios else None, ".3f") for ratios in columns.values()), repeats])
    text = f"### Cost of components and of their motion\n\nCPU time, frames of 16 samples. Missed: {listed(costs_missed(found))}."
    return [Text(text), made] if made.rows else []


def cost_ratios(rows: Rows, mode: str, phase: str, other: str, divisor: str) -> list[float]:
    seconds = [{row["seed"]: row["seconds"][what] for row in rows if row["mode"] == of} for of, what in ((mode, phase), (other, divisor))]
    return [seconds[0][seed] / seconds[1][seed] for seed in seconds[0] if seconds[1].get(seed, 0.0) > 0.0]


def costs_missed(found: dict[str, dict[str, list[float]]]) -> list[str]:
    missed = []
    for column, (*_, most) in COST.items():
        medians = {place: float(np.median(columns[column])) for place, columns in found.items() if columns[column]}
        over = [f"{place} ({value:.3f})" for place, value in medians.items() if most and value > most]
        missed += [f"{column} in {', '.join(over)}"] if over else []
    return missed


def sheets() -> list[Block]:
    """Pictures of the project's own scenes."""
    names = [animation.name for animation in ANIMATIONS if animation.scene.own]
    files = {motion_pictures.file_name(name): f"{name}: its components, their motion, and errors of what it predicts" for name in names}
    strips = {motion_pictures.strip_name(name): f"{name}: one component over the frames, what the next one differs" for name in names}
    shown = [Figure(file, caption) for name in zip(files.items(), strips.items(), strict=True) for file, caption in name]
    found = [figure for figure in shown if (FOLDER / figure.file).exists()]
    legend = [Figure("error-scale.svg", "errors of prediction; grey: nothing to predict, or not tracked")]
    return [Text("### Components, their motion, and what it predicts"), *legend, *found] if found else []
