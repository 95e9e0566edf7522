"""Bias and variance of a mode, from the sum of the images of all seeds, which is kept in the user's cache folder."""

from __future__ import annotations

import numpy as np
import paths
from metrics import rel_mse

CACHE = paths.CACHE / "seeds"


class SeedSum:
    """Sum of the images of one mode, scene and sample count."""

    def __init__(self, key: str) -> None:
        self._path = CACHE / f"{key}.npz"
        self._seeds: list[int] = []
        self._sum: np.ndarray | float = 0.0
        if self._path.exists():
            stored = np.load(self._path)
            self._seeds, self._sum = stored["seeds"].tolist(), stored["sum"].astype(np.float64)

    def add(self, seed: int, image: np.ndarray) -> None:
        """Adds an image and stores the sum. A seed that is in the sum already is not added again."""
        if seed in self._seeds:
            return
        self._seeds, self._sum = [*self._seeds, seed], self._sum + image
        CACHE.mkdir(parents=True, exist_ok=True)
        unfinished = self._path.with_suffix(".unfinished.npz")
        np.savez(unfinished, seeds=np.array(self._seeds), sum=np.asarray(self._sum, np.float32))
        unfinished.rename(self._path)

    def errors(self, reference: np.ndarray, reference_variance: np.ndarray) -> dict[str, float]:
        """Returns relMSE of the mean over K seeds. With the mean relMSE of the seeds it gives bias_and_variance()."""
        mean = self._sum / len(self._seeds)
        error = rel_mse(np.asarray(mean), reference, reference_variance)
        return {"seeds_in_mean": len(self._seeds), "relmse_of_mean": error}


def bias_and_variance(mean_error: float, error_of_mean: float, count: int) -> tuple[float, float] | None:
    """Returns unbiased estimates of bias² and variance of one picture, or None for a single seed.

    The expected error of one picture is b² + v, and that of the mean of K pictures is b² + v/K.
    """
    if count < 2:
        return None
    variance = (mean_error - error_of_mean) * count / (count - 1)
    return error_of_mean - variance / count, variance
