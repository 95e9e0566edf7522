"""Non-local means with half-buffers, as chapter 8 and NFOR use it.

Sources: Rousselle, Knaus, Zwicker 2012; Rousselle, Manzi, Zwicker 2013.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.ndimage import gaussian_filter, uniform_filter

EPSILON = 1e-10
WeightAt = Callable[
    [tuple[int, int]], np.ndarray
]  # weights at an offset: (height, width, 1 or as many channels as the image)


def window(radius: int) -> Iterator[tuple[int, int]]:
    """Yields the offsets (dy, dx) of a square, row by row."""
    reach = range(-radius, radius + 1)
    return ((dy, dx) for dy in reach for dx in reach)


def shifted(image: np.ndarray, dy: int, dx: int) -> np.ndarray:
    """Returns the image at p + (dy, dx); pixels outside the image are those of the border."""
    height, width = image.shape[:2]
    return image.take(np.arange(height) + dy, axis=0, mode="clip").take(np.arange(width) + dx, axis=1, mode="clip")


def inside(shape: tuple[int, ...], dy: int, dx: int) -> np.ndarray:
    """Returns 1 where p + (dy, dx) is in the image, else 0 (height, width, 1)."""
    height, width = shape[:2]
    rows, columns = np.arange(height) + dy, np.arange(width) + dx
    return (((rows >= 0) & (rows < height))[:, None] & ((columns >= 0) & (columns < width)))[:, :, None].astype(float)


def reached(shape: tuple[int, ...], dy: int, dx: int) -> bool:
    """Returns whether p + (dy, dx) is in the image for any p."""
    return abs(dy) < shape[0] and abs(dx) < shape[1]


def box(image: np.ndarray, radius: int) -> np.ndarray:
    return uniform_filter(image, size=(2 * radius + 1, 2 * radius + 1, 1), mode="nearest") if radius else image


def variance_of_mean(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Returns the variance of the mean of two halves: the larger of the raw and the blurred estimate (thesis 8.4).

    It is then neither noisy nor too small at outliers.
    """
    raw = 0.25 * (a - b) ** 2
    return np.maximum(raw, gaussian_filter(raw, sigma=(2.0, 2.0, 0.0), mode="nearest"))


def distance(
    guide: np.ndarray,
    variance: np.ndarray,
    offset: tuple[int, int],
    k: float,
    radius: int,
    tolerance: np.ndarray | None = None,
    other: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """Returns the squared difference of p and p + offset beyond their noise, relative to their noise, for each channel.

    It is the mean over small squares around both. `tolerance` replaces the variance in the denominator. p + offset is a
    pixel of the same image, or of the image and variance `other`.
    """
    there, noise_there = other or (guide, variance)
    noise = variance + shifted(noise_there, *offset)
    both = noise if tolerance is None else tolerance + shifted(tolerance, *offset)
    return box(((guide - shifted(there, *offset)) ** 2 - noise) / (EPSILON + k * k * both), radius)


def weight(distances: np.ndarray) -> np.ndarray:
    return np.exp(-np.maximum(distances, 0.0))


def average(image: np.ndarray, radius: int, weight_at: WeightAt) -> np.ndarray:
    """Returns the weighted mean over a window."""
    total, weights = np.zeros_like(image), 0.0
    for offset in window(radius):
        if not reached(image.shape, *offset):
            continue
        w = weight_at(offset) * inside(image.shape, *offset)
        total += w * shifted(image, *offset)
        weights = weights + w
    return total / weights


def filtered(halves: list[np.ndarray]) -> np.ndarray:
    """Returns the mean of both halves, each filtered over 11×11 pixels with weights from the other half, channel by
    channel.
    """
    variance = 2.0 * variance_of_mean(*halves)

    def by(guide: np.ndarray) -> WeightAt:
        return lambda offset: weight(distance(guide, variance, offset, 0.5, 3))

    a, b = halves
    return 0.5 * (average(a, 5, by(b)) + average(b, 5, by(a)))
