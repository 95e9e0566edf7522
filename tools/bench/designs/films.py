"""A stored film as two half-buffers of images, differences and features. The first row is the top."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

LARGEST = 1e8  # limit of radiance, whose squares must be finite


@dataclass(frozen=True)
class Half:
    """Means over the samples of one half-buffer, float64 (height, width, channels)."""

    image: np.ndarray
    dx: np.ndarray  # image at the right neighbour less image here; the last column is 0
    dy: np.ndarray  # image in the row below less image here; the last row is 0
    features: (
        np.ndarray
    )  # each channel in [0, 1]: normal, albedo, d/(d + median) of the depth d, x, y, as REGULARIZED has them


Film = tuple[Half, Half]


def planes_of(path: Path) -> dict[str, np.ndarray]:
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = [channel for part in file.parts for channel in part.channels.items()]
        return {name: np.asarray(channel.pixels, dtype=np.float64) for name, channel in channels}


def film_of(planes: dict[str, np.ndarray], median: float | None = None) -> Film:
    """Returns the two half-buffers of a stored film, from its channels by name.

    `median` is the depth that becomes ½ as a feature; if not given, the median of this film.
    """
    depths = [_mean_of_samples(planes, half, f"{half}.Denoising_Depth", "V") for half in "AB"]
    median = median or _median_of_positive(np.concatenate(depths))
    a, b = (_half_of(planes, half, depth / (depth + median)) for half, depth in zip("AB", depths, strict=True))
    return a, b


def tidied(half: Half) -> Half:
    """Returns a half-buffer without invalid numbers: NaN and infinity become 0, and values are limited.

    A difference of a pair without samples is replaced by the image's own difference.
    """
    image = np.clip(np.nan_to_num(half.image, nan=0.0), -LARGEST, LARGEST)
    dx, dy = (
        np.clip(np.where(np.isnan(sampled), own, sampled), -2 * LARGEST, 2 * LARGEST)
        for sampled, own in zip((half.dx, half.dy), differences(image), strict=True)
    )
    return Half(image, dx, dy, np.clip(np.nan_to_num(half.features, nan=0.0), 0.0, 1.0))


def mean_of(film: Film) -> Half:
    a, b = film
    return Half(*(0.5 * (getattr(a, field.name) + getattr(b, field.name)) for field in fields(Half)))


def differences(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the differences of an image to its right and lower neighbors (H^dx and H^dy of the thesis)."""
    dx, dy = np.zeros_like(image), np.zeros_like(image)
    dx[:, :-1] = image[:, 1:] - image[:, :-1]
    dy[:-1] = image[1:] - image[:-1]
    return dx, dy


def _half_of(planes: dict[str, np.ndarray], half: str, depth: np.ndarray) -> Half:
    image = _mean_of_samples(planes, half, half, "RGB")
    dx, dy = np.zeros_like(image), np.zeros_like(image)
    dx[:, :-1] = _mean_of_pairs(planes, half, "right")[:, :-1] - _mean_of_pairs(planes, half, "left")[:, 1:]
    dy[:-1] = _mean_of_pairs(planes, half, "down")[:-1] - _mean_of_pairs(planes, half, "up")[1:]
    return tidied(Half(image, dx, dy, np.concatenate([_surface(planes, half), depth, _place(image)], axis=2)))


def _mean_of_pairs(planes: dict[str, np.ndarray], half: str, offset: str) -> np.ndarray:
    """Returns the mean of the samples from one end of each pair, or NaN where there are none, as in films of paths."""
    if f"{half}.{offset}.pairs.V" not in planes:
        return np.full((*planes[f"{half}.count.V"].shape, 3), np.nan)
    pairs = planes[f"{half}.{offset}.pairs.V"][:, :, None]
    return _vector(planes, f"{half}.{offset}", "RGB") / np.where(pairs > 0.0, pairs, np.nan)


def _mean_of_samples(planes: dict[str, np.ndarray], half: str, name: str, channels: str) -> np.ndarray:
    return _vector(planes, name, channels) / np.maximum(planes[f"{half}.count.V"], 1.0)[:, :, None]


def _surface(planes: dict[str, np.ndarray], half: str) -> np.ndarray:
    normal, albedo = (
        _mean_of_samples(planes, half, f"{half}.Denoising_{name}", "XYZ") for name in ("Normal", "Albedo")
    )
    return np.concatenate([0.5 + 0.5 * normal, albedo], axis=2)


def _place(image: np.ndarray) -> np.ndarray:
    y, x = np.indices(image.shape[:2]) / max(image.shape[:2])
    return np.stack([x, y], axis=2)


def _vector(planes: dict[str, np.ndarray], name: str, channels: str) -> np.ndarray:
    return np.stack([planes[f"{name}.{channel}"] for channel in channels], axis=2)


def _median_of_positive(depth: np.ndarray) -> float:
    positive = depth[depth > 0.0]
    return float(np.median(positive)) if positive.size else 1.0
