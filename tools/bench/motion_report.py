"""The part of the report about motion of components, from out/bench/results/motion.jsonl alone."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import motion_flicker
import motion_pictures
import numpy as np
import records
from animation_variants import of_row
from document import Block, Figure, Table, Text, number
from motion_flicker import Rows, is_timed
from motion_metrics import SPECULAR
from motion_scenes import ANIMATIONS
from paths import OUT
from records import Row

RESULTS = records.file_of("motion")
PAPER = ("Zimmer et al. 2015: Robot", 3.72, 1.37)  # its table 1: mean steps in space and in time
MEDIAN, QUANTILE_95, SHARE = 0.1, 0.5, 0.95  # targets: pixels of error, and share that is tracked or predicted
FLICKER = "flicker"
PREFACE = """## Motion of components

Where reflections and refractions move from frame to frame. `docs/benchmark/README.md` says what is measured.

- Truth: a dense search of the film in small steps of time. "Can be followed" means found in every step; "there" adds
  points that are lost on the way but visible in the next frame; "invented" pixels are tracked to a place where their
  point is not visible.
- Prediction: a pixel is predicted if its component's light in the next frame, read where the vector leads, differs by
  at most 2 %. "Noise" is the same measure between two renderings of one frame, which no vector can exceed. Pixels are
  counted if they are tracked, have enough light, and both compared vectors lead into the picture.
