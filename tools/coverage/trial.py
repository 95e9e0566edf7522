"""Renders a row with both engines and judges it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from gradus import cycles_settings, store
from support import images

from . import cryptomatte, difference, light_passes, stages
from .row import EXACT, FAINT, NOISY, Build, Row

AGREES, NO_EFFECT, DIFFERS, FALLS_BACK = "agrees", "no effect", "differs", "falls back"
MISSING, FAILS, NOT_SHOWN = "missing", "fails", "not shown"

AS_IN_CYCLES = "as in Cycles"
"""How warnings end that tell of no difference, but of something that artists of Cycles may not expect either."""

SEED = 7
LADDERS = {EXACT: (1, 32, 256), NOISY: (32, 128, 512, 2048), FAINT: (128, 512, 2048, 8192)}
"""Samples by those of a row. One that differs is rendered again with more, in case that noise made it differ."""


@dataclass(frozen=True)
class Outcome:
    family: str
    name: str
    verdict: str
    note: str = ""  # what Gradus warned about, or how the pictures differ
    size: float = 0.0  # of the difference, for the order of a list
    is_clear: bool = False  # noise is not the cause of the difference

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


class Judge:
    """Judges rows one after another. Keeps the pictures that rows share.

    tells_effects: whether rows without an effect are distinguished from others, which takes a further picture of many.
    """

    def __init__(self, folder: Path, tells_effects: bool = True) -> None:
        self._folder = folder
        self._tells_effects = tells_effects
        self._bases: dict[tuple[str, int], images.Passes | None] = {}

    def run(self, row: Row) -> Outcome:
        outcome = Outcome(row.family, row.name, NOT_SHOWN)
        for samples in LADDERS[row.samples]:
            outcome = self._attempt(row, samples)
            if outcome.verdict != DIFFERS or outcome.is_clear:
                break
        return outcome

    def _attempt(self, row: Row, samples: int) -> Outcome:
        try:
            stages.prepare(samples, SEED)
            row.build()
            expected = self._render("CYCLES", samples)
        except Exception as error:  # a row that cannot be made is a gap of the table, not its end
            return Outcome(row.family, row.name, NOT_SHOWN, _text(error))
        try:
            found = self._render("GRADUS", samples)
        except (RuntimeError, AssertionError) as error:
            text = _text(error)
            return Outcome(row.family, row.name, FALLS_BACK if "Gradus: " in text else FAILS, text)
        warnings = [text for summary in store.summaries.values() for text in summary.get("warnings", ())]
        warnings = [text for text in warnings if not text.endswith(AS_IN_CYCLES)]
        if warnings:
            return Outcome(row.family, row.name, FALLS_BACK, "; ".join(sorted(set(warnings))))
        missing = sorted(set(expected) - set(found))
        if missing:
            return Outcome(row.family, row.name, MISSING, ", ".join(missing))
        worst, where = worst_difference(expected, found)
        if not worst.agrees:
            note = _describe(worst, where, expected, found)
            return Outcome(row.family, row.name, DIFFERS, note, worst.size, worst.is_clear)
        is_idle = self._tells_effects and self._is_idle(row, expected)
        return Outcome(row.family, row.name, NO_EFFECT if is_idle else AGREES)

    def _render(self, engine: str, samples: int) -> images.Passes:
        """Returns the passes of all view layers by their full names."""
        scene = bpy.context.scene
        scene.render.engine = engine
        if engine == "CYCLES":
            passes = images.render(scene, self._folder)
        else:
            cycles_settings.copy(scene)
            settings = {"samples": samples, "seed": SEED, "integrator": "PATH", "reconstruction": "NONE"}
            passes = images.render(scene, self._folder, **settings)
        return {name: image for name, image in passes.items() if "." in name} or passes

    def _is_idle(self, row: Row, expected: images.Passes) -> bool:
        """Returns whether Cycles renders the same without the row's feature."""
        key = (row.base_name, row.samples)
        if key not in self._bases:
            self._bases[key] = self._picture_of(row.base, row.samples)
        base = self._bases[key]
        return (
            base is not None
            and base.keys() == expected.keys()
            and all(np.array_equal(base[name], image, equal_nan=True) for name, image in expected.items())
        )

    def _picture_of(self, build: Build, samples: int) -> images.Passes | None:
        try:
            stages.prepare(samples, SEED)
            build()
            return self._render("CYCLES", samples)
        except Exception:  # without a base, the row counts as one that has an effect
            return None


def worst_difference(expected: images.Passes, found: images.Passes) -> tuple[difference.Difference, str]:
    """Returns the largest difference, of those that are too large if there are any, and the name of its pass."""
    measured = [(_difference(expected, found, name), name) for name in expected]
    return max(measured, key=lambda item: (not item[0].agrees, item[0].size))


def _difference(expected: images.Passes, found: images.Passes, name: str) -> difference.Difference:
    group = cryptomatte.group(name)
    if group is None:
        return difference.compare(*(light_passes.multiplied(passes, name) for passes in (expected, found)))
    planes = [cryptomatte.coverage(passes, group) for passes in (expected, found)]
    identifiers = sorted(planes[0].keys() | planes[1].keys())
    return difference.compare(*(cryptomatte.stacked(each, identifiers, expected[name]) for each in planes))


def _describe(worst: difference.Difference, where: str, expected: images.Passes, found: images.Passes) -> str:
    colors = [_means(light_passes.multiplied(passes, where)) for passes in (expected, found)]
    name = where.rpartition(".")[2]
    place = "" if name == "Combined" else f"{name}: "
    return f"{place}{worst.blocks:.0%} of the blocks, mean {colors[1]} instead of {colors[0]}"


def _means(image: np.ndarray) -> str:
    return " ".join(f"{value:.3g}" for value in np.nan_to_num(image).mean(axis=(0, 1)))


def _text(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return f"{type(error).__name__}: {lines[0][:200] if lines else ''}"
