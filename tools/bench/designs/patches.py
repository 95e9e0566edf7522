"""Rows that hold every patch of the image to a linear function of its features (thesis 8, section 4)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .nlm import window

RADIUS = 2
TRUNCATION = 0.1  # c of the threshold τ
DROPPED = 1e-10  # pixels of less weight are dropped from the patch
RANK = 1e-6  # share of the largest singular value below which others are rounding errors

OFFSETS = list(window(RADIUS))


class Patches:
    """The operators P_p = D_p (B_p B_pᵀ − Id) Γ_p for all pixels p (equation 2)."""

    def __init__(self, features: np.ndarray, deviation: np.ndarray, weights: np.ndarray) -> None:
        """Makes the operators. `weights` are D (height · width, 25), 0 outside the image.

        `deviation` is that of the features.
        """
        self._shape = features.shape[:2]
        self._d = np.where(weights < DROPPED, 0.0, weights)
        kept = self._d > 0.0
        basis = bases(gathered(features) * kept[:, :, None], gathered(deviation) * kept[:, :, None])
        self._residual_of = np.eye(len(OFFSETS)) - basis @ basis.transpose(0, 2, 1)

    def residuals(self, image: np.ndarray) -> np.ndarray:
        """Returns P_p I (height · width, 25, channels)."""
        return self._d[:, :, None] * (self._residual_of @ gathered(image))

    def add_products(
        self, squared_weights: np.ndarray, add: Callable[[tuple[int, int], slice, slice, np.ndarray], None]
    ) -> None:
        """Adds P_pᵀ W² P_p of all patches to a matrix between pixels: add(offset, rows, columns, values)."""
        height, width = self._shape
        scaled = self._residual_of * (self._d**2 * squared_weights)[:, None, :]
        products = (scaled @ self._residual_of).transpose(1, 2, 0).reshape(len(OFFSETS), len(OFFSETS), height, width)
        for i, (ay, ax) in enumerate(OFFSETS):
            rows, columns = _within(ay, height), _within(ax, width)
            for j, (by, bx) in enumerate(OFFSETS):
                offset = by - ay, bx - ax
                if (
                    (offset[1], offset[0]) >= (0, 0)
                    and rows[0].stop > rows[0].start
                    and columns[0].stop > columns[0].start
                ):
                    add(offset, rows[1], columns[1], products[i, j, rows[0], columns[0]])


def bases(features: np.ndarray, deviation: np.ndarray) -> np.ndarray:
    """Returns the basis B of each patch: the left singular vectors above τ = c ‖E‖ (Frobenius norm); others are 0.

    E are the deviations of the features.
    """
    vectors, values, _ = np.linalg.svd(features, full_matrices=False)
    threshold = np.maximum(TRUNCATION * np.linalg.norm(deviation, axis=(1, 2)), RANK * values[:, 0])
    return vectors * (values > threshold[:, None])[:, None, :]


def gathered(image: np.ndarray) -> np.ndarray:
    """Returns Γ_p I of all pixels (height · width, 25, channels), 0 outside the image."""
    padded = np.pad(image, ((RADIUS, RADIUS), (RADIUS, RADIUS), (0, 0)))
    height, width, channels = image.shape
    views = [padded[RADIUS + dy : RADIUS + dy + height, RADIUS + dx : RADIUS + dx + width] for dy, dx in OFFSETS]
    return np.stack(views, axis=2).reshape(height * width, len(OFFSETS), channels)


def _within(step: int, size: int) -> tuple[slice, slice]:
    """Returns the centers whose pixel at this step is in the image, and those pixels."""
    first, last = max(0, -step), min(size, size - step)
    last = max(first, last)
    return slice(first, last), slice(first + step, last + step)
