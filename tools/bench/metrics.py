"""Error measures of the benchmark: definitions of docs/benchmark/README.md, in scene-linear RGB.

All images are float arrays (height, width, 3). `reference_variance` is the variance of the reference's own mean, per pixel and channel;
it is subtracted, so that an unconverged reference does not set a floor.
"""

from __future__ import annotations

import numpy as np

EPSILON = 1e-3


def relative_squared_error(image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray | None = None) -> np.ndarray:
    """Per-pixel mean over channels of ((x - r)^2 - var r) / (eps + gray(r)^2), shape (height, width)."""
    squared = (image - reference) ** 2
    if reference_variance is not None:
        squared = squared - reference_variance
    gray = reference.mean(axis=2)
    return squared.mean(axis=2) / (EPSILON + gray**2)


def rel_mse(image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray | None = None) -> float:
    return float(relative_squared_error(image, reference, reference_variance).mean())


def rel_mse_trimmed(image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray | None = None, share: float = 1e-3) -> float:
    """relMSE without the worst 0.1 % of the pixels: the gap to relMSE measures fireflies."""
    error = np.sort(relative_squared_error(image, reference, reference_variance), axis=None)
    keep = error.size - int(np.ceil(error.size * share))
    return float(error[:keep].mean())


def smape(image: np.ndarray, reference: np.ndarray) -> float:
    return float((np.abs(image - reference) / (np.abs(image) + np.abs(reference) + EPSILON)).mean())


def equal_time_ratio(ours: list[tuple[float, float]], theirs: list[tuple[float, float]]) -> float | None:
    """R: geometric mean of error(ours)/error(theirs) at equal CPU time.

    Curves are lists of (CPU seconds, error); both are interpolated log-log over the range of time that they share, with no extrapolation
    beyond a factor of 1.25. None where they share none.
    """
    a = np.log(np.array(sorted(ours)))
    b = np.log(np.array(sorted(theirs)))
    slack = np.log(1.25)
    low = max(a[0, 0], b[0, 0])
    high = min(a[-1, 0], b[-1, 0])
    if high < low - slack:
        return None
    times = np.linspace(min(low, high), max(low, high), 16)
    return float(np.exp(np.mean(_interpolate(times, a) - _interpolate(times, b))))


def slope(curve: list[tuple[float, float]]) -> float:
    """Exponent of error against CPU time, least squares in log-log; -1 for an unbiased estimator."""
    points = np.log(np.array(curve))
    return float(np.polyfit(points[:, 0], points[:, 1], 1)[0])


def _interpolate(times: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Piecewise linear, with the end segments continued."""
    values = np.interp(times, curve[:, 0], curve[:, 1])
    if len(curve) < 2:
        return values
    for end, inner, beyond in ((0, 1, times < curve[0, 0]), (-1, -2, times > curve[-1, 0])):
        gradient = (curve[end, 1] - curve[inner, 1]) / (curve[end, 0] - curve[inner, 0])
        values = np.where(beyond, curve[end, 1] + gradient * (times - curve[end, 0]), values)
    return values
