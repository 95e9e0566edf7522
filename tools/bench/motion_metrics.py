"""Measures how well motion vectors predict the next frame of a component, and flicker along the motion of what a pixel
mostly shows.

Sequences are float arrays (frames, height, width, channels), top row first. Vectors are as in the passes: (previous −
current, current − next) in pixels, y upwards. `Passes` are arrays by the names of the passes. "Own" is the motion of a
component, "surface" that of the first surface.

Errors of prediction are computed from several independent renderings of both frames. The mean product of two different
ones estimates the squared difference without noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import temporal_metrics
from scipy.ndimage import gaussian_filter, map_coordinates

Passes = dict[str, np.ndarray]

WITHIN = 0.02  # relative difference up to which a pixel is predicted
DARK = 0.05  # minimum light, relative to the picture's mean, and minimum reflectance of a pixel that is measured
AROUND, REACH = 2.0, 2.5  # standard deviation of the mean around a pixel, in pixels, and its radius in deviations
MOVES = 0.5  # pixels from which a pixel counts as moving
MAIN = 0.5  # share of a pixel's light above which it mostly shows a component
REFLECTANCE, IRRADIANCE, MOTION, TRACKED = " Reflectance", " Irradiance", " Motion", " Tracked"
SPECULAR = ("Reflection", "Transmission")
UNTRACKED = 1e6  # pixels: marks unknown motion, because it leads out of every picture


def gray(images: np.ndarray) -> np.ndarray:
    return images[..., :3].mean(axis=-1)


def warped(following: np.ndarray, forward: np.ndarray) -> np.ndarray:
    """Returns what the next frame (height, width) shows where the vectors `forward` (current − next) lead.

    NaN outside the picture.
    """
    height, width = following.shape
    rows, columns = np.indices((height, width))
    rows, columns = rows + forward[..., 1], columns - forward[..., 0]
    inside = (rows >= 0) & (rows <= height - 1) & (columns >= 0) & (columns <= width - 1)
    return np.where(inside, map_coordinates(following, [rows, columns], order=3, mode="nearest"), np.nan)


def mean_product(differences: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Returns the mean product of two different renderings' differences (renderings, height, width) around each pixel.

    Noise of the renderings is independent, so this is the squared expected difference, averaged over the pixels that
    count.
    """
    renderings = len(differences)
    products = (differences.sum(axis=0) ** 2 - (differences**2).sum(axis=0)) / (renderings * (renderings - 1))
    return _around(np.where(counts, products, 0.0)) / np.maximum(_around(counts.astype(float)), 1e-9)


def as_noisy(differences: np.ndarray, renderings: int) -> np.ndarray:
    """Scales differences so that their mean product has as much noise as that of so many renderings."""
    count = len(differences)
    return differences * (count * (count - 1) / (renderings * (renderings - 1))) ** 0.25


def _around(plane: np.ndarray) -> np.ndarray:
    return gaussian_filter(plane, AROUND, mode="constant", truncate=REACH)


@dataclass(frozen=True)
class Prediction:
    """Relative squared errors of one component's prediction from one frame to the next, for each pixel.

    Only `counts` are measured.
    """

    lit: np.ndarray  # pixels with enough light
    counts: np.ndarray  # lit pixels that are tracked and that both motions lead into the picture
    moves: np.ndarray  # pixels that either motion moves
    own: np.ndarray  # errors by the component's own motion
    surface: np.ndarray  # errors by the motion that it is compared with
    noise: np.ndarray  # difference between two renderings of the same frame

    def row(self) -> dict[str, Any]:
        """Returns the columns of a stored row: for all and for moving pixels their number and the shares that are
        predicted.
        """
        return {
            "lit": int(self.lit.sum()),
            "all": self._shares(self.counts),
            "moving": self._shares(self.counts & self.moves),
        }

    def _shares(self, where: np.ndarray) -> dict[str, float | int]:
        """Returns number of pixels, shares that are predicted, and median error by the own motion."""
        if not where.any():
            return {"pixels": 0}
        shares = {name: float((getattr(self, name)[where] <= WITHIN**2).mean()) for name in ("own", "surface", "noise")}
        return {"pixels": int(where.sum())} | shares | {"median": float(np.sqrt(max(np.median(self.own[where]), 0.0)))}


@dataclass(frozen=True)
class Vectors:
    """Steps to the next frame (height, width, 2), and where they are known."""

    own: np.ndarray
    surface: np.ndarray
    tracked: np.ndarray

    def moves(self) -> np.ndarray:
        own, surface = (np.hypot(*np.moveaxis(steps, -1, 0)) for steps in (self.own, self.surface))
        return np.maximum(own, surface) > MOVES


def of_frame(passes: Passes, index: int) -> Passes:
    """Returns the passes of one frame."""
    return {name: frames[index] for name, frames in passes.items()}


