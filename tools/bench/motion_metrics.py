"""How well vectors predict the next frame, and flicker along the way of what a pixel mostly shows: definitions of docs/benchmark/motion.md.

Sequences are float arrays (frames, height, width, channels), top row first. Vectors are as the passes have them: (previous − current,
current − next) in pixels, y upwards. Passes go by their names.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import temporal_metrics
from scipy.ndimage import gaussian_filter, map_coordinates

Passes = dict[str, np.ndarray]

WITHIN = 0.02  # of the light: what is predicted
DARK = 0.05  # of the picture's mean: a component with less light says nothing of motion; so does less reflectance
AROUND, REACH = 2.0, 2.5  # pixels: deviation of the mean around a pixel, and how many deviations it reaches
MOVES = 0.5  # pixels from which a pixel counts as moving
MAIN = 0.5  # share of the light from which a pixel shows a component
REFLECTANCE, IRRADIANCE, MOTION, TRACKED = " Reflectance", " Irradiance", " Motion", " Tracked"
SMOOTH = ("Reflection", "Transmission")
NOWHERE = 1e6  # pixels: a way that leaves every picture


def gray(images: np.ndarray) -> np.ndarray:
    return images[..., :3].mean(axis=-1)


def warped(following: np.ndarray, forward: np.ndarray) -> np.ndarray:
    """What the next frame (height, width) shows where the vectors `forward` (current − next) lead; NaN outside of it."""
    height, width = following.shape
    rows, columns = np.indices((height, width))
    rows, columns = rows + forward[..., 1], columns - forward[..., 0]
    inside = (rows >= 0) & (rows <= height - 1) & (columns >= 0) & (columns <= width - 1)
    return np.where(inside, map_coordinates(following, [rows, columns], order=3, mode="nearest"), np.nan)


def mean_product(differences: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Square of what independent estimates (parts, height, width) are estimates of: the mean product of two different ones, in which no
    noise is left, around each pixel of those that count."""
    parts = len(differences)
    products = (differences.sum(axis=0) ** 2 - (differences**2).sum(axis=0)) / (parts * (parts - 1))
    return _around(np.where(counts, products, 0.0)) / np.maximum(_around(counts.astype(float)), 1e-9)


def as_noisy(differences: np.ndarray, parts: int) -> np.ndarray:
    """Scaled, so that the mean product of these has the noise of that of as many parts: its variance goes by the number of products."""
    count = len(differences)
    return differences * (count * (count - 1) / (parts * (parts - 1))) ** 0.25


def _around(plane: np.ndarray) -> np.ndarray:
    return gaussian_filter(plane, AROUND, mode="constant", truncate=REACH)


@dataclass(frozen=True)
class Prediction:
    """Of one component from one frame to the next: relative squared errors by pixels, of which only `counts` count."""

    lit: np.ndarray  # where there is anything to predict
    counts: np.ndarray  # of those: tracked, and both ways lead into the picture
    moves: np.ndarray  # those whose way is not to stay
    own: np.ndarray
    surface: np.ndarray  # by the motion that its own is compared with
    noise: np.ndarray  # of the frame and itself by other samples: what is not 0 of it is noise

    def row(self) -> dict[str, Any]:
        return {"lit": int(self.lit.sum()), "all": self._shares(self.counts), "moving": self._shares(self.counts & self.moves)}

    def _shares(self, where: np.ndarray) -> dict[str, float | int]:
        """Of the pixels that are predicted; median error by their own ways."""
        if not where.any():
            return {"pixels": 0}
        shares = {name: float((getattr(self, name)[where] <= WITHIN**2).mean()) for name in ("own", "surface", "noise")}
        return {"pixels": int(where.sum())} | shares | {"median": float(np.sqrt(max(np.median(self.own[where]), 0.0)))}


@dataclass(frozen=True)
class Ways:
    """Steps to the next frame (height, width, 2), and where they are known."""

    own: np.ndarray
    surface: np.ndarray
    tracked: np.ndarray

    def moves(self) -> np.ndarray:
        return np.maximum(np.hypot(*np.moveaxis(self.own, -1, 0)), np.hypot(*np.moveaxis(self.surface, -1, 0))) > MOVES


def of_frame(passes: Passes, index: int) -> Passes:
    return {name: frames[index] for name, frames in passes.items()}


