"""Bias and variance apart, from the sum of the images of all seeds so far, which is kept in the user's cache folder."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from metrics import rel_mse

CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "gradus" / "seeds"


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
        if seed in self._seeds:
            return
        self._seeds, self._sum = [*self._seeds, seed], self._sum + image
        CACHE.mkdir(parents=True, exist_ok=True)
        unfinished = self._path.with_suffix(".unfinished.npz")
        np.savez(unfinished, seeds=np.array(self._seeds), sum=np.asarray(self._sum, np.float32))
        unfinished.rename(self._path)

    def errors(self, reference: np.ndarray, reference_variance: np.ndarray) -> dict[str, float]:
        """relMSE of the mean over K seeds. With the mean relMSE of the seeds it gives variance and bias: bias_and_variance()."""
        mean = self._sum / len(self._seeds)
        return {"seeds_in_mean": len(self._seeds), "relmse_of_mean": rel_mse(np.asarray(mean), reference, reference_variance)}


def bias_and_variance(mean_error: float, error_of_mean: float, count: int) -> tuple[float, float] | None:
    """bias² and variance of one picture, both without bias: E[error of one] = b² + v and E[error of the mean of K] = b² + v/K."""
    if count < 2:
        return None
    variance = (mean_error - error_of_mean) * count / (count - 1)
    return error_of_mean - variance / count, variance
