"""The newest results of stills by scene and mode, and the figures that are computed from them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import records
from metrics import equal_time_ratio, slope, speed_up
from modes import MODES, REFERENCES
from records import Row
from scenes import SCENES
from seeds import bias_and_variance

STILLS = records.file_of("stills")
Curve = list[tuple[float, float]]


@dataclass
class Point:
    """All runs of one mode at one sample count, one for each seed."""

    samples: int
    rows: list[Row]

    def median(self, measure: str) -> float | None:
        values = [row[measure] for row in self.rows if measure in row]
        return float(np.median(values)) if values else None

    def range(self, measure: str) -> tuple[float, float, float] | None:
        """Returns median, minimum and maximum over the seeds."""
        values = [row[measure] for row in self.rows if measure in row]
        return (float(np.median(values)), min(values), max(values)) if values else None

    def first(self, name: str) -> dict | int | None:
        """Returns a value that only the first seed's row has, such as ray counts and times of stages."""
        return next((row[name] for row in self.rows if name in row), None)

    def bias_and_variance(self) -> tuple[float, float] | None:
        """Returns bias² and variance of relMSE over all seeds, or None if the sum of all their images is not known."""
        whole = [row for row in self.rows if row.get("seeds_in_mean") == len(self.rows)]
        if not whole:
            return None
        mean_error = float(np.mean([row["relmse"] for row in self.rows]))
        return bias_and_variance(mean_error, whole[-1]["relmse_of_mean"], len(self.rows))


class SceneResults:
    """The newest runs of one scene. Points are named by mode, and by mode and "@4" for runs with four bounces."""

    def __init__(self, name: str, rows: list[Row]) -> None:
        self.name, self.rows = name, rows
        by_mode: dict[str, dict[int, list[Row]]] = defaultdict(lambda: defaultdict(list))
        for row in rows:
            by_mode[mode_of(row)][row["samples"]].append(row)
        self.points = {
            mode: [Point(n, found) for n, found in sorted(counts.items())] for mode, counts in by_mode.items()
        }
        self.diffuse_interior = any(s.name == name and s.diffuse_interior for s in SCENES)

    def modes(self) -> list[str]:
        return [mode for mode in MODES if mode in self.points]

    def curve(self, mode: str, measure: str = "relmse", with_export: bool = True) -> Curve | None:
        """Returns (median CPU seconds, median error) for each sample count."""
        if mode not in self.points:
            return None
        fixed = 0.0 if with_export else self.fixed_cost(MODES[mode].engine)
        found = [(point.median("cpu"), point.median(measure)) for point in self.points[mode]]
        return [
            (max(time - fixed, 1e-3), max(error, 1e-9))
            for time, error in found
            if time is not None and error is not None
        ] or None

    def fixed_cost(self, engine: str) -> float:
        """Returns the CPU seconds of export, build and writing: those of plain path tracing, extrapolated to no
        samples.
        """
        points = self.points.get(REFERENCES[engine], [])
        if len(points) < 2:
            return 0.0
        (low, high), (first, last) = [
            [p.median("cpu") or 0.0 for p in (points[0], points[-1])],
            (points[0], points[-1]),
        ]
        return max(0.0, low - (high - low) / (last.samples - first.samples) * first.samples)

    def ratio(self, mode: str, other: str, measure: str = "relmse", with_export: bool = True) -> float | None:
        """Returns the error of a mode over that of another one at equal CPU time."""
        curves = self.curve(mode, measure, with_export), self.curve(other, measure, with_export)
        return equal_time_ratio(*curves) if curves[0] and curves[1] else None

    def speed_up(self, mode: str, other: str) -> float | None:
        """Returns the CPU time of the other mode over that of this one at equal error."""
        curves = self.curve(mode), self.curve(other)
        return speed_up(*curves) if curves[0] and curves[1] else None

    def slope(self, mode: str) -> float | None:
        """Returns the slope over the last decade of time, without export and build, which would bend the curve."""
        curve = self.curve(mode, with_export=False)
        return slope(curve) if curve else None

    def sample_cost(self, mode: str) -> float | None:
        """Returns CPU microseconds per sample: the slope between the smallest and the largest count."""
        points = self.points.get(mode, [])
        if len(points) < 2:
            return None
        cpu = (points[-1].median("cpu") or 0.0) - (points[0].median("cpu") or 0.0)
        row = points[0].rows[0]
        return 1e6 * cpu / (row["width"] * row["height"] * (points[-1].samples - points[0].samples))

    def denoiser_cost(self) -> float | None:
        """Returns CPU microseconds per pixel of the denoiser, by which Cycles takes longer; median over the counts."""
        plain = {point.samples: point.median("cpu") for point in self.points.get("cycles", [])}
        points = [point for point in self.points.get("cycles-denoised", []) if point.samples in plain]
        pixels = [point.rows[0]["width"] * point.rows[0]["height"] for point in points]
        more = [1e6 * (p.median("cpu") - plain[p.samples]) / n for p, n in zip(points, pixels, strict=True)]
        return float(np.median(more)) if more else None

    def same_samples_ratios(self, mode: str, other: str) -> dict[int, float]:
        """Returns relMSE over that of another mode by sample count, each the median over the seeds that both have."""
        found = {}
        for point in self.points.get(mode, []):
            others = [p for p in self.points.get(other, []) if p.samples == point.samples]
            theirs = {row["seed"]: row["relmse"] for p in others for row in p.rows}
            ratios = [row["relmse"] / theirs[row["seed"]] for row in point.rows if row["seed"] in theirs]
            if ratios:
                found[point.samples] = float(np.median(ratios))
        return found

    def estimate_ratio(self, mode: str) -> float | None:
        """Returns the error that a mode estimates over the true error of the same images, median over the counts."""
        rows = [row for point in self.points.get(mode, []) for row in point.rows if "estimated" in row]
        return float(np.median([row["estimated"] / row["relmse"] for row in rows])) if rows else None

    def cost_ratio(self, mode: str, other: str) -> float | None:
        """Returns the CPU time of a sample over that of another mode."""
        ours, theirs = self.sample_cost(mode), self.sample_cost(other)
        return ours / theirs if ours and theirs else None


def mode_of(row: Row) -> str:
    return f"{row['mode']}@{row['bounces']}" if "bounces" in row else row["mode"]


def load() -> list[SceneResults]:
    """Returns the scenes in the order of scenes.py. Of each scene only the runs of one commit, size and Blender can be
    compared: those with which path tracing was measured last.
    """
    rows = records.read(STILLS)
    newest = {row["scene"]: _conditions(row) for row in rows if row["mode"] == "path"}
    by_scene: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if row["mode"] in MODES and newest.get(row["scene"]) == _conditions(row):
            by_scene[row["scene"]].append(row)
    return [SceneResults(scene.name, by_scene[scene.name]) for scene in SCENES if scene.name in by_scene]


def _conditions(row: Row) -> tuple[str, int, str]:
    return row["version"], row["width"], row["blender"]
