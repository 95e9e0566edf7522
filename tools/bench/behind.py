"""Finds scenes in which Cycles with its denoiser has less error at equal CPU time, and why: by bias or by variance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from metrics import rel_mse, relative_squared_error, relative_to
from renderers import Renderers
from results import SceneResults
from seeds import bias_and_variance

OURS, THEIRS = ("path-regularized", "auto-denoised"), "cycles-denoised"
SEEDS = 8


@dataclass
class Spread:
    """Images of one mode with different seeds."""

    images: np.ndarray  # (seeds, height, width, channels)
    reference: tuple[np.ndarray, np.ndarray]

    def parts(self) -> tuple[float, float]:
        """Returns bias² and variance of relMSE."""
        mean_error = float(np.mean([rel_mse(image, *self.reference) for image in self.images]))
        found = bias_and_variance(mean_error, rel_mse(self.images.mean(axis=0), *self.reference), len(self.images))
        assert found
        return found

    def bias_map(self) -> np.ndarray:
        """Returns the relative squared error of the mean over the seeds."""
        return relative_squared_error(self.images.mean(axis=0), *self.reference)

    def variance_map(self) -> np.ndarray:
        return self.images.var(axis=0, ddof=1).mean(axis=2) / relative_to(self.reference[0])


def modes_behind(scene: SceneResults) -> list[str]:
    """Returns those of our main modes that have more error than the peer, by relMSE or HDR-FLIP."""

    def is_behind(mode: str) -> bool:
        return any((scene.ratio(mode, THEIRS, measure) or 0.0) > 1.0 for measure in ("relmse", "flip"))

    return [mode for mode in OURS if is_behind(mode)]


def render_spread(renderers: Renderers, mode: str, samples: int, reference: tuple[np.ndarray, np.ndarray]) -> Spread:
    return Spread(np.stack([renderers.render(mode, samples, seed)[0] for seed in range(SEEDS)]), reference)