def predict(motion: Passes, parts: list[Passes], component: str) -> dict[str, Prediction]:
    """From the first of two frames to the second one: of light, and where there is light of reflectance, both compared with the motion of
    the surface that is seen, and of irradiance, compared with that of what the component shows. `motion`: passes of the first frame, by a
    seed that no picture has, since flow follows noise, too. `parts`: renderings with seeds of their own, four or more of an even number."""
    now = np.stack([gray(part[f"Path {component}"][0]) for part in parts])
    lit = now.mean(axis=0) > DARK * gray(parts[0]["Combined"][0]).mean()
    reflecting = lit & (gray(parts[0][f"Path {component}{REFLECTANCE}"][0]) > DARK)
    shown, light = ways_of_shown(motion, component), ways_of_light(motion, component)
    return {
        "": _predict(shown, parts, f"Path {component}", lit),
        "reflectance": _predict(shown, parts, f"Path {component}{REFLECTANCE}", reflecting),
        "irradiance": _predict(light, parts, f"Path {component}{IRRADIANCE}", reflecting),
    }


def ways_of_shown(motion: Passes, component: str) -> Ways:
    """Of what a component shows, beside those of the surface that is seen."""
    tracked = motion[f"Path {component}{TRACKED}"][..., 0] > 0.0
    return Ways(motion[f"Path {component}{MOTION}"][..., 2:], motion["Vector"][..., 2:], tracked)


def ways_of_light(motion: Passes, component: str) -> Ways:
    """Of its irradiance, beside those of what it shows."""
    shown = ways_of_shown(motion, component)
    tracked = motion[f"Path {component}{IRRADIANCE}{TRACKED}"][..., 0] > 0.0
    return Ways(motion[f"Path {component}{IRRADIANCE}{MOTION}"][..., 2:], shown.own, tracked & shown.tracked)


def _predict(ways: Ways, parts: list[Passes], plane: str, lit: np.ndarray) -> Prediction:
    now, following = (np.stack([gray(part[plane][frame]) for part in parts]) for frame in (0, 1))
    own, along = (np.stack([warped(after, steps) for after in following]) - now for steps in (ways.own, ways.surface))
    counts = ways.tracked & lit & np.isfinite(own[0]) & np.isfinite(along[0])

    def relative(differences: np.ndarray) -> np.ndarray:
        return mean_product(np.where(counts, differences, 0.0), counts) / np.maximum(now.mean(axis=0), 1e-9) ** 2

    again = as_noisy(now[::2] - now[1::2], len(parts))
    return Prediction(lit, counts, ways.moves(), relative(own), relative(along), relative(again))


def components(passes: Passes) -> list[str]:
    """Names, which have no blank, of those that tell whether they are tracked."""
    found = (name.removeprefix("Path ").removesuffix(TRACKED) for name in passes if name.startswith("Path ") and name.endswith(TRACKED))
    return [name for name in found if " " not in name]


def own_ways(passes: Passes) -> np.ndarray:
    """Vectors of what is mostly seen by reflection or refraction; elsewhere, and where it is not tracked, nowhere."""
    combined = gray(passes["Combined"])
    ways = np.full((*combined.shape, 4), NOWHERE)
    for name in (name for name in SMOOTH if f"Path {name}" in passes):
        shown = gray(passes[f"Path {name}"]) > MAIN * np.maximum(combined, 1e-9)
        tracked = passes[f"Path {name}{TRACKED}"][..., 0] > 0.0
        ways = np.where((shown & tracked)[..., None], passes[f"Path {name}{MOTION}"], ways)
    return ways


def check_finite(images: np.ndarray, what: str) -> None:
    """Of pixels (…, channels). Means over those that are finite would hide the others."""
    if wrong := int((~np.isfinite(images).all(axis=-1)).sum()):
        raise RuntimeError(f"{what}: {wrong} of {images[..., 0].size} pixels are not finite")


def flicker_measures(images: np.ndarray, reference: np.ndarray, variance: np.ndarray, ways: np.ndarray) -> dict[str, float | int]:
    """By their names in motion.jsonl, of the pixels that have a way alone; without the worst 0.1 %. All must be finite."""
    smooth = ways[..., 0] < NOWHERE
    along = temporal_metrics.warped_flicker_map(images, reference, variance, ways)
    errors = temporal_metrics.error_map(images, reference, variance)
    parted = along[temporal_metrics.moving(ways) & np.isfinite(along)]
    found = {"pixels": int(np.isfinite(along).sum()), "relmse_smooth": temporal_metrics.trimmed_mean(errors[smooth])}
    found["relmse"] = temporal_metrics.trimmed_mean(errors)
    found["flicker_own"] = temporal_metrics.trimmed_mean(along)
    return found | ({"flicker_own_moving": temporal_metrics.trimmed_mean(parted)} if parted.size else {})
