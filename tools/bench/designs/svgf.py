"""Spatiotemporal variance-guided filtering (Schied et al. 2017), over frames of an animation in their order.

How it was read, section by section of the paper:

- 4.1: Light is divided by the albedo of the surface and accumulated with α = 0.2, in the first frames of a history with
  one over its length. The history is read bilinearly where the surface was, from pixels with a consistent depth and
  normal; where none of the four is, from the consistent ones of 3×3. Films hold no numbers of meshes. Pixels without a
  correspondence (which are one-to-one) take the motion of a neighbor, and the same tests apply.
- 4.2: The variance is that of the accumulated moments of luminance. Histories of less than four frames take moments of
  7×7 pixels, weighted by depth and normal.
- 4.3: Five levels; the first one goes into the history of colors.
- 4.4: σ of depth, normal and luminance are 1, 128 and 4. The slope of the depth is the smaller one of both sides,
  since films hold no derivatives.

Direct and indirect light are filtered together, because films hold their sum. Depth, normal and albedo are means over
the samples of a pixel and show what mirrors show. Behind rough mirrors they are noisy, unlike those of a raster image,
so they are filtered as for NFOR. Antialiasing over time, a pass behind the filter, is left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from metrics import LUMINANCE
from scipy.ndimage import correlate

from . import nlm
from .animations import Frame, Motion
from .films import mean_of

ALPHA = 0.2  # share of the newest frame
LEVELS = 5
SIGMA_DEPTH, SIGMA_NORMAL, SIGMA_LUMINANCE = 1.0, 128.0, 4.0
SHORT = 4  # frames of history from which its variance is used
SPATIAL_RADIUS = 3
KERNEL = np.array((1.0, 4.0, 6.0, 4.0, 1.0)) / 16.0
GAUSSIAN = np.outer((1.0, 2.0, 1.0), (1.0, 2.0, 1.0)) / 16.0
BLACK = 0.01  # albedo below which light is divided by this one
DEPTH_TOLERANCE = 0.05  # share of the depth by which consistent surfaces may differ, beside their slope
NORMAL_TOLERANCE = 0.9  # cosine of the angle between consistent normals
FLAT = 2e-3  # share of the depth that differs between neighbours for other reasons than a slope
SHORTEST_NORMAL = 1e-3  # of a mean normal that is one
TINY = 1e-10
HOLE_STEPS = 2  # pixels from which holes of the motion are filled


@dataclass(frozen=True)
class Surface:
    """What pixels show, without light."""

    depth: np.ndarray  # (height, width)
    slope: np.ndarray  # (height, width, 2): change of the depth per pixel, downwards and to the right
    normal: np.ndarray  # (height, width, 4) of unit length; the fourth component is 1 where there is no surface
    albedo: np.ndarray  # (height, width, 3), not 0


@dataclass(frozen=True)
class History:
    """What is accumulated over frames."""

    light: np.ndarray  # (height, width, 3), without albedo
    moments: np.ndarray  # (height, width, 2): mean luminance of light, and mean of its square
    length: np.ndarray  # (height, width, 1) frames


def reconstruct(frames: Sequence[Frame]) -> Iterator[np.ndarray]:
    """Yields the picture of each frame."""
    history, previous = None, None
    for frame in frames:
        surface = surface_of(frame.features)
        light = mean_of(frame.film).image / surface.albedo
        motion = frame.before if history is not None else None
        accumulated = accumulate(light, surface, None if motion is None else (history, previous, filled(motion)))
        levels = filtered(accumulated.light, variance_of(accumulated, surface), surface)
        history = History(next(levels), accumulated.moments, accumulated.length)
        *_, last = levels
        previous = surface
        yield last * surface.albedo


def surface_of(features: np.ndarray) -> Surface:
    """Returns the surfaces of features (films.Half). Their depth has the median of the film as its unit."""
    share = features[:, :, 6]
    depth = share / np.maximum(1.0 - share, TINY)
    normal = 2.0 * features[:, :, :3] - 1.0
    length = np.linalg.norm(normal, axis=2, keepdims=True)
    hit = (share > 0.0)[:, :, None] & (length > SHORTEST_NORMAL)
    unit = np.concatenate([np.where(hit, normal / np.maximum(length, TINY), 0.0), ~hit], axis=2)
    return Surface(depth, slope_of(depth), unit, np.maximum(features[:, :, 3:6], BLACK))


def slope_of(depth: np.ndarray) -> np.ndarray:
    """Returns the smaller one of the differences to both sides, which is that of the same surface at an edge."""

    def along(axis: int) -> np.ndarray:
        step = np.diff(depth, axis=axis)
        if not step.size:
            return np.zeros_like(depth)
        ahead = np.concatenate([step, step.take([-1], axis)], axis)
        behind = np.concatenate([step.take([0], axis), step], axis)
        return np.where(np.abs(ahead) < np.abs(behind), ahead, behind)

    return np.stack([along(0), along(1)], axis=2)


def filled(motion: Motion) -> Motion:
    """Returns a motion in which pixels without a correspondence move as the next pixel that has one."""
    height, width = motion.shown.shape
    place = np.stack(np.indices((height, width)), axis=2)
    moved, displacement, shown = motion.source - place, motion.displacement, motion.shown
    for _ in range(HOLE_STEPS):
        for offset in ((0, -1), (0, 1), (-1, 0), (1, 0)):
            found = ~shown & nlm.shifted(shown, *offset)
            moved = np.where(found[:, :, None], nlm.shifted(moved, *offset), moved)
            displacement = np.where(found[:, :, None], nlm.shifted(displacement, *offset), displacement)
            shown = shown | found
    return Motion(np.where(shown[:, :, None], place + moved, 0), displacement, shown)


def accumulate(light: np.ndarray, surface: Surface, before: tuple[History, Surface, Motion] | None) -> History:
    """Returns the history with a frame added to it; it begins anew where the frame before does not show the surface."""
    luminance = light @ LUMINANCE
    moments = np.stack([luminance, luminance**2], axis=2)
    if before is None:
        return History(light, moments, np.ones((*luminance.shape, 1)))
    past = reprojected(*before, surface)
    length = past.length + 1.0
    alpha = np.maximum(ALPHA, 1.0 / length)
    return History(alpha * light + (1.0 - alpha) * past.light, alpha * moments + (1.0 - alpha) * past.moments, length)


def reprojected(history: History, previous: Surface, motion: Motion, surface: Surface) -> History:
    """Returns the history at the pixels that show the same surfaces now; its length is 0 where there is none."""
    place = motion.source - motion.displacement
    nearest = motion.source
    total, weights = _taps(history, previous, motion, surface, np.floor(place).astype(int), (0, 1), place)
    wider, more = _taps(history, previous, motion, surface, nearest, (-1, 0, 1), None)
    few = weights < 0.01
    total, weights = np.where(few, wider, total), np.where(few, more, weights)
    mean = total / np.maximum(weights, TINY)
    return History(mean[:, :, :3], mean[:, :, 3:5], np.floor(mean[:, :, 5:] + 0.5))


def _taps(
    history: History,
    previous: Surface,
    motion: Motion,
    surface: Surface,
    corner: np.ndarray,
    steps: tuple[int, ...],
    place: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Returns the sum of the consistent pixels at `corner` + `steps` and that of their weights.

    These are bilinear around `place`, or 1.
    """
    height, width = surface.depth.shape
    stored = np.concatenate([history.light, history.moments, history.length], axis=2)
    total, weights = np.zeros_like(stored), np.zeros((height, width, 1))
    for dy in steps:
        for dx in steps:
            row, column = corner[:, :, 0] + dy, corner[:, :, 1] + dx
            inside = motion.shown & (row >= 0) & (row < height) & (column >= 0) & (column < width)
            at = row.clip(0, height - 1), column.clip(0, width - 1)
            weight = inside & consistent(surface, previous, at)
            if place is not None:
                weight = weight * np.prod(1.0 - np.abs(place - np.stack([row, column], axis=2)), axis=2)
            total += weight[:, :, None] * stored[at]
            weights += weight[:, :, None]
    return total, weights


