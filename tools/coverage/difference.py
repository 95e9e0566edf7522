"""Compares the pictures of two engines by blocks of pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BLOCK = 8
BLOCK_TOLERANCE, SHARE_OF_BLOCKS, MEAN_TOLERANCE = 0.02, 0.95, 0.01
DARK, FAINT = 0.5, 0.1
"""Parts of the picture's mean below which a difference is relative to that mean: for dark blocks, which have more noise
than light, and for channels that hardly show.
"""


@dataclass(frozen=True)
class Difference:
    """How far a picture is from the expected one."""

    mean: float  # largest relative difference of the means of a channel
    blocks: float  # share of the blocks that differ

    @property
    def agrees(self) -> bool:
        return self.mean <= MEAN_TOLERANCE and self.blocks <= 1.0 - SHARE_OF_BLOCKS

    @property
    def is_clear(self) -> bool:
        """Returns whether noise cannot be the cause."""
        return self.mean > 5.0 * MEAN_TOLERANCE and self.blocks > 0.5

    @property
    def size(self) -> float:
        """Orders differences: a picture that differs everywhere comes before one that differs at edges."""
        return min(self.mean, 1.0) + self.blocks


def block_means(image: np.ndarray) -> np.ndarray:
    """Returns the means of blocks (rows, columns, channels). Incomplete blocks at the border are left out."""
    height, width, channels = image.shape
    rows, columns = max(height // BLOCK, 1), max(width // BLOCK, 1)
    tall, wide = min(BLOCK, height), min(BLOCK, width)
    whole = image[: rows * tall, : columns * wide].astype(np.float64)
    return whole.reshape(rows, tall, columns, wide, channels).mean(axis=(1, 3))


def compare(expected: np.ndarray, found: np.ndarray) -> Difference:
    """Compares two pictures (height, width, channels). Pictures of another shape differ altogether."""
    if expected.shape != found.shape:
        return Difference(1.0, 1.0)
    wrong = ~np.isfinite(found) & np.isfinite(expected)
    if wrong.any():
        return Difference(1.0, float(wrong.any(axis=2).mean()))
    a, b = (block_means(np.nan_to_num(image, posinf=0.0, neginf=0.0)) for image in (expected, found))
    level = np.abs(a).mean(axis=(0, 1)) + 1e-4
    level = np.maximum(level, FAINT * level[:3].max())  # without alpha
    off = np.abs(a - b) > BLOCK_TOLERANCE * np.maximum(np.abs(a), DARK * level)
    mean = np.abs(a.mean(axis=(0, 1)) - b.mean(axis=(0, 1))) / level
    return Difference(float(mean.max()), float(off.any(axis=2).mean()))