- Flicker is measured along the motion of the component that a pixel mostly shows. Times of a loaded machine and
  ratios between different commits are left out."""

TRUTH_COLUMNS = (
    "tracked",
    "of what can be followed",
    "of what is there",
    "invented",
    "error, px: median",
    "95 %",
    "steps in space",
    "in time",
    "static flat mirror, px: median",
    "95 %",
    "moving flat mirror, px: median",
    "first surface, px: median",
)


def load() -> dict[str, Rows]:
    """Returns the newest rows by measure, in the order of the scenes.

    They are the newest of each scene with and without motion blur, and for flicker the newest of each size and mode,
    too.
    """
    found: dict[tuple, Rows] = defaultdict(list)
    for row in records.read(RESULTS):
        separate = (of_row(row), row["mode"]) if row["measure"] == FLICKER else of_row(row).shutter
        found[row["measure"], row["scene"], separate].append(row)
    by_measure: dict[str, Rows] = defaultdict(list)
    for scene in (animation.name for animation in ANIMATIONS):
        for (measure, name, _), rows in found.items():
            if name == scene:
                by_measure[measure] += newest(rows)
    return by_measure


def newest(rows: Rows) -> Rows:
    """Returns the rows of the newest commit and Blender, of these only the ones of an idle machine if there are any."""
    last = records.like_last(rows, ("version", "blender"))
    return [row for row in last if is_timed([row])] or last


def blocks() -> list[Block]:
    found = load()
    if not found:
        return []
    made: list[Block] = [Text(PREFACE), conditions(found), about()]
    makers = {"truth": truth, "prediction": prediction, FLICKER: motion_flicker.blocks, "cost": cost}
    for measure, make in makers.items():
        if found.get(measure):
            made += make(found[measure])
    return [*made, *sheets()]


def conditions(found: dict[str, Rows]) -> Text:
    """Names commits, Blenders and machines of all runs."""
    rows = [row for measured in found.values() for row in measured]
    names = ("version", "blender", "machine")
    commits, blenders, machines = (", ".join(sorted({row[name] for row in rows if name in row})) for name in names)
    return Text(f"Commit {commits}; Blender {blenders}; {machines}.")


def about() -> Table:
    made = Table(["scene", "what moves"])
    made.rows = [[animation.name, animation.moves] for animation in ANIMATIONS]
    return made


def label(row: Row) -> str:
    return row["scene"] + (", motion blur" if of_row(row).shutter > 0.0 else "")


def share(part: float, total: float) -> str:
    return f"{100.0 * part / total:.1f} %" if total else "–"


def percent(value: float | None, form: str = ".1f") -> str:
    return "–" if value is None else f"{100.0 * value:{form}} %"


def listed(names: list[str]) -> str:
    return "; ".join(names) or "none"


def truth(rows: Rows) -> list[Block]:
    """Tables of errors against the truth, and of the causes why pixels have no motion."""
    made = Table(["scene", "component", *TRUTH_COLUMNS])
    causes = Table(
        ["scene", "component", *(cause for cause in rows[0]["pixels"] if cause not in ("tracked", "no path"))]
    )
    for row in rows:
        lost = [row["pixels"][cause] for cause in causes.columns[2:]]
        if any(lost):
            causes.rows.append([label(row), row["component"], *map(str, lost)])
        if row["check"]["searched"]:
            made.rows.append([label(row), row["component"], *truth_cells(row)])
    made.rows.append([PAPER[0], *["–"] * 7, *(number(steps) for steps in PAPER[1:]), *["–"] * 4])
    title = Text("### Specular motion against the truth")
    return [title, about_truth(rows), made, Text("Pixels without motion, by cause:"), causes]


def truth_cells(row: Row) -> list[str]:
    check, error, tracked = row["check"], row["check"]["error"], row["pixels"]["tracked"]
    there = check["exist"] + check["reappear"]
    simpler = check["simpler"]
    static, moving = simpler["flat_static_mirror"], simpler["flat_moving_mirror"]
    return [
        share(tracked, row["chains"]),
        share(check["tracked"], check["exist"]),
        share(check["tracked"], there),
        str(check["invented"]),
        number(error.get("median"), ".5f"),
        number(error.get("quantile_95"), ".5f"),
        *(number(row[f"steps_in_{what}"]) if row["searched"] else "–" for what in ("space", "time")),
        number(static.get("median")),
        number(static.get("quantile_95")),
        number(moving.get("median")),
        number(simpler["motion_of_first_surface"].get("median")),
    ]


def about_truth(rows: Rows) -> Text:
    """Returns a text: in how many reflections and refractions the targets are met, and where they are missed."""
    specular = [row for row in rows if row["component"] in SPECULAR and row["check"]["searched"]]
    errors = [row["check"]["error"] for row in specular]
    quantiles = [error.get("quantile_95", np.inf) for error in errors]
    shares = [row["pixels"]["tracked"] / row["chains"] for row in specular]
    followed = [row["check"]["tracked"] / max(row["check"]["exist"], 1) for row in specular]
    medians = sum(error.get("median", np.inf) <= MEDIAN for error in errors)
    near = sum(value <= QUANTILE_95 for value in quantiles)
    fewer = [
        f"{label(row)}, {row['component']} ({percent(found, '.2f')})"
        for row, found in zip(specular, shares, strict=True)
        if found < SHARE
    ]
    tracked, of_followed = (sum(value >= SHARE for value in found) for found in (shares, followed))
    return Text(
        f"Of {len(specular)} reflections and refractions, the median error is at most {MEDIAN:g} pixels in {medians}, "
        f"and 95 % of the pixels are within {QUANTILE_95:g} pixels in {near} (worst: "
        f"{max(quantiles, default=0.0):.5f}). 95 % of all pixels are tracked in {tracked}, and 95 % of those that can "
        f"be followed in {of_followed}. Fewer of all pixels: {listed(fewer)}."
    )


# Tables of predictions: columns, and the columns of stored rows for all and for moving pixels.
PREDICTED = (
    {"light": "all", "light where it moves": "moving"},
    {"reflectance": "reflectance_all", "reflectance where it moves": "reflectance_moving"},
    {"irradiance": "irradiance_all", "irradiance where it moves": "irradiance_moving"},
)
BY = {"own": "own motion", "surface": "surface's", "noise": "noise"}


def prediction(rows: Rows) -> list[Block]:
    """Tables of the predictions of light, reflectance and irradiance."""
    title = Text("### Vectors as a prediction\n\nShare of the counted pixels that are predicted within 2 %:")
    tables = (predicted(rows, kinds) for kinds in PREDICTED)
    return [title, *about_prediction(rows), *(table for table in tables if table.rows)]


def predicted(rows: Rows, kinds: dict[str, str]) -> Table:
    """Table with three columns for each prediction: by own motion, by the compared one, and the limit by noise."""
    columns = [f"{what}: {BY['own']}" if by == "own" else BY[by] for what in kinds for by in BY]
    table = Table(["scene", "pixels", "samples", "component", "counted", *columns, "moving: of the pixels"])
    every, moving = kinds.values()
    for row in (row for row in rows if row.get(every, {}).get("pixels")):
        shares, lit = [row[every], row[moving]], row.get(every.replace("all", "lit"))
        cells = [percent(found.get(by)) for found in shares for by in BY]
        cells.append(share(shares[1]["pixels"], shares[0]["pixels"]))
        counted = share(shares[0]["pixels"], lit) if lit else "–"
        size = f"{row['width']}×{row['height']}"
        table.rows.append([label(row), size, str(row["samples"]), row["component"], counted, *cells])
    return table


def about_prediction(rows: Rows) -> list[Text]:
    """Returns a text: in how many components the target is met, with own motion and with the compared motion."""
    texts = []
    for what, name in ((what, name) for kinds in PREDICTED for what, name in kinds.items() if name.endswith("all")):
        found = [(row[name]["own"], row[name]["noise"]) for row in rows if "own" in row.get(name, {})]
        met = sum(own >= SHARE for own, _ in found)
        within_noise = sum(own >= min(noise, SHARE) for own, noise in found)
        texts += [f"of {what} in {met} of {len(found)} ({within_noise} up to the limit of noise)"] if found else []
    made = [Text("95 % of the counted pixels are predicted " + ", ".join(texts) + ".")]
    return made + [Text(f"- {text}") for comparison in COMPARED if (text := times_as_many(rows, comparison))]


@dataclass(frozen=True)
class Comparison:
    """A kind of prediction in which own motion is compared with another one, over some components or all for ()."""

    label: str
    column: str
    components: tuple[str, ...] = ()


COMPARED = (
    Comparison("reflectance where it moves, reflections and refractions", "reflectance_moving", SPECULAR),
    Comparison("reflectance where it moves, Residual", "reflectance_moving", ("Residual",)),
    Comparison("irradiance where it or its surface moves, all components", "irradiance_moving"),
)
MINIMUM_PIXELS = 100  # for a ratio of shares


def times_as_many(rows: Rows, comparison: Comparison) -> str:
    """Returns a text: the ratio of pixels that own and compared motion predict; "" without enough pixels."""
    column = comparison.column
    chosen = [row for row in rows if row["component"] in comparison.components or not comparison.components]
    chosen = [row for row in chosen if row.get(column, {}).get("pixels", 0) >= MINIMUM_PIXELS]
    found = {f"{label(row)}, {row['component']}": (row[column]["own"], row[column]["surface"]) for row in chosen}
    ratios = {name: own / surface for name, (own, surface) in found.items() if surface > 0.0}
    if not ratios:
        return ""
    (low, lowest), (high, highest) = (choose((ratio, name) for name, ratio in ratios.items()) for choose in (min, max))
    fewer = sum(own < surface for own, surface in found.values())
    none = sum(surface == 0.0 < own for own, surface in found.values())
    return (
        f"Pixels that own motion predicts, over those that the compared motion predicts, of {comparison.label}: median "
        f"{np.median(list(ratios.values())):.2f}, lowest {low:.2f} ({lowest}), highest {high:.2f} ({highest}); "
        f"fewer in {fewer} of {len(found)}; no ratio in {none}, where the compared motion predicts none."
    )


@dataclass(frozen=True)
class CostRatio:
    """CPU seconds of a mode's phase over those of another one, and the maximum of their ratio."""

    label: str
    mode: str
    phase: str
    other_mode: str
    other_phase: str
    maximum: float | None = None

    @property
    def column(self) -> str:
        return f"{self.label}, ≤ {self.maximum:g}" if self.maximum else self.label

    def of(self, rows: Rows) -> list[float]:
        """Returns the ratios of runs with the same seed."""
        ours = {row["seed"]: row["seconds"][self.phase] for row in rows if row["mode"] == self.mode}
        theirs = {row["seed"]: row["seconds"][self.other_phase] for row in rows if row["mode"] == self.other_mode}
        return [ours[seed] / theirs[seed] for seed in ours if theirs.get(seed, 0.0) > 0.0]


