"""Crops of pictures that the report shows magnified, chosen by the differences between error maps."""

from __future__ import annotations

import numpy as np

CROP = (80, 45)  # pixels


def window(x: int, y: int) -> tuple[slice, slice]:
    """Returns the rows and columns of the crop with this upper left corner."""
    return slice(y, y + CROP[1]), slice(x, x + CROP[0])


def choose_crops(errors: list[np.ndarray]) -> list[tuple[int, int]]:
    """Returns the corners of two crops that do not overlap and in which the best and the worst error map differ most.

    Errors of a pixel are limited to 1, so that fireflies do not decide.
    """
    height, width = errors[0].shape
    limited = [np.minimum(error, 1.0) for error in errors]

    def difference(corner: tuple[int, int]) -> float:
        means = [error[window(*corner)].mean() for error in limited]
        return float(max(means) - min(means))

    corners = [
        (x, y)
        for y in range(0, height - CROP[1] + 1, CROP[1] // 3)
        for x in range(0, width - CROP[0] + 1, CROP[0] // 4)
    ]
    first = max(corners, key=difference)
    others = [(x, y) for x, y in corners if abs(x - first[0]) >= CROP[0] or abs(y - first[1]) >= CROP[1]]
    return [first, max(others, key=difference)]
