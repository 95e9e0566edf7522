"""Measures of animations, in scene-linear RGB; docs/benchmark/README.md defines them.

Sequences are float arrays (frames, height, width, 3); maps are (frames, height, width). Squared errors are divided by
the squared level: the gray of a smooth picture of the same frame.

A mean squared error is noise plus squared bias. Half of the squared difference of two seeds has the noise as its
expectation and needs no reference. The product of the errors of two seeds against two independent halves of a reference
has the squared bias as its expectation, whatever noise seeds and halves have.

Measures of the motion benchmark are of one seed: they subtract `variance`, that of the reference's own mean.
"""

from __future__ import annotations

import numpy as np
from metrics import EPSILON, relative_to

Halves = tuple[np.ndarray, np.ndarray]

MOVES = 0.5  # pixels per frame from which a pixel counts as moving
SAME_POINT = 1.0  # pixels by which the motion of two frames may disagree at the same point
TRIMMED = 1e-3  # share of the worst pixels that a trimmed mean leaves out
NOISY_BLOCKS = 1e-2  # share of the blocks of pixels that a trimmed bias leaves out, those of the noisiest reference
BLOCK_SIDE = 16  # side in pixels of the blocks in which the noise of a reference is judged
ANSWERED = 0.05  # share of a light below which a frame counts as having followed its change
SHADED = 0.6  # share of a pixel's highest level below which the pixel lies in the passing shadow
WAKE = 4  # frames for which a pixel that a shadow has left belongs to its wake


