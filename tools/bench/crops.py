"""Parts of pictures that are shown magnified: chosen by a rule, not by hand."""

from __future__ import annotations

import numpy as np

CROP = (80, 45)


def window(x: int, y: int) -> tuple[slice, slice]:
    return slice(y, y + CROP[1]), slice(x, x + CROP[0])


def choose_crops(errors: list[np.ndarray]) -> list[tuple[int, int]]:
    """Corners of the two windows that do not overlap in which errors of the reconstructions are furthest apart, the best one's from the
    worst one's. A pixel's error counts up to 1: fireflies decide nothing."""
    height, width = errors[0].shape
    limited = [np.minimum(error, 1.0) for error in errors]

    def apart(corner: tuple[int, int]) -> float:
        means = [error[window(*corner)].mean() for error in limited]
        return float(max(means) - min(means))

    corners = [(x, y) for y in range(0, height - CROP[1] + 1, CROP[1] // 3) for x in range(0, width - CROP[0] + 1, CROP[0] // 4)]
    first = max(corners, key=apart)
    others = [(x, y) for x, y in corners if abs(x - first[0]) >= CROP[0] or abs(y - first[1]) >= CROP[1]]
    return [first, max(others, key=apart)]
