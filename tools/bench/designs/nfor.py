"""Nonlinearly weighted first-order regression (Bitterli et al. 2016), with parameters of the authors' code (Tungsten).

Each half-buffer gets its weights from the other one, so that no half is weighted by its own noise.
"""

from __future__ import annotations

import numpy as np

from . import nlm
from .films import Film, mean_of

RADIUS = 9  # 19×19 pixels per regression
STRICTNESS = (0.5, 1.0)
DAMPING = 1e-3  # share of the window's weight that damps slopes; the authors' solver cuts small singular values instead
ROWS = 6  # rows of the image that are fitted at once, which limits memory


def reconstruct(film: Film, more_features: tuple[np.ndarray, np.ndarray] | None = None) -> np.ndarray:
    """Returns the reconstruction of both half-buffers.

    `more_features` are further channels of each half that guide the other half, such as what gradients alone
    reconstruct.
    """
    colours = [half.image for half in film]
    variance = nlm.variance_of_mean(*colours)
    own = filtered([half.features for half in film])
    features = np.repeat(0.5 * (own[0] + own[1])[None], 2, axis=0)  # one image per half
    if more_features is not None:
        features = np.concatenate([features, np.stack([scaled(image) for image in more_features[::-1]])], axis=3)
    candidates = [regressed_halves(colours, variance, features, k) for k in STRICTNESS]
    errors = [estimated_error(candidate, colours, variance) for candidate in candidates]
    share = selection(errors, mean_of(film).image, variance)
    chosen = [share * a + (1.0 - share) * b for a, b in zip(*candidates, strict=True)]
    left = nlm.variance_of_mean(*chosen)
    return 0.5 * sum(regressed_halves(chosen, left, features, 1.0))


def scaled(image: np.ndarray) -> np.ndarray:
    """Scales an image to about the size of features, which the damping assumes."""
    return image / max(float(np.abs(image).mean()), np.finfo(float).tiny)


def regressed_halves(
    colours: list[np.ndarray], variance: np.ndarray, features: np.ndarray, k: float
) -> list[np.ndarray]:
    """Returns the regression of each half with weights from the other one, guided by features[half]."""
    a, b = colours
    return [
        regressed(a, features[0], pair_weights(b, 2.0 * variance, k)),
        regressed(b, features[1], pair_weights(a, 2.0 * variance, k)),
    ]


def pair_weights(guide: np.ndarray, variance: np.ndarray, k: float) -> np.ndarray:
    """Returns the weights of all pixels of the window (pixels of the window, height, width)."""

    def at(offset: tuple[int, int]) -> np.ndarray:
        if not nlm.reached(guide.shape, *offset):
            return np.zeros(guide.shape[:2])
        distance = nlm.distance(guide, variance, offset, k, 3).mean(axis=2, keepdims=True)
        return (nlm.weight(distance) * nlm.inside(guide.shape, *offset))[:, :, 0]

    return np.stack([at(offset) for offset in nlm.window(RADIUS)])


def regressed(image: np.ndarray, features: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Fits colors around every pixel by 1 and the features' differences from it.

    Each fit predicts all pixels of its window; predictions are averaged by weight.
    """
    height, width, channels = image.shape
    total = np.zeros((height + 2 * RADIUS, width + 2 * RADIUS, channels + 1))
    pixels, guides = (np.pad(plane, ((RADIUS, RADIUS), (RADIUS, RADIUS), (0, 0))) for plane in (image, features))
    for first in range(0, height, ROWS):
        rows = min(ROWS, height - first)
        part = slice(first, first + rows + 2 * RADIUS)
        w = weights[:, first : first + rows].reshape(len(weights), -1).T[:, :, None]
        predicted = _fits(_windows(pixels[part]), _windows(guides[part]), features[first : first + rows], w)
        said = np.concatenate([w * predicted, w], axis=2).reshape(rows, width, len(weights), channels + 1)
        for i, (dy, dx) in enumerate(nlm.window(RADIUS)):
            y, x = RADIUS + first + dy, RADIUS + dx
            total[y : y + rows, x : x + width] += said[:, :, i]
    inner = total[RADIUS : RADIUS + height, RADIUS : RADIUS + width]
    return inner[:, :, :-1] / inner[:, :, -1:]


def _fits(colours: np.ndarray, guides: np.ndarray, centres: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Returns the prediction of the weighted fit of each window (windows, pixels of a window, channels)."""
    rows = np.concatenate([np.ones_like(w), guides - centres.reshape(len(w), 1, -1)], axis=2)
    weighted = (w * rows).transpose(0, 2, 1)
    normal = weighted @ rows
    size = normal.shape[1]
    normal[:, range(1, size), range(1, size)] += DAMPING * w.sum(axis=1)
    return rows @ np.linalg.solve(normal, weighted @ colours)


def _windows(padded: np.ndarray) -> np.ndarray:
    """Returns the windows of all pixels inside the margin (pixels, pixels of a window, channels)."""
    side = 2 * RADIUS + 1
    views = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(0, 1))
    return views.transpose(0, 1, 3, 4, 2).reshape(-1, side * side, padded.shape[2])


def filtered(halves: list[np.ndarray]) -> list[np.ndarray]:
    """Returns each half filtered by non-local means over 11×11 pixels, with weights from the other half, channel by
    channel.
    """
    variance = 2.0 * nlm.variance_of_mean(*halves)

    def by(guide: np.ndarray) -> nlm.WeightAt:
        return lambda offset: nlm.weight(nlm.distance(guide, variance, offset, 0.5, 3))

    a, b = halves
    return [nlm.average(a, 5, by(b)), nlm.average(b, 5, by(a))]


def estimated_error(candidate: list[np.ndarray], colours: list[np.ndarray], variance: np.ndarray) -> np.ndarray:
    """Returns the error of each fit against the half that it has not seen, less the variance of that half."""
    squares = [(x - other) ** 2 - 2.0 * variance for x, other in zip(candidate, reversed(colours), strict=True)]
    return (0.5 * (squares[0] + squares[1])).mean(axis=2, keepdims=True)


def selection(errors: list[np.ndarray], guide: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Returns the share of the first candidate. Errors and the choice between them are smoothed along the image."""

    def weight(offset: tuple[int, int]) -> np.ndarray:
        return nlm.weight(nlm.distance(guide, variance, offset, 1.0, 1).mean(axis=2, keepdims=True))

    smooth = nlm.average(np.concatenate(errors, axis=2), RADIUS, weight)
    return nlm.average((smooth[:, :, :1] < smooth[:, :, 1:]).astype(float), RADIUS, weight)
