"""The part of the report about flicker along the motion of components.

Only runs of the same commit and Blender are compared: another commit may measure other pixels, and another Blender has
other peers.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import motion_modes
import numpy as np
from animation_variants import Variant, of_row
from document import Block, Table, Text, number
from motion_modes import FLICKER, MODES, SOLVERS
from records import Row
from results import Point, SceneResults

TARGET, MAXIMUM = 0.5, 1.02  # ratios of F: the target, and what no scene may exceed
F, RELMSE = "flicker_component", "relmse"
LOADED = "loaded"
# Modes that a mode is compared with.
OTHERS: dict[str, Callable[[str], str]] = {
    "windows": motion_modes.compared_with,
    "components along surfaces": motion_modes.along_surfaces,
}
LABELS = {F: "F", RELMSE: "relMSE"}

Rows = list[Row]


def is_timed(rows: Rows) -> bool:
    """Returns whether all runs were made on an idle machine."""
    return not any(row.get(LOADED, False) for row in rows)


class Flicker(SceneResults):
    """Runs of one scene in one variant."""

    def __init__(self, name: str, variant: Variant, rows: Rows) -> None:
        super().__init__(name, rows)
        self.variant = variant

    @property
    def size(self) -> str:
        return f"{self.variant.size[0]}×{self.variant.size[1]}"

    def comparable(self, mode: str, other: str) -> bool:
        """Returns whether both modes were run, and with the same commit and Blender."""
        rows = [[row for point in self.points.get(name, []) for row in point.rows] for name in (mode, other)]
        return all(rows) and len({(row["version"], row["blender"]) for found in rows for row in found}) == 1

    def at_equal_samples(self, mode: str, other: str, measure: str, samples: int) -> float | None:
        """Returns the median of the ratios over the seeds that both modes have."""
        if not self.comparable(mode, other):
            return None
        ours, theirs = (
            {row["seed"]: row[measure] for point in self.points[name] if point.samples == samples for row in point.rows}
            for name in (mode, other)
        )
        ratios = [ours[seed] / theirs[seed] for seed in ours if seed in theirs]
        return float(np.median(ratios)) if ratios else None

    def at_equal_time(self, mode: str, other: str, measure: str) -> float | None:
        """Returns the ratio at equal CPU time, if both were run on an idle machine."""
        if not self.comparable(mode, other):
            return None
        if not all(is_timed(point.rows) for name in (mode, other) for point in self.points[name]):
            return None
        return self.ratio(mode, other, measure)


def by_scene(rows: Rows) -> list[Flicker]:
    """Returns the runs of each scene and variant."""
    found: dict[tuple[str, Variant], Rows] = defaultdict(list)
    for row in rows:
        if row["mode"] in FLICKER:
            found[row["scene"], of_row(row)].append(row)
    return [Flicker(name, variant, of_one) for (name, variant), of_one in found.items()]


def blocks(rows: Rows) -> list[Block]:
    scenes = by_scene(rows)
    made: list[Block] = [Text("### Flicker along the motion of components")]
    if (summaries := summary_table(scenes)).rows:
        about = "Windows of components along their own motion, over another mode, in all scenes"
        made += [Text(f"{about}; the target is ≤ {TARGET:g}, and no scene may exceed {MAXIMUM:g}:"), summaries]
    return [*made, Text("All runs:"), runs(scenes)]


@dataclass(frozen=True)
class Ratio:
    """A way to compare two modes: a measure, at equal CPU time or at the highest common sample count."""

    measure: str
    at_equal_time: bool

    @property
    def label(self) -> str:
        return f"{LABELS[self.measure]} at equal {'time' if self.at_equal_time else 'samples'}"

    def of(self, scene: Flicker, mode: str, other: str) -> float | None:
        if self.at_equal_time:
            return scene.at_equal_time(mode, other, self.measure)
        counts = [point.samples for point in scene.points.get(mode, [])]
        return scene.at_equal_samples(mode, other, self.measure, counts[-1]) if counts else None


RATIOS = tuple(Ratio(measure, at_equal_time) for measure in LABELS for at_equal_time in (True, False))


def summary_table(scenes: list[Flicker]) -> Table:
    """Table of all ratios over all scenes."""
    columns = [
        "solver",
        "over",
        "measure",
        "scenes",
        "median",
        "lowest",
        "highest",
        f"≤ {TARGET:g}",
        f"above {MAXIMUM:g}",
    ]
    made = Table(columns)
    for solver in SOLVERS:
        mode = f"windows-components-{solver}"
        for label, other in OTHERS.items():
            for ratio in RATIOS:
                found = {name_of(scene, scenes): ratio.of(scene, mode, other(mode)) for scene in scenes}
                known = {name: value for name, value in found.items() if value is not None}
                if known:
                    made.rows.append([SOLVERS[solver].label, label, ratio.label, *summary(known)])
    return made


def name_of(scene: Flicker, scenes: list[Flicker]) -> str:
    """Names a scene, with its size if there are several sizes of it."""
    return f"{scene.name} {scene.size}" if sum(scene.name == other.name for other in scenes) > 1 else scene.name


def summary(ratios: dict[str, float]) -> list[str]:
    """Returns the cells of a row: number of scenes, median, extremes, and scenes that meet the target or exceed the
    maximum.
    """
    lowest, highest = (choose(ratios, key=ratios.__getitem__) for choose in (min, max))
    cells = [str(len(ratios)), number(float(np.median(list(ratios.values()))), ".3f")]
    cells += [f"{ratios[name]:.3f} ({name})" for name in (lowest, highest)]
    met = [name for name, value in ratios.items() if value <= TARGET]
    exceeding = [name for name, value in ratios.items() if value > MAXIMUM]
    return [*cells, *(", ".join(names) or "none" for names in (met, exceeding))]


def runs(scenes: list[Flicker]) -> Table:
    """Table of all runs."""
    measures = ["CPU-s a frame", "F along", "where it moves", "relMSE there", "relMSE of all"]
    at_samples = ["F / windows", "relMSE / windows", "F / components along surfaces"]
    at_time = ["F at equal time / windows", "F at equal time / components along surfaces"]
    made = Table(["scene", "pixels", "mode", "spp", "seeds", *measures, *at_samples, *at_time])
    for scene in scenes:
        for mode in (mode for mode in FLICKER if mode in scene.points):
            made.rows += [
                [scene.name, scene.size, MODES[mode].label, *cells_of(scene, mode, point)]
                for point in scene.points[mode]
            ]
    return made


def cells_of(scene: Flicker, mode: str, point: Point) -> list[str]:
    windows, surfaces = (other(mode) for other in OTHERS.values())
    pairs = (windows, F), (windows, RELMSE), (surfaces, F)
    names = (F, "flicker_component_moving", "relmse_specular", RELMSE)
    return [
        str(point.samples),
        str(len(point.rows)),
        number(point.median("cpu") / scene.variant.length) if is_timed(point.rows) else "–",
        *(number(point.median(name), ".4f") for name in names),
        *(number(scene.at_equal_samples(mode, other, measure, point.samples), ".3f") for other, measure in pairs),
        *(number(scene.at_equal_time(mode, other, F), ".3f") for other in (windows, surfaces)),
    ]