def noise_map(first: np.ndarray, second: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Returns the relative variance of each pixel, estimated from two seeds."""
    return 0.5 * ((first - second) ** 2).mean(axis=-1) / (EPSILON + level**2)


def bias_map(first: np.ndarray, second: np.ndarray, halves: Halves, level: np.ndarray) -> np.ndarray:
    """Returns the relative squared bias of each pixel, estimated from two seeds and two halves of a reference.

    Single pixels may be negative.
    """
    one, two = halves
    crossed = 0.5 * ((first - one) * (second - two) + (first - two) * (second - one))
    return crossed.mean(axis=-1) / (EPSILON + level**2)


def noise_and_bias(
    seeds: tuple[np.ndarray, np.ndarray], halves: Halves, level: np.ndarray, checked: slice
) -> dict[str, float]:
    """Returns noise, bias and their sum, of all pixels and trimmed.

    The noise is that of all frames. The bias is that of the frames that the halves show, which are `checked`, with its
    standard error; if noise makes it negative, the sum is the noise alone. Trimmed means leave out the pixels where the
    seeds differ most, and the bias also the blocks in which the halves do.
    """
    noise, bias = noise_map(*seeds, level), bias_map(*(seed[checked] for seed in seeds), halves, level[checked])
    kept = _best(noise[checked]) & _without_noisy_blocks(noise_map(*halves, level[checked]))
    found = {"noise": noise.mean(), "bias": bias.mean(), "bias_error": bias.std() / np.sqrt(bias.size)}
    found |= {"noise_trimmed": noise[_best(noise)].mean(), "bias_trimmed": bias[kept].mean()}
    for name, trimmed in (("", ""), ("trimmed", "_trimmed")):
        found[name] = found[f"noise{trimmed}"] + max(found[f"bias{trimmed}"], 0.0)
    return {name: float(value) for name, value in found.items()}


def error_measures(
    seeds: tuple[np.ndarray, np.ndarray], halves: Halves, level: np.ndarray, checked: slice
) -> dict[str, float]:
    """Returns relMSE and F with their parts by their names in stored rows. F is relMSE of the changes."""
    errors = noise_and_bias(seeds, halves, level, checked)
    changes = noise_and_bias(
        (_changes(seeds[0]), _changes(seeds[1])),
        (_changes(halves[0]), _changes(halves[1])),
        level[1:],
        slice(checked.start, checked.stop - 1),
    )
    parts = {"relmse": errors, "flicker": changes}
    return {f"{name}_{part}".strip("_"): value for name, found in parts.items() for part, value in found.items()}


def _changes(images: np.ndarray) -> np.ndarray:
    return np.diff(images, axis=0)


def _without_noisy_blocks(noise: np.ndarray) -> np.ndarray:
    """Returns a mask without the blocks of pixels in which a reference has most noise.

    Blocks decide, not pixels. Where rare paths bring most of the light, the pixels in which two halves of a reference
    agree are those that both lack it, and any right picture would seem too bright there.
    """
    _, height, width = noise.shape
    rows, columns = np.arange(0, height, BLOCK_SIDE), np.arange(0, width, BLOCK_SIDE)
    mask = _without_largest(np.add.reduceat(np.add.reduceat(noise, rows, axis=1), columns, axis=2), NOISY_BLOCKS)
    return mask.repeat(BLOCK_SIDE, axis=1).repeat(BLOCK_SIDE, axis=2)[:, :height, :width]


def _best(squares: np.ndarray) -> np.ndarray:
    """Returns a mask without the worst 0.1 % of all pixels, since a few fireflies can dominate a mean."""
    return _without_largest(squares, TRIMMED)


def _without_largest(values: np.ndarray, share: float) -> np.ndarray:
    mask = np.zeros(values.size, bool)
    mask[np.argsort(values, axis=None)[: values.size - int(np.ceil(values.size * share))]] = True
    return mask.reshape(values.shape)


def wake(level: np.ndarray) -> np.ndarray:
    """Returns a mask of the pixels that a shadow has left in one of the last frames. The camera must be static."""
    shaded = level < SHADED * level.max(axis=0)
    left = np.zeros_like(shaded)
    for back in range(1, WAKE + 1):
        left[back:] |= shaded[:-back]
    return left & ~shaded


def error_in(mask: np.ndarray, seeds: tuple[np.ndarray, np.ndarray], halves: Halves, level: np.ndarray) -> float:
    """Returns relMSE of the pixels of a mask. All arrays have the frames that the halves show."""
    return float((noise_map(*seeds, level) + bias_map(*seeds, halves, level))[mask].mean())


def mean_light(images: np.ndarray, halves: Halves) -> float:
    """Returns the mean of pictures over that of the reference's frames; 1 if no light is lost or added."""
    return float(2.0 * images.mean() / (halves[0].mean() + halves[1].mean()))


def shares_of_old_light(images: np.ndarray, halves: Halves, change: int) -> list[float]:
    """Returns for each frame how much of the light from before frame `change` is there but should not be.

    1 at the change is the whole light that has gone off and is still there, or has gone on and is missing. Frames
    before the change that already show the new light have negative shares.
    """
    one, two = (half[change - 1] - half[change] for half in halves)
    shown = 0.5 * ((images - halves[0]) * two + (images - halves[1]) * one)
    return [float(share) for share in shown.sum(axis=(1, 2, 3)) / (one * two).sum()]


def lag(shares: list[float], change: int) -> int:
    """Returns the number of frames from `change` on until less than a twentieth of the light is wrong."""
    return next((late for late, share in enumerate(shares[change:]) if abs(share) < ANSWERED), len(shares) - change)


def lead(shares: list[float], change: int) -> int:
    """Returns how many frames before `change` more than a twentieth of the light is wrong for the first time."""
    return next((change - frame for frame, share in enumerate(shares[:change]) if abs(share) >= ANSWERED), 0)


def error_map(images: np.ndarray, reference: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Returns relMSE for each pixel."""
    return ((images - reference) ** 2 - variance).mean(axis=-1) / relative_to(reference)


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
    """Returns the mean without the worst 0.1 %."""
    found = np.sort(squares[np.isfinite(squares)])
    return float(found[: found.size - int(np.ceil(found.size * TRIMMED))].mean())
