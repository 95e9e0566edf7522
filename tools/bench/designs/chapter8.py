"""Regularising image reconstruction with feature patches (Manzi, Vicini, Zwicker 2016; thesis, chapter 8), complete.

Names are those of its figure 8. The docstring of the package says how ambiguous places were read.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import nlm, poisson
from .films import Film, Half, mean_of
from .patches import OFFSETS, Patches
from .poisson import Reweighting

ALPHA_L1 = 0.2
SMALLEST_ERROR = 1e-9  # ε of equation 15
FILTER_RADIUS = 5  # 11×11 pixels
BIAS_RADIUS = 12  # 25×25 pixels


@dataclass(frozen=True)
class Scale:
    alpha: float
    beta: float
    k_c: float


PRINTED = (Scale(0.25, 5.0, 0.1), Scale(0.25, 17.0, 0.35), Scale(0.1, 19.0, 0.15))
TUNED = (Scale(0.2, 0.3, 0.1), Scale(0.1, 0.3, 0.1), Scale(0.03, 0.3, 0.35))  # chosen on four scenes


@dataclass(frozen=True)
class Guide:
    """An image and its variance, from which weights of non-local means are computed."""

    values: np.ndarray
    variance: np.ndarray

    @classmethod
    def of_halves(cls, a: np.ndarray, b: np.ndarray) -> Guide:
        return cls(0.5 * (a + b), nlm.variance_of_mean(a, b))

    @cached_property
    def tolerance(self) -> np.ndarray:
        """Returns V_j = max(10⁻³, Var_j, ‖∇_j‖²)."""
        slopes = sum(
            (np.gradient(self.values, axis=axis) ** 2 for axis in (0, 1) if self.values.shape[axis] > 1),
            np.float64(0.0),
        )
        return np.maximum(np.maximum(1e-3, self.variance), slopes)


def reconstruct(film: Film, scales: tuple[Scale, ...], reweighting: Reweighting) -> np.ndarray:
    """Returns the reconstruction of both half-buffers (RECONSTRUCT of figure 8)."""
    film = with_features(film, filtered_features(film))
    features = Guide.of_halves(film[0].features, film[1].features)
    colour = Guide.of_halves(*(poisson.l1(half, ALPHA_L1, reweighting) for half in film))
    images, spreads = [], []
    for scale in scales:
        patches = Patches(features.values, np.sqrt(features.variance), patch_weights(colour, scale.k_c))
        halves = post_filtered(poisson.regularized(film, scale.alpha, scale.beta, patches, reweighting), features)
        images.append(0.5 * (halves[0] + halves[1]))
        spreads.append(0.25 * (halves[0] - halves[1]) ** 2)
    return combined(images, estimated_errors(images, spreads, mean_of(film).image, colour))


def with_features(film: Film, features: list[np.ndarray]) -> Film:
    a, b = (Half(half.image, half.dx, half.dy, channels) for half, channels in zip(film, features, strict=True))
    return a, b


def filtered_features(film: Film) -> list[np.ndarray]:
    """Returns the features of both halves, filtered channel by channel (line 2; k_f = 1, t_f = 3)."""
    guide = Guide.of_halves(film[0].features, film[1].features)
    return [
        nlm.average(half.features, FILTER_RADIUS, lambda offset: nlm.weight(feature_distance(guide, offset, 3)))
        for half in film
    ]


def colour_weight(guide: Guide, offset: tuple[int, int], k_c: float) -> np.ndarray:
    """Returns the weight of color (equation 5, t_c = 1)."""
    return nlm.weight(nlm.distance(guide.values, guide.variance, offset, k_c, 1).mean(axis=2, keepdims=True))


def feature_distance(guide: Guide, offset: tuple[int, int], radius: int) -> np.ndarray:
    """Returns the distance of features for each channel, k_f = 1.

    It is never stricter than the features' own slopes.
    """
    return nlm.distance(guide.values, guide.variance, offset, 1.0, radius, guide.tolerance)


def patch_weights(colour: Guide, k_c: float) -> np.ndarray:
    """Returns D_p of all pixels (height · width, 25). In the solve k_f is ∞, so that equation 7 becomes equation 5."""
    images = [colour_weight(colour, offset, k_c) * nlm.inside(colour.values.shape, *offset) for offset in OFFSETS]
    return np.concatenate(images, axis=2).reshape(-1, len(OFFSETS))


def post_filtered(halves: list[np.ndarray], features: Guide) -> list[np.ndarray]:
    """Returns both halves after line 8, with the same weights (equation 7): k_c = 0.45, t_c = 1, k_f = 1, t_f = 0."""
    colour = Guide.of_halves(*halves)

    def weight(offset: tuple[int, int]) -> np.ndarray:
        by_features = nlm.weight(feature_distance(features, offset, 0)).min(axis=2, keepdims=True)
        return np.minimum(colour_weight(colour, offset, 0.45), by_features)

    return [nlm.average(half, FILTER_RADIUS, weight) for half in halves]


def estimated_errors(
    images: list[np.ndarray], spreads: list[np.ndarray], sampled: np.ndarray, colour: Guide
) -> list[np.ndarray]:
    """Returns the estimated error of each image: variance plus squared bias, over 3×3 pixels (section 7).

    Bias is the difference from the sampled image when both are smoothed alike (k_c = 0.6).
    """
    smooth = nlm.average(
        np.concatenate([sampled, *images], axis=2), BIAS_RADIUS, lambda offset: colour_weight(colour, offset, 0.6)
    )
    unbiased, *smoothed = np.split(smooth, len(images) + 1, axis=2)
    return [
        nlm.box((spread + (x - unbiased) ** 2).mean(axis=2, keepdims=True), 1)
        for spread, x in zip(spreads, smoothed, strict=True)
    ]


def combined(images: list[np.ndarray], errors: list[np.ndarray]) -> np.ndarray:
    """Returns the blend of the images (equation 15)."""
    shares = [1.0 / (error + SMALLEST_ERROR) for error in errors]
    return sum(share * image for share, image in zip(shares, images, strict=True)) / sum(shares)