COSTS = (
    CostRatio("sampling of components / without", "components", "sample", "combined", "sample", 1.05),
    CostRatio("with surfaces, too", "components-surfaces", "sample", "combined", "sample"),
    CostRatio("reconstruction of components / without", "components", "reconstruct", "combined", "reconstruct", 1.5),
    CostRatio("motion / sampling", "components-motion", "correspondence", "components-motion", "sample", 0.03),
)


def cost(rows: Rows) -> list[Block]:
    """Table of cost ratios, medians over the seeds, of runs on an idle machine."""
    by_label: dict[str, Rows] = defaultdict(list)
    for row in (row for row in rows if is_timed([row])):
        by_label[label(row)].append(row)
    made = Table(["scene", *(ratio.column for ratio in COSTS), "repeats"])
    exceeding: dict[str, list[str]] = defaultdict(list)
    for name, of_scene in by_label.items():
        found = [ratio.of(of_scene) for ratio in COSTS]
        medians = [float(np.median(values)) if values else None for values in found]
        made.rows.append([name, *(number(median, ".3f") for median in medians), str(max(map(len, found)))])
        for ratio, median in zip(COSTS, medians, strict=True):
            if median is not None and ratio.maximum and median > ratio.maximum:
                exceeding[ratio.label].append(f"{name} ({median:.3f})")
    missed = listed([f"{name} in {', '.join(scenes)}" for name, scenes in exceeding.items()])
    text = f"### Cost of components and of their motion\n\nCPU time of frames of 16 samples. Missed: {missed}."
    return [Text(text), made] if made.rows else []


def sheets() -> list[Block]:
    """Pictures of the project's own scenes."""
    shown = []
    for name in (animation.name for animation in ANIMATIONS if animation.scene.own):
        about = f"{name}: components, their motion, and errors of the prediction"
        shown.append(Figure(motion_pictures.file_name(name), about))
        about = f"{name}: one component over the frames, and its difference from the next one"
        shown.append(Figure(motion_pictures.strip_name(name), about))
    found = [figure for figure in shown if (OUT / figure.file).exists()]
    legend = [Figure("error-scale.svg", "errors of prediction; gray pixels are not measured")]
    return [Text("### Components, their motion, and its prediction"), *legend, *found] if found else []
