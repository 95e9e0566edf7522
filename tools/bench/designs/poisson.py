"""Screened Poisson reconstruction with further rows for patches, by iteratively reweighted least squares.

Rows (thesis 8, equation 14): α I = α I^g; H I = (I^dx, I^dy); β P_p I = 0 for every patch p. The system is
solved exactly by a banded Cholesky factor, where the thesis uses 500 steps of conjugate gradients, so that the result
does not depend on a preconditioner. Patches of 5×5 couple pixels that are at most four columns apart, so that one
factor of 4·height + 5 bands serves both halves and all channels.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from .films import Film, Half, differences, mean_of
from .patches import OFFSETS, Patches

REWEIGHTINGS = 5
REWEIGHTINGS_L1 = 20  # as in the code of G-PT; the thesis does not say


class Reweighting(Enum):
    """How the weights of line 14 of figure 4, 1/‖e‖, are used; the value is their power in AᵀW²A."""

    PRINTED = 2  # W; a row then contributes the same at any residual, which is no L1 norm
    L1 = 1  # W², as in the authors' released solver


@dataclass(frozen=True)
class Weights:
    """Squares of the diagonal of W, shared by all channels."""

    pixel: np.ndarray  # (height, width)
    dx: np.ndarray
    dy: np.ndarray
    patch: np.ndarray | None  # (height · width, pixels of a patch)


class Stencil:
    """A symmetric matrix between pixels: an image of coefficients for every offset (dy, dx) to the right or straight
    down.
    """

    def __init__(self, height: int, width: int) -> None:
        self._shape = height, width
        self._images: dict[tuple[int, int], np.ndarray] = defaultdict(lambda: np.zeros((height, width)))

    def add(self, offset: tuple[int, int], rows: slice, columns: slice, values: np.ndarray) -> None:
        self._images[offset][rows, columns] += values

    def band(self) -> np.ndarray:
        """Returns LAPACK's lower banded form, with pixels numbered column by column."""
        height, width = self._shape
        steps = {(dy, dx): dx * height + dy for dy, dx in self._images}
        band = np.zeros((max(steps.values()) + 1, height * width))
        for offset, image in self._images.items():
            band[steps[offset]] += image.T.ravel()
        return band


def normal_matrix(weights: Weights, alpha: float, beta: float, patches: Patches | None) -> Stencil:
    """Returns AᵀW²A (equation 10)."""
    height, width = weights.pixel.shape
    stencil = Stencil(height, width)
    everything = slice(None)
    stencil.add((0, 0), everything, everything, alpha**2 * weights.pixel)
    for offset, w in (((0, 1), weights.dx[:, :-1]), ((1, 0), weights.dy[:-1])):
        if not w.size:
            continue
        first = slice(0, w.shape[0]), slice(0, w.shape[1])
        second = slice(height - w.shape[0], height), slice(width - w.shape[1], width)
        stencil.add((0, 0), *first, w)
        stencil.add((0, 0), *second, w)
        stencil.add(offset, *first, -w)
    if patches is not None and weights.patch is not None:
        patches.add_products(beta**2 * weights.patch, stencil.add)
    return stencil


def right_side(half: Half, weights: Weights, alpha: float) -> np.ndarray:
    """Returns AᵀW²b (equation 4, with the α² that follows from equation 3)."""
    side = alpha**2 * weights.pixel[:, :, None] * half.image
    x, y = weights.dx[:, :-1, None] * half.dx[:, :-1], weights.dy[:-1, :, None] * half.dy[:-1]
    side[:, 1:] += x
    side[:, :-1] -= x
    side[1:] += y
    side[:-1] -= y
    return side


def solve(
    halves: tuple[Half, ...], weights: Weights, alpha: float, beta: float = 0.0, patches: Patches | None = None
) -> list[np.ndarray]:
    """Returns the least-squares solution of each half with the same weights, so with the same linear operator."""
    height, width, channels = halves[0].image.shape
    factor = cholesky_banded(
        normal_matrix(weights, alpha, beta, patches).band(), lower=True, overwrite_ab=True, check_finite=False
    )
    sides = np.concatenate([right_side(half, weights, alpha) for half in halves], axis=2)
    unknowns = cho_solve_banded((factor, True), sides.transpose(1, 0, 2).reshape(height * width, -1))
    images = unknowns.reshape(width, height, -1).transpose(1, 0, 2)
    return np.split(images, len(halves), axis=2)


def equal_weights(half: Half, patches: Patches | None) -> Weights:
    """Returns W of the first step."""
    ones = np.ones(half.image.shape[:2])
    return Weights(ones, ones, ones, None if patches is None else np.ones((ones.size, len(OFFSETS))))


def reweighted(
    half: Half,
    image: np.ndarray,
    step: int,
    alpha: float,
    beta: float,
    patches: Patches | None,
    reweighting: Reweighting,
) -> Weights:
    """Returns the next weights: 1/(‖e‖ + 0.05 · 0.5^(k−1)), norms over channels (figure 4, lines 11 to 16).

    Rows of pixels are reweighted only without patches. With patches their weight is 1, and the other rows are scaled to
    a mean of 1. Lines 15 and 16 scale all rows together, which would make α depend on the unit of light.
    """
    power = reweighting.value

    def inverse(residual: np.ndarray) -> np.ndarray:
        return 1.0 / (np.linalg.norm(residual, axis=2) + 0.05 * 0.5**step)

    dx, dy = (inverse(own - sampled) for own, sampled in zip(differences(image), (half.dx, half.dy), strict=True))
    if patches is None:
        return Weights(inverse(alpha * (image - half.image)) ** power, dx**power, dy**power, None)
    patch = inverse(beta * patches.residuals(image))
    mean = np.concatenate([w.ravel() for w in (dx, dy, patch)]).mean()
    return Weights(np.ones_like(dx), (dx / mean) ** power, (dy / mean) ** power, (patch / mean) ** power)


def l1(half: Half, alpha: float, reweighting: Reweighting) -> np.ndarray:
    """Returns the usual L1 reconstruction, in which rows of pixels are reweighted, too."""
    weights = equal_weights(half, None)
    for step in range(REWEIGHTINGS_L1):
        (image,) = solve((half,), weights, alpha)
        weights = reweighted(half, image, min(step, REWEIGHTINGS - 1), alpha, 0.0, None, reweighting)
    return image


def regularized(
    film: Film, alpha: float, beta: float, patches: Patches, reweighting: Reweighting
) -> list[np.ndarray]:
    """Returns both halves, reweighted by their mean (POISSONREGULARIZED of figure 4)."""
    weights = equal_weights(film[0], patches)
    mean = mean_of(film)
    for step in range(REWEIGHTINGS):
        first, second = solve(film, weights, alpha, beta, patches)
        weights = reweighted(mean, 0.5 * (first + second), step, alpha, beta, patches, reweighting)
    return [first, second]
