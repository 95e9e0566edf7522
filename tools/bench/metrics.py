"""Error measures of stills, in scene-linear RGB; docs/benchmark/README.md defines them.

All images are float arrays (height, width, 3). `reference_variance` is the variance of the reference's own mean, per
pixel and channel; it is subtracted, so that the noise of the reference does not count as error.
"""

from __future__ import annotations

import numpy as np

EPSILON = 1e-3
LUMINANCE = np.array((0.2126, 0.7152, 0.0722))


def relative_squared_error(
    image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray | None = None
) -> np.ndarray:
    """Returns the mean over channels of ((x - r)^2 - var r) / relative_to(r) for each pixel (height, width)."""
    squared = (image - reference) ** 2
    if reference_variance is not None:
        squared = squared - reference_variance
    return squared.mean(axis=2) / relative_to(reference)


def relative_to(reference: np.ndarray) -> np.ndarray:
    """Returns eps + g^2 (..., height, width), what squared errors are divided by. g is the median gray of 3x3 pixels.

    reference: (..., height, width, 3). The gray of single pixels would be large where the reference met a rare bright
    path, and would hide that an image lacks the light of such paths.
    """
    gray = reference.mean(axis=-1)
    padded = np.pad(gray, [(0, 0)] * (gray.ndim - 2) + [(1, 1), (1, 1)], mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(-2, -1))
    return EPSILON + np.median(around, axis=(-2, -1)) ** 2


def rel_mse(image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray | None = None) -> float:
    return float(relative_squared_error(image, reference, reference_variance).mean())


def rel_mse_trimmed(
    image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray | None = None, share: float = 1e-3
) -> float:
    """relMSE without the worst 0.1 % of the pixels: the gap to relMSE measures fireflies."""
    error = np.sort(relative_squared_error(image, reference, reference_variance), axis=None)
    keep = error.size - int(np.ceil(error.size * share))
    return float(error[:keep].mean())


def smape(image: np.ndarray, reference: np.ndarray) -> float:
    return float((np.abs(image - reference) / (np.abs(image) + np.abs(reference) + EPSILON)).mean())


def log_mse(image: np.ndarray, reference: np.ndarray) -> float:
    """Returns the mean squared error of log(1 + x).

    Negative values, which unbiased reconstructions have, count as 0.
    """
    return float(((np.log1p(np.maximum(image, 0.0)) - np.log1p(np.maximum(reference, 0.0))) ** 2).mean())


def ssim(image: np.ndarray, reference: np.ndarray) -> float:
    """Returns the structural similarity (Wang et al. 2004) of displayed luminance.

    The reference's 98th percentile is white.
    """
    white = white_of(reference)
    a, b = (displayed(x, white) @ LUMINANCE for x in (image, reference))
    mean_a, mean_b = blurred(a), blurred(b)
    var_a, var_b = blurred(a * a) - mean_a**2, blurred(b * b) - mean_b**2
    covariance = blurred(a * b) - mean_a * mean_b
    c1, c2 = 0.01**2, 0.03**2
    numerator = (2 * mean_a * mean_b + c1) * (2 * covariance + c2)
    return float((numerator / ((mean_a**2 + mean_b**2 + c1) * (var_a + var_b + c2))).mean())


def flip(image: np.ndarray, reference: np.ndarray) -> float:
    """Returns the mean HDR-FLIP (Andersson et al. 2021) over its automatic range of exposures, by NVIDIA's
    implementation.
    """
    import flip_evaluator

    pair = (np.maximum(x, 0.0).astype(np.float32) for x in (reference, image))
    return float(flip_evaluator.evaluate(*pair, "HDR", applyMagma=False)[1])


def mean_light(image: np.ndarray, reference: np.ndarray) -> float:
    """Returns by how much the mean of the image exceeds that of the reference, relative to the latter."""
    return float(image.mean() / max(reference.mean(), 1e-12)) - 1.0


def all_errors(image: np.ndarray, reference: np.ndarray, reference_variance: np.ndarray) -> dict[str, float]:
    """Returns all measures of a still by their names in stored rows."""
    return {
        "relmse": rel_mse(image, reference, reference_variance),
        "relmse_trimmed": rel_mse_trimmed(image, reference, reference_variance),
        "smape": smape(image, reference),
        "log_mse": log_mse(image, reference),
        "ssim": ssim(image, reference),
        "flip": flip(image, reference),
        "mean_light": mean_light(image, reference),
    }


def white_of(reference: np.ndarray) -> float:
    """Returns the radiance that is displayed as white."""
    return max(float(np.percentile(reference, 98.0)), 1e-6)


def displayed(image: np.ndarray, white: float) -> np.ndarray:
    return np.clip(image / white, 0.0, 1.0) ** (1.0 / 2.2)


def blurred(plane: np.ndarray) -> np.ndarray:
    """Returns a plane blurred by SSIM's window (11 pixels, sigma 1.5), without the border that the window does not fit
    in.
    """
    weights = np.exp(-(np.arange(-5, 6) ** 2) / (2 * 1.5**2))
    weights /= weights.sum()
    rows = np.lib.stride_tricks.sliding_window_view(plane, 11, axis=0) @ weights
    return np.lib.stride_tricks.sliding_window_view(rows, 11, axis=1) @ weights


def equal_time_ratio(ours: list[tuple[float, float]], theirs: list[tuple[float, float]]) -> float | None:
    """Returns the geometric mean of error(ours)/error(theirs) at equal CPU time, or None if the curves share no range
    of time.

    Curves are lists of (CPU seconds, error). Both are interpolated log-log over the range of time that they share, and
    extrapolated by a factor of at most 1.25. A curve of a single point is compared at its time. Two single points
    cannot be compared.
    """
    if len(ours) < 2 and len(theirs) < 2:
        return None
    a = np.log(np.array(sorted(ours)))
    b = np.log(np.array(sorted(theirs)))
    slack = np.log(1.25)
    low = max(a[0, 0], b[0, 0])
    high = min(a[-1, 0], b[-1, 0])
    if high < low - slack:
        return None
    single = next((curve[0, 0] for curve in (a, b) if len(curve) < 2), None)
    times = np.linspace(min(low, high), max(low, high), 16) if single is None else np.array([single])
    return float(np.exp(np.mean(_interpolate(times, a) - _interpolate(times, b))))


def speed_up(ours: list[tuple[float, float]], theirs: list[tuple[float, float]]) -> float | None:
    """Returns the geometric mean of time(theirs)/time(ours) at equal error, over the errors that both reach."""
    return equal_time_ratio([(error, time) for time, error in theirs], [(error, time) for time, error in ours])


def slope(curve: list[tuple[float, float]]) -> float | None:
    """Returns the exponent of error against CPU time over the last decade of time.

    It is -1 for an unbiased estimator.
    """
    points = np.log(np.array(sorted(curve)))
    points = points[points[:, 0] >= points[-1, 0] - np.log(10.0) - 1e-9]
    return float(np.polyfit(points[:, 0], points[:, 1], 1)[0]) if len(points) > 1 else None


def _interpolate(times: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Interpolates linearly and continues the end segments."""
    values = np.interp(times, curve[:, 0], curve[:, 1])
    if len(curve) < 2:
        return values
    for end, inner, beyond in ((0, 1, times < curve[0, 0]), (-1, -2, times > curve[-1, 0])):
        gradient = (curve[end, 1] - curve[inner, 1]) / (curve[end, 0] - curve[inner, 0])
        values = np.where(beyond, curve[end, 1] + gradient * (times - curve[end, 0]), values)
    return values
