"""Measures of animations, in scene-linear RGB; docs/benchmark/README.md defines them.

Sequences are float arrays (frames, height, width, 3); maps are (frames, height, width). `variance` is that of the
reference's own mean. Noise of the reference adds to the error, so its variance is subtracted wherever an error is
squared. Frames of a reference have different seeds, so their errors are independent, and the variance of the difference
of two frames is the sum of both.
"""

from __future__ import annotations

import numpy as np
from metrics import EPSILON

MOVES = 0.5  # pixels per frame from which a pixel counts as moving
SAME_POINT = 1.0  # pixels by which the motion of two frames may disagree at the same point
TRIMMED = 1e-3  # share of the worst pixels that a trimmed mean leaves out
ANSWERED = 0.05  # share of a light below which a frame counts as having followed its change


def relative_to(reference: np.ndarray) -> np.ndarray:
    """Returns what squared errors are divided by."""
    return EPSILON + reference.mean(axis=-1) ** 2


def error_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Returns relMSE for each pixel."""
    return ((images - reference) ** 2 - variance).mean(axis=-1) / relative_to(reference)


def flicker_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Returns F for each pixel, from the second frame on: the squared change between two frames that the reference does
    not have.
    """
    change = np.diff(images - reference, axis=0)
    return (change**2 - variance[1:] - variance[:-1]).mean(axis=-1) / relative_to(reference[1:])


def independent_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Returns what F would be for each pixel if errors of frames were independent: twice relMSE where the reference is
    constant.
    """
    squared = (images - reference) ** 2 - variance
    return (squared[1:] + squared[:-1]).mean(axis=-1) / relative_to(reference[1:])


def warped_flicker_map(
    images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray
) -> np.ndarray:
    """Returns F along the motion of surfaces; NaN where the frame before does not show the same point."""
    errors, (frames, rows, columns), seen = images - reference, *_sources(vectors)
    change = errors[1:] - errors[frames, rows, columns]
    squared = (change**2 - variance[1:] - variance[frames, rows, columns]).mean(axis=-1) / relative_to(reference[1:])
    return np.where(seen, squared, np.nan)


def moving(vectors: np.ndarray) -> np.ndarray:
    """Returns a mask of the pixels that have moved since the frame before, from the second frame on."""
    return np.hypot(vectors[1:, ..., 0], vectors[1:, ..., 1]) > MOVES


def _sources(vectors: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Returns where the points of frames 1, 2, ... were one frame before, and whether these pixels show them.

    A pixel shows the point if it lies in the picture and its own motion leads back. Places are rounded to whole pixels,
    because a mean of pixels would have less noise. The pass Vector is (previous - current, current - next), y upwards.
    """
    count, height, width, _ = vectors.shape
    frames, rows, columns = np.indices((count - 1, height, width))
    back = vectors[1:, ..., :2]
    columns = columns + np.rint(back[..., 0]).astype(int)
    rows = rows - np.rint(back[..., 1]).astype(int)
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    rows, columns = rows.clip(0, height - 1), columns.clip(0, width - 1)
    there = vectors[:-1, ..., 2:][frames, rows, columns]
    return (frames, rows, columns), inside & (np.hypot(*np.moveaxis(there - back, -1, 0)) < SAME_POINT)


def trimmed_mean(squares: np.ndarray) -> float:
    """Returns the mean without the worst 0.1 %, since a few fireflies can dominate a mean."""
    found = np.sort(squares[np.isfinite(squares)])
    return float(found[: found.size - int(np.ceil(found.size * TRIMMED))].mean())


def fast_share(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> float:
    """Returns the share of the error's energy above a quarter of the frame rate.

    If errors of frames are independent, it is the share of these frequencies, 0.5 for ten frames.
    """
    weight = 1.0 / relative_to(reference).mean(axis=0)[..., None]
    frequencies = np.abs(np.fft.fftfreq(len(images)))
    energy = np.abs(np.fft.fft(images - reference, axis=0)) ** 2 - variance.sum(
        axis=0
    )  # the noise of the reference is white
    by_frequency = (energy * weight).sum(axis=(1, 2, 3))
    return float(by_frequency[frequencies > 0.25].sum() / by_frequency.sum())


def shares_of_a_light(images: np.ndarray, reference: np.ndarray, off: int) -> list[float]:
    """Returns for each frame the share of a light, which goes off at frame `off`, that is there but should not be.

    Negative if missing.
    """
    light = reference[off - 1] - reference[off]
    return [float(share) for share in ((images - reference) * light).sum(axis=(1, 2, 3)) / (light**2).sum()]


def lag(shares: list[float], off: int) -> int:
    """Returns the number of frames from `off` on until less than a twentieth of the light is wrong."""
    return next((late for late, share in enumerate(shares[off:]) if abs(share) < ANSWERED), len(shares) - off)


def lead(shares: list[float], off: int) -> int:
    """Returns how many frames before `off` more than a twentieth of the light is wrong for the first time."""
    return next((off - frame for frame, share in enumerate(shares[:off]) if abs(share) >= ANSWERED), 0)


def all_measures(
    images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray | None
) -> dict[str, float | list[float]]:
    """Returns all measures by their names in stored rows; those along the motion need vectors."""
    errors, flicker = error_map(images, reference, variance), flicker_map(images, reference, variance)
    found = {
        "relmse": float(errors.mean()),
        "relmse_trimmed": trimmed_mean(errors),
        "relmse_by_frame": [float(error) for error in errors.mean(axis=(1, 2))],
        "flicker": float(flicker.mean()),
        "flicker_trimmed": trimmed_mean(flicker),
        "flicker_if_independent": float(independent_map(images, reference, variance).mean()),
        "fast_share": fast_share(images, reference, variance),
    }
    return found if vectors is None else found | warped_measures(images, reference, variance, vectors)


def warped_measures(
    images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray
) -> dict[str, float]:
    """Returns the measures along the motion of surfaces."""
    warped = warped_flicker_map(images, reference, variance, vectors)
    found = {"flicker_warped": float(np.nanmean(warped)), "flicker_warped_trimmed": trimmed_mean(warped)}
    if np.isfinite(along := warped[moving(vectors)]).any():
        found["flicker_warped_moving"] = trimmed_mean(along)
    return found