def consistent(surface: Surface, previous: Surface, at: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Returns whether pixels of the frame before may show the same surface, by depth and normal."""
    tolerance = DEPTH_TOLERANCE * surface.depth + 2.0 * np.abs(surface.slope).sum(axis=2)
    near = np.abs(surface.depth - previous.depth[at]) <= tolerance
    return near & ((surface.normal * previous.normal[at]).sum(axis=2) >= NORMAL_TOLERANCE)


def variance_of(history: History, surface: Surface) -> np.ndarray:
    """Returns the variance of the luminance of light (height, width)."""

    def weight(offset: tuple[int, int]) -> np.ndarray:
        return geometric_weight(surface, offset)[:, :, None]

    spatial = nlm.average(history.moments, SPATIAL_RADIUS, weight)
    short = history.length < SHORT
    moments = np.where(short, spatial, history.moments)
    # As in the authors' code, variances of short histories are raised.
    raised = np.where(short, SHORT / history.length, 1.0)[:, :, 0]
    return raised * np.maximum(moments[:, :, 1] - moments[:, :, 0] ** 2, 0.0)


def geometric_weight(surface: Surface, offset: tuple[int, int]) -> np.ndarray:
    """Returns the weight of p + offset by its depth and normal (equations 3 and 4 of the paper)."""
    expected = np.abs(surface.slope @ np.array(offset, float))
    difference = np.abs(surface.depth - nlm.shifted(surface.depth, *offset))
    depth = np.exp(-difference / (SIGMA_DEPTH * expected + FLAT * surface.depth + TINY))
    return depth * np.maximum((surface.normal * nlm.shifted(surface.normal, *offset)).sum(axis=2), 0.0) ** SIGMA_NORMAL


def filtered(light: np.ndarray, variance: np.ndarray, surface: Surface) -> Iterator[np.ndarray]:
    """Yields light after each level of the à-trous filter."""
    for level in range(LEVELS):
        light, variance = filtered_once(light, variance, surface, 2**level)
        yield light


def filtered_once(
    light: np.ndarray, variance: np.ndarray, surface: Surface, step: int
) -> tuple[np.ndarray, np.ndarray]:
    """Returns light and its variance after one level, whose 5×5 pixels are `step` apart (equations 1, 2 and 5)."""
    luminance = light @ LUMINANCE
    deviation = np.sqrt(np.maximum(correlate(variance, GAUSSIAN, mode="nearest"), 0.0))
    total, total_variance, weights = np.zeros_like(light), np.zeros_like(variance), np.zeros_like(variance)
    for i, j in nlm.window(2):
        offset = step * i, step * j
        if not nlm.reached(light.shape, *offset):
            continue
        difference = np.abs(luminance - nlm.shifted(luminance, *offset))
        weight = np.exp(-difference / (SIGMA_LUMINANCE * deviation + TINY)) * geometric_weight(surface, offset)
        weight *= KERNEL[i + 2] * KERNEL[j + 2] * nlm.inside(light.shape, *offset)[:, :, 0]
        total += weight[:, :, None] * nlm.shifted(light, *offset)
        total_variance += weight**2 * nlm.shifted(variance, *offset)
        weights += weight
    return total / weights[:, :, None], total_variance / weights**2