def predict(motion: Passes, renderings: list[Passes], component: str) -> dict[str, Prediction]:
    """Predicts the second of two frames from the first one: a component's light (""), reflectance and irradiance.

    Light and reflectance by the component's motion are compared with those by the motion of the first surface;
    irradiance by its own motion is compared with that by the component's. `motion` are passes of the first frame with a
    seed that no rendering has, since optical flow follows noise, too. `renderings` are an even number, four or more, of
    renderings of both frames with different seeds.
    """
    now = np.stack([gray(rendering[f"Path {component}"][0]) for rendering in renderings])
    lit = now.mean(axis=0) > DARK * gray(renderings[0]["Combined"][0]).mean()
    reflecting = lit & (gray(renderings[0][f"Path {component}{REFLECTANCE}"][0]) > DARK)
    shown, light = vectors_of_component(motion, component), vectors_of_irradiance(motion, component)
    return {
        "": _predict(shown, renderings, f"Path {component}", lit),
        "reflectance": _predict(shown, renderings, f"Path {component}{REFLECTANCE}", reflecting),
        "irradiance": _predict(light, renderings, f"Path {component}{IRRADIANCE}", reflecting),
    }


def vectors_of_component(motion: Passes, component: str) -> Vectors:
    """Returns the vectors of what a component shows and those of the first surface."""
    tracked = motion[f"Path {component}{TRACKED}"][..., 0] > 0.0
    return Vectors(motion[f"Path {component}{MOTION}"][..., 2:], motion["Vector"][..., 2:], tracked)


def vectors_of_irradiance(motion: Passes, component: str) -> Vectors:
    """Returns the vectors of a component's irradiance and those of what the component shows."""
    shown = vectors_of_component(motion, component)
    tracked = motion[f"Path {component}{IRRADIANCE}{TRACKED}"][..., 0] > 0.0
    return Vectors(motion[f"Path {component}{IRRADIANCE}{MOTION}"][..., 2:], shown.own, tracked & shown.tracked)


def _predict(vectors: Vectors, renderings: list[Passes], plane: str, lit: np.ndarray) -> Prediction:
    now, following = (np.stack([gray(rendering[plane][frame]) for rendering in renderings]) for frame in (0, 1))
    own, along = (
        np.stack([warped(after, steps) for after in following]) - now for steps in (vectors.own, vectors.surface)
    )
    counts = vectors.tracked & lit & np.isfinite(own[0]) & np.isfinite(along[0])

    def relative(differences: np.ndarray) -> np.ndarray:
        return mean_product(np.where(counts, differences, 0.0), counts) / np.maximum(now.mean(axis=0), 1e-9) ** 2

    again = as_noisy(now[::2] - now[1::2], len(renderings))
    return Prediction(lit, counts, vectors.moves(), relative(own), relative(along), relative(again))


def components(passes: Passes) -> list[str]:
    """Returns the names of the components that have a pass Tracked. Names of components have no space."""
    tracked = (name for name in passes if name.startswith("Path ") and name.endswith(TRACKED))
    found = (name.removeprefix("Path ").removesuffix(TRACKED) for name in tracked)
    return [name for name in found if " " not in name]


def component_vectors(passes: Passes) -> np.ndarray:
    """Returns the vectors of the reflection or refraction that a pixel mostly shows.

    UNTRACKED elsewhere and where it is not tracked.
    """
    combined = gray(passes["Combined"])
    vectors = np.full((*combined.shape, 4), UNTRACKED)
    for name in (name for name in SPECULAR if f"Path {name}" in passes):
        shown = gray(passes[f"Path {name}"]) > MAIN * np.maximum(combined, 1e-9)
        tracked = passes[f"Path {name}{TRACKED}"][..., 0] > 0.0
        vectors = np.where((shown & tracked)[..., None], passes[f"Path {name}{MOTION}"], vectors)
    return vectors


def check_finite(images: np.ndarray, what: str) -> None:
    """Raises RuntimeError if pixels (..., channels) are not finite, because a mean over the others would hide them."""
    if wrong := int((~np.isfinite(images).all(axis=-1)).sum()):
        raise RuntimeError(f"{what}: {wrong} of {images[..., 0].size} pixels are not finite")


def flicker_measures(
    images: np.ndarray, reference: np.ndarray, variance: np.ndarray, vectors: np.ndarray
) -> dict[str, float | int]:
    """Returns, by their names in stored rows, flicker and relMSE of the pixels that have vectors, and relMSE of all.

    All trimmed.
    """
    specular = vectors[..., 0] < UNTRACKED
    along = temporal_metrics.warped_flicker_map(images, reference, variance, vectors)
    errors = temporal_metrics.error_map(images, reference, variance)
    moving = along[temporal_metrics.moving(vectors) & np.isfinite(along)]
    found = {
        "pixels": int(np.isfinite(along).sum()),
        "relmse_specular": temporal_metrics.trimmed_mean(errors[specular]),
    }
    found["relmse"] = temporal_metrics.trimmed_mean(errors)
    found["flicker_component"] = temporal_metrics.trimmed_mean(along)
    return found | ({"flicker_component_moving": temporal_metrics.trimmed_mean(moving)} if moving.size else {})
