"""The part of the report about flicker along the components' own ways: ratios of runs of one version alone, since the pixels that count
may be others in another one."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass

import motion_modes
import numpy as np
from animation_variants import Variant, of_row
from document import Block, Table, Text, number
from motion_modes import FLICKER, MODES, SOLVERS
from results import Point, SceneResults

HALF, WORSE = 0.5, 1.02  # F over that along surfaces alone: aim, and what no scene may exceed
F, RELMSE = "flicker_own", "relmse"
LOADED = "loaded"
OTHERS: dict[str, Callable[[str], str]] = {
    "windows": motion_modes.compared_with,
    "components along surfaces": motion_modes.along_surfaces,
}
MEASURES = {F: "F", RELMSE: "relMSE"}

Rows = list[dict]


def is_timed(rows: Rows) -> bool:
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
        versions = [{row["version"] for point in self.points.get(name, []) for row in point.rows} for name in (mode, other)]
        return len(versions[0] | versions[1]) == 1 and all(versions)

    def at_equal_samples(self, mode: str, other: str, measure: str, samples: int) -> float | None:
        """Median over the seeds that both have."""
        if not self.comparable(mode, other):
            return None
        ours, theirs = (
            {row["seed"]: row[measure] for point in self.points[name] if point.samples == samples for row in point.rows}
            for name in (mode, other)
        )
        ratios = [ours[seed] / theirs[seed] for seed in ours if seed in theirs]
        return float(np.median(ratios)) if ratios else None

    def at_equal_time(self, mode: str, other: str, measure: str) -> float | None:
        """Of curves of two counts or more; where times say nothing, of none."""
        if not self.comparable(mode, other) or not all(is_timed(point.rows) for name in (mode, other) for point in self.points[name]):
            return None
        return self.ratio(mode, other, measure)


def by_scene(rows: Rows) -> list[Flicker]:
    found: dict[tuple[str, Variant], Rows] = defaultdict(list)
    for row in rows:
        if row["mode"] in FLICKER:
            found[row["scene"], of_row(row)].append(row)
    return [Flicker(name, variant, of_one) for (name, variant), of_one in found.items()]


def blocks(rows: Rows) -> list[Block]:
    scenes = by_scene(rows)
    made: list[Block] = [Text("### Flicker along the components' own ways")]
    if (met := bars(scenes)).rows:
        made += [
            Text(f"Windows of components along their own ways, over what is told, in all scenes; aims ≤ {HALF:g} and ≤ {WORSE:g}:"),
            met,
        ]
    return [*made, Text("All runs:"), runs(scenes)]


# ------------------------------------------------------------------------------------------------ aims


@dataclass(frozen=True)
class Ratio:
    """How a mode is compared with another one: at equal time, or at equal samples, those of the most."""

    measure: str
    at_equal_time: bool

    @property
    def label(self) -> str:
        return f"{MEASURES[self.measure]} at equal {'time' if self.at_equal_time else 'samples'}"

    def of(self, scene: Flicker, mode: str, other: str) -> float | None:
        if self.at_equal_time:
            return scene.at_equal_time(mode, other, self.measure)
        counts = [point.samples for point in scene.points.get(mode, [])]
        return scene.at_equal_samples(mode, other, self.measure, counts[-1]) if counts else None


RATIOS = tuple(Ratio(measure, at_equal_time) for measure in MEASURES for at_equal_time in (True, False))


def bars(scenes: list[Flicker]) -> Table:
    made = Table(["solver", "over", "measure", "scenes", "median", "least", "most", f"≤ {HALF:g}", f"above {WORSE:g}"])
    for solver in SOLVERS:
        mode = f"windows-parts-{solver}"
        for label, other in OTHERS.items():
            for ratio in RATIOS:
                found = {name_of(scene, scenes): ratio.of(scene, mode, other(mode)) for scene in scenes}
                known = {name: value for name, value in found.items() if value is not None}
                if known:
                    made.rows.append([SOLVERS[solver].label, label, ratio.label, *summary(known)])
    return made


def name_of(scene: Flicker, scenes: list[Flicker]) -> str:
    """With its size where there are several."""
    return f"{scene.name} {scene.size}" if sum(scene.name == other.name for other in scenes) > 1 else scene.name


def summary(ratios: dict[str, float]) -> list[str]:
    """Number of scenes, median, extremes with their scenes, and which are within the first bar and beyond the second."""
    least, most = (choose(ratios, key=ratios.__getitem__) for choose in (min, max))
    cells = [str(len(ratios)), number(float(np.median(list(ratios.values()))), ".3f")]
    cells += [f"{ratios[name]:.3f} ({name})" for name in (least, most)]
    near = [name for name, value in ratios.items() if value <= HALF]
    worse = [name for name, value in ratios.items() if value > WORSE]
    return [*cells, *(", ".join(names) or "none" for names in (near, worse))]


# ------------------------------------------------------------------------------------------------ all runs


def runs(scenes: list[Flicker]) -> Table:
    made = Table(
        ["scene", "pixels", "mode", "spp", "seeds", "CPU-s a frame", "F along", "where it moves", "relMSE there", "relMSE of all",
         "F / windows", "relMSE / windows", "F / components along surfaces", "F at equal time / windows",
         "F at equal time / components along surfaces"]
    )  # fmt: skip
    for scene in scenes:
        for mode in (mode for mode in FLICKER if mode in scene.points):
            made.rows += [[scene.name, scene.size, MODES[mode].label, *cells_of(scene, mode, point)] for point in scene.points[mode]]
    return made


def cells_of(scene: Flicker, mode: str, point: Point) -> list[str]:
    windows, surfaces = (other(mode) for other in OTHERS.values())
    pairs = (windows, F), (windows, RELMSE), (surfaces, F)
    names = (F, "flicker_own_moving", "relmse_smooth", RELMSE)
    return [
        str(point.samples),
        str(len(point.rows)),
        number(point.median("cpu") / scene.variant.length) if is_timed(point.rows) else "–",
        *(number(point.median(name), ".4f") for name in names),
        *(number(scene.at_equal_samples(mode, other, measure, point.samples), ".3f") for other, measure in pairs),
        *(number(scene.at_equal_time(mode, other, F), ".3f") for other in (windows, surfaces)),
    ]
