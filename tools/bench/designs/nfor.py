"""Nonlinearly weighted first-order regression (Bitterli et al. 2016), with parameters of the authors' code (Tungsten).

Each half-buffer gets its weights from the other one, so that no half is weighted by its own noise.

Over several frames, one regression has the pixels of all of them, each at the pixel of the picture that shows its
surface. Weights compare squares of pixels of the picture with those of the moved frames, so that a change of the light
separates them, and features are those of each frame's own samples. Only the picture is predicted, and the second pass
over what noise is left has the picture alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from . import animations, nlm
from .animations import Frame, Motion
from .films import Film

RADIUS = 9  # 19×19 pixels per regression
STRICTNESS = (0.5, 1.0)
DAMPING = 1e-3  # share of the window's weight that damps slopes; the authors' solver cuts small singular values instead
ROWS = 6  # rows of the image that are fitted at once, which limits memory


@dataclass(frozen=True)
class Guided:
    """A frame as regressions use it. Each list or first axis has an entry for each half."""

    colours: list[np.ndarray]
    variance: np.ndarray  # of the mean of both halves
    features: np.ndarray  # (2, height, width, channels)
    shown: np.ndarray  # (height, width, 1): 0 where a moved frame does not show the surface of the picture, else 1


def reconstruct(film: Film, more_features: tuple[np.ndarray, np.ndarray] | None = None) -> np.ndarray:
    """Returns the reconstruction of both half-buffers.

    `more_features` are further channels of each half that guide the other half, such as what gradients alone
    reconstruct.
    """
    return regressed_picture([guided(film, more_features)])


def reconstruct_animation(frames: Sequence[Frame], pictures: Sequence[int], reach: int = 2) -> Iterator[np.ndarray]:
    """Yields pictures of an animation, each from the frames up to `reach` before and after it."""
    known = [_guided_by(frame.film, frame.features) for frame in frames]
    for picture in pictures:
        motions = animations.motions_around(frames, picture, reach)
        others = [moved(known[i], motion, known[picture]) for i, motion in motions.items() if i != picture]
        yield regressed_picture([known[picture], *others])


def guided(film: Film, more_features: tuple[np.ndarray, np.ndarray] | None = None) -> Guided:
    frame = _guided_by(film, nlm.filtered([half.features for half in film]))
    if more_features is None:
        return frame
    more = np.stack([scaled(image) for image in more_features[::-1]])
    return replace(frame, features=np.concatenate([frame.features, more], axis=3))


def _guided_by(film: Film, features: np.ndarray) -> Guided:
    colours = [half.image for half in film]
    shown = np.ones((*features.shape[:2], 1))
    return Guided(colours, nlm.variance_of_mean(*colours), np.repeat(features[None], 2, axis=0), shown)


def moved(frame: Guided, motion: Motion, picture: Guided) -> Guided:
    """Returns a frame at the pixels of the picture that show its surfaces; other pixels are the picture's.

    Their coordinates, the last two features, are where these surfaces lie in the picture.
    """

    def read(image: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
        return np.where(motion.shown[:, :, None], motion.read(image), otherwise)

    features = np.stack([read(a, b) for a, b in zip(frame.features, picture.features, strict=True)])
    places = motion.displacement[:, :, ::-1] / max(motion.shown.shape)
    features[..., -2:] = picture.features[..., -2:] + places * motion.shown[:, :, None]
    colours = [read(a, b) for a, b in zip(frame.colours, picture.colours, strict=True)]
    return Guided(colours, read(frame.variance, picture.variance), features, motion.shown[:, :, None].astype(float))


def regressed_picture(frames: Sequence[Guided]) -> np.ndarray:
    """Returns the first frame, reconstructed from all of them."""
    picture = frames[0]
    candidates = [regressed_halves(frames, k) for k in STRICTNESS]
    errors = [estimated_error(candidate, picture.colours, picture.variance) for candidate in candidates]
    share = selection(errors, 0.5 * (picture.colours[0] + picture.colours[1]), picture.variance)
    chosen = [share * a + (1.0 - share) * b for a, b in zip(*candidates, strict=True)]
    left = replace(picture, colours=chosen, variance=nlm.variance_of_mean(*chosen))
    return 0.5 * sum(regressed_halves([left], 1.0))


def regressed_halves(frames: Sequence[Guided], k: float) -> list[np.ndarray]:
    """Returns the regression of each half of the first frame with weights from the other one."""

    def regressed_half(half: int) -> np.ndarray:
        weights = [pair_weights(frames[0], frame, 1 - half, k) for frame in frames]
        return regressed([f.colours[half] for f in frames], [f.features[half] for f in frames], weights)

    return [regressed_half(0), regressed_half(1)]


def pair_weights(picture: Guided, frame: Guided, half: int, k: float) -> np.ndarray:
    """Returns the weights of all pixels of the window (pixels of the window, height, width) in a frame."""
    guide, variance = picture.colours[half], 2.0 * picture.variance
    other = frame.colours[half], 2.0 * frame.variance

    def at(offset: tuple[int, int]) -> np.ndarray:
        if not nlm.reached(guide.shape, *offset):
            return np.zeros(guide.shape[:2])
        distance = nlm.distance(guide, variance, offset, k, 3, other=other).mean(axis=2, keepdims=True)
        shown = nlm.inside(guide.shape, *offset) * nlm.shifted(frame.shown, *offset)
        return (nlm.weight(distance) * shown)[:, :, 0]

    return np.stack([at(offset) for offset in nlm.window(RADIUS)])


def scaled(image: np.ndarray) -> np.ndarray:
    """Scales an image to about the size of features, which the damping assumes."""
    return image / max(float(np.abs(image).mean()), np.finfo(float).tiny)


def regressed(images: list[np.ndarray], features: list[np.ndarray], weights: list[np.ndarray]) -> np.ndarray:
    """Fits colors of all frames around every pixel of the first one by 1 and the features' differences from it.

    Each fit predicts all pixels of its window in the first frame; predictions are averaged by weight.
    """
    height, width, channels = images[0].shape
    total = np.zeros((height + 2 * RADIUS, width + 2 * RADIUS, channels + 1))
    pixels, guides = (
        [np.pad(plane, ((RADIUS, RADIUS), (RADIUS, RADIUS), (0, 0))) for plane in planes]
        for planes in (images, features)
    )
    for first in range(0, height, ROWS):
        rows = min(ROWS, height - first)
        part = slice(first, first + rows + 2 * RADIUS)
        centres = features[0][first : first + rows].reshape(rows * width, 1, -1)
        systems = (
            (
                _windows(colours[part]),
                _basis(_windows(guide[part]) - centres),
                w[:, first : first + rows].reshape(len(w), -1).T[:, :, None],
            )
            for colours, guide, w in zip(pixels, guides, weights, strict=True)
        )
        predicted, w = _fits(systems)
        said = np.concatenate([w * predicted, w], axis=2).reshape(rows, width, -1, channels + 1)
        for i, (dy, dx) in enumerate(nlm.window(RADIUS)):
            y, x = RADIUS + first + dy, RADIUS + dx
            total[y : y + rows, x : x + width] += said[:, :, i]
    inner = total[RADIUS : RADIUS + height, RADIUS : RADIUS + width]
    return inner[:, :, :-1] / inner[:, :, -1:]


def _fits(systems: Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Returns the predictions of the weighted fit of each window for the first frame, and its weights there.

    Systems are colors, basis and weights of each frame (windows, pixels of a window, channels).
    """
    first = next(systems)
    normal, right, total = _normal_equations(*first)
    for system in systems:
        for sum_, more in zip((normal, right, total), _normal_equations(*system), strict=True):
            sum_ += more
    size = normal.shape[1]
    normal[:, range(1, size), range(1, size)] += DAMPING * total
    _, basis, w = first
    return basis @ np.linalg.solve(normal, right), w


def _normal_equations(
    colours: np.ndarray, basis: np.ndarray, w: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    weighted = (w * basis).transpose(0, 2, 1)
    return weighted @ basis, weighted @ colours, w.sum(axis=1)


def _basis(differences: np.ndarray) -> np.ndarray:
    return np.concatenate([np.ones_like(differences[:, :, :1]), differences], axis=2)


def _windows(padded: np.ndarray) -> np.ndarray:
    """Returns the windows of all pixels inside the margin (pixels, pixels of a window, channels)."""
    side = 2 * RADIUS + 1
    views = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(0, 1))
    return views.transpose(0, 1, 3, 4, 2).reshape(-1, side * side, padded.shape[2])


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
