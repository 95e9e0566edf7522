"""Nonlinearly weighted first-order regression (Bitterli et al. 2016): half-buffers crossed, so that no half weighs its
own noise.

Numbers are those of the authors' code (Tungsten, src/denoiser).
"""

from __future__ import annotations

import numpy as np

from . import nlm
from .frames import Frame, mean_of

RADIUS = 9  # 19×19 pixels per regression
STRICTNESS = (0.5, 1.0)
DAMPING = 1e-3  # share of the window's weight that holds slopes down; the authors' solver cuts small singular values
ROWS = 6  # of the image at once: bounds memory


def reconstruct(frame: Frame, more_features: tuple[np.ndarray, np.ndarray] | None = None) -> np.ndarray:
    """more_features: further channels, of each half, that guide the *other* half, such as what gradients alone
    reconstruct.
    """
    colours = [half.image for half in frame]
    variance = nlm.variance_of_mean(*colours)
    own = filtered([half.features for half in frame])
    features = np.repeat(0.5 * (own[0] + own[1])[None], 2, axis=0)  # one image per half
    if more_features is not None:
        features = np.concatenate([features, np.stack([scaled(image) for image in more_features[::-1]])], axis=3)
    candidates = [regressed_halves(colours, variance, features, k) for k in STRICTNESS]
    errors = [estimated_error(candidate, colours, variance) for candidate in candidates]
    share = selection(errors, mean_of(frame).image, variance)
    chosen = [share * a + (1.0 - share) * b for a, b in zip(*candidates, strict=True)]
    left = nlm.variance_of_mean(*chosen)
    return 0.5 * sum(regressed_halves(chosen, left, features, 1.0))


def scaled(image: np.ndarray) -> np.ndarray:
    """About as large as features are, which damping counts on."""
    return image / max(float(np.abs(image).mean()), np.finfo(float).tiny)


def regressed_halves(
    colours: list[np.ndarray], variance: np.ndarray, features: np.ndarray, k: float
) -> list[np.ndarray]:
    """Each half with weights from the other, features[half] guiding it."""
    a, b = colours
    return [
        regressed(a, features[0], pair_weights(b, 2.0 * variance, k)),
        regressed(b, features[1], pair_weights(a, 2.0 * variance, k)),
    ]


def pair_weights(guide: np.ndarray, variance: np.ndarray, k: float) -> np.ndarray:
    """(pixels of the window, height, width)."""

    def at(offset: tuple[int, int]) -> np.ndarray:
        if not nlm.reached(guide.shape, *offset):
            return np.zeros(guide.shape[:2])
        distance = nlm.distance(guide, variance, offset, k, 3).mean(axis=2, keepdims=True)
        return (nlm.weight(distance) * nlm.inside(guide.shape, *offset))[:, :, 0]

    return np.stack([at(offset) for offset in nlm.window(RADIUS)])


def regressed(image: np.ndarray, features: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Fits colours around every pixel by 1 and the features' differences from it.

    Each speaks for all pixels of its window, by weight.
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
    """What the weighted fit of each window says of its pixels; arrays (windows, pixels of a window, channels)."""
    rows = np.concatenate([np.ones_like(w), guides - centres.reshape(len(w), 1, -1)], axis=2)
    weighted = (w * rows).transpose(0, 2, 1)
    normal = weighted @ rows
    size = normal.shape[1]
    normal[:, range(1, size), range(1, size)] += DAMPING * w.sum(axis=1)
    return rows @ np.linalg.solve(normal, weighted @ colours)


def _windows(padded: np.ndarray) -> np.ndarray:
    """(pixels inside the margin, pixels of a window, channels)."""
    side = 2 * RADIUS + 1
    views = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(0, 1))
    return views.transpose(0, 1, 3, 4, 2).reshape(-1, side * side, padded.shape[2])


def filtered(halves: list[np.ndarray]) -> list[np.ndarray]:
    """Non-local means of each half over 11×11 pixels with weights from the other, each channel by itself."""
    variance = 2.0 * nlm.variance_of_mean(*halves)

    def by(guide: np.ndarray) -> nlm.WeightAt:
        return lambda offset: nlm.weight(nlm.distance(guide, variance, offset, 0.5, 3))

    a, b = halves
    return [nlm.average(a, 5, by(b)), nlm.average(b, 5, by(a))]


def estimated_error(candidate: list[np.ndarray], colours: list[np.ndarray], variance: np.ndarray) -> np.ndarray:
    """Of each fit against the half that it has not seen, less that half's variance; mean over halves and channels."""
    squares = [(x - other) ** 2 - 2.0 * variance for x, other in zip(candidate, reversed(colours), strict=True)]
    return (0.5 * (squares[0] + squares[1])).mean(axis=2, keepdims=True)


def selection(errors: list[np.ndarray], guide: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Share of the first candidate: both the errors and the choice between them smoothed along the image."""

    def weight(offset: tuple[int, int]) -> np.ndarray:
        return nlm.weight(nlm.distance(guide, variance, offset, 1.0, 1).mean(axis=2, keepdims=True))

    smooth = nlm.average(np.concatenate(errors, axis=2), RADIUS, weight)
    return nlm.average((smooth[:, :, :1] < smooth[:, :, 1:]).astype(float), RADIUS, weight)
