"""Measures of animations: definitions of docs/benchmark/README.md, in scene-linear RGB.

Sequences are float arrays (frames, height, width, 3); maps are (frames, height, width). `variance` is that of the reference's own mean.
Noise of the reference is noise of the error, so its share is subtracted wherever an error is squared. Frames of a reference have seeds of
their own: their errors are independent, and the variance of a difference of two is the sum of both.
"""

from __future__ import annotations

import numpy as np
from metrics import EPSILON

MOVES = 0.5  # pixels per frame from which a pixel counts as moving
SAME_POINT = 1.0  # pixels by which a way there and back may miss
TRIMMED = 1e-3
ANSWERED = 0.05  # share of a light that may still be wrong when it has come or gone


def relative_to(reference: np.ndarray) -> np.ndarray:
    """What squared errors are divided by."""
    return EPSILON + reference.mean(axis=-1) ** 2


def error_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """relMSE by pixels."""
    return ((images - reference) ** 2 - variance).mean(axis=-1) / relative_to(reference)


def flicker_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """F by pixels, from the second frame on: how much of a change between two frames is not the reference's."""
    change = np.diff(images - reference, axis=0)
    return (change**2 - variance[1:] - variance[:-1]).mean(axis=-1) / relative_to(reference[1:])


def independent_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """What F would be, by pixels, if errors of frames were independent: twice relMSE where the reference does not change."""
    squared = (images - reference) ** 2 - variance
    return (squared[1:] + squared[:-1]).mean(axis=-1) / relative_to(reference[1:])


def warped_flicker_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """F along the motion of surfaces; not a number where the frame before does not show the same point."""
    errors, (frames, rows, columns), seen = images - reference, *_sources(vectors)
    change = errors[1:] - errors[frames, rows, columns]
    squared = (change**2 - variance[1:] - variance[frames, rows, columns]).mean(axis=-1) / relative_to(reference[1:])
    return np.where(seen, squared, np.nan)


def moving(vectors: np.ndarray) -> np.ndarray:
    """Which pixels moved since the frame before, from the second frame on."""
    return np.hypot(vectors[1:, ..., 0], vectors[1:, ..., 1]) > MOVES


def _sources(vectors: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Where the points of frames 1, 2, ... were one frame before, to the next pixel (a mean of pixels would have less noise), and whether
    these pixels show them: they lie in the picture, and their own motion leads back. Pass Vector is (previous - current, current - next),
    y upwards."""
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
    """Without the worst 0.1 %: few fireflies are most of a mean."""
    found = np.sort(squares[np.isfinite(squares)])
    return float(found[: found.size - int(np.ceil(found.size * TRIMMED))].mean())


def fast_share(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> float:
    """Share of the error's energy above a quarter of the frame rate; of errors that are independent between frames it is that share of the
    frequencies (0.5 of ten)."""
    weight = 1.0 / relative_to(reference).mean(axis=0)[..., None]
    frequencies = np.abs(np.fft.fftfreq(len(images)))
    energy = np.abs(np.fft.fft(images - reference, axis=0)) ** 2 - variance.sum(axis=0)  # noise of the reference is white
    by_frequency = (energy * weight).sum(axis=(1, 2, 3))
    return float(by_frequency[frequencies > 0.25].sum() / by_frequency.sum())


def shares_of_a_light(images: np.ndarray, reference: np.ndarray, off: int) -> list[float]:
    """By frames: how much of the light that goes off at frame `off` is there but should not be, or (negative) should be but is not."""
    light = reference[off - 1] - reference[off]
    return [float(share) for share in ((images - reference) * light).sum(axis=(1, 2, 3)) / (light**2).sum()]


def lag(shares: list[float], off: int) -> int:
    """Frames from `off` on until less than a twentieth of the light is wrong."""
    return next((late for late, share in enumerate(shares[off:]) if abs(share) < ANSWERED), len(shares) - off)


def lead(shares: list[float], off: int) -> int:
    """Frames before `off` from which on more than a twentieth of the light is wrong."""
    return next((off - frame for frame, share in enumerate(shares[:off]) if abs(share) >= ANSWERED), 0)


def all_measures(
    images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray | None
) -> dict[str, float | list[float]]:
    """By their names in animation.jsonl; without vectors none along motion."""
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


def warped_measures(images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray) -> dict[str, float]:
    warped = warped_flicker_map(images, reference, variance, vectors)
    found = {"flicker_warped": float(np.nanmean(warped)), "flicker_warped_trimmed": trimmed_mean(warped)}
    if np.isfinite(along := warped[moving(vectors)]).any():
        found["flicker_warped_moving"] = trimmed_mean(along)
    return found
