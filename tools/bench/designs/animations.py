"""Frames of a stored animation: films with the motion of their surfaces since the frame before. The first row is the
top.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from . import nlm
from .films import Film, Half, film_of, planes_of

NONE = 2**31  # pixel indices from here on stand for no correspondence


@dataclass(frozen=True)
class Motion:
    """Says which pixel of another frame shows the surface of each pixel.

    The centre of pixel `source` lies at `displacement` from the centre of the pixel that shows its surface here.
    """

    source: np.ndarray  # (height, width, 2) row and column in the other frame; 0 where nothing is shown
    displacement: np.ndarray  # (height, width, 2) pixels down and to the right, in [-0.5, 0.5]
    shown: np.ndarray  # (height, width) True where the other frame shows the surface

    def read(self, image: np.ndarray) -> np.ndarray:
        """Returns an image of the other frame at the pixels that show its surfaces here; 0 where there are none."""
        read = image[self.source[:, :, 0], self.source[:, :, 1]]
        shown = self.shown.reshape(self.shown.shape + (1,) * (image.ndim - 2))
        return np.where(shown, read, np.zeros((), image.dtype))


@dataclass(frozen=True)
class Frame:
    """One frame of an animation."""

    film: Film
    features: (
        np.ndarray
    )  # (height, width, channels) of both halves, filtered, since they are noisy behind rough mirrors
    before: Motion | None = None  # to the frame before; None in the first frame and at shot changes


def frame_numbers(folder: Path) -> list[int]:
    """Returns the numbers of the frames in a folder of a frame store."""
    return sorted(int(file.name.partition(".")[0].removeprefix("f")) for file in folder.glob("f*.fresh.exr"))


def read_frames(folder: Path, numbers: Sequence[int], part: tuple[slice, slice] | None = None) -> list[Frame]:
    """Returns successive frames of a folder of a frame store, or some of their rows and columns.

    Their depths as features have a common unit.
    """
    frames: list[Frame] = []
    median = None
    for number in numbers:
        planes = planes_of(file_of(folder, number, "fresh"))
        median = median or median_depth(planes)
        before = motion_of(planes_of(file_of(folder, number, "replayed"))) if frames else None
        film = film_of(planes, median)
        frames.append(frame_of(*((film, before) if part is None else cropped(film, before, part))))
    return frames


def frame_of(film: Film, before: Motion | None) -> Frame:
    return Frame(film, nlm.filtered([half.features for half in film]), before)


def file_of(folder: Path, number: int, part: str) -> Path:
    """Returns the file of the fresh or replayed samples of a frame."""
    return folder / f"f{number:+08d}.{part}.exr"


def median_depth(planes: dict[str, np.ndarray]) -> float:
    """Returns the median depth of the pixels that show a surface, as a mean over samples."""
    depth = planes["A.Denoising_Depth.V"] + planes["B.Denoising_Depth.V"]
    depth = depth / np.maximum(planes["A.count.V"] + planes["B.count.V"], 1.0)
    return float(np.median(depth[depth > 0.0])) if (depth > 0.0).any() else 1.0


def motion_of(planes: dict[str, np.ndarray]) -> Motion | None:
    """Returns the pixel correspondence of a stored film, whose pixel indices and displacements run upwards."""
    if "correspondence.V" not in planes:
        return None
    index = planes["correspondence.V"].astype(np.int64)
    height, width = index.shape
    shown = index < NONE
    index = np.where(shown, index, 0)
    source = np.stack([np.where(shown, height - 1 - index // width, 0), index % width], axis=2)
    zero = np.zeros((height, width))
    up, right = (planes.get(f"correspondence.off_centre.{axis}", zero) for axis in "YX")
    return Motion(source, np.stack([-up, right], axis=2), shown)


def own(height: int, width: int) -> Motion:
    """Returns the motion between a frame and itself."""
    shape = (height, width)
    return Motion(np.stack(np.indices(shape), axis=2), np.zeros((*shape, 2)), np.ones(shape, bool))


def inverse(motion: Motion) -> Motion:
    """Returns the motion the other way. Motions are one-to-one."""
    place = np.stack(np.indices(motion.shown.shape), axis=2)
    found = _nothing(motion.shown.shape)
    _put(found, motion.source[motion.shown], place[motion.shown], -motion.displacement[motion.shown])
    return found


def joined(near: Motion, far: Motion) -> Motion:
    """Returns the motion to the frame to which `far` leads from the frame to which `near` leads.

    Displacements add up. Where they exceed half a pixel, the source belongs to the next pixel; of two that arrive in
    one pixel the nearer to its centre is kept.
    """
    place = np.stack(np.indices(near.shown.shape), axis=2)
    shown = near.shown & near.read(far.shown)
    displacement = (near.displacement + near.read(far.displacement))[shown]
    source, steps = near.read(far.source)[shown].astype(np.int64), np.rint(displacement).astype(np.int64)
    to, rest = place[shown] + steps, displacement - steps
    inside = ((to >= 0) & (to < near.shown.shape)).all(axis=1)
    order = np.argsort(-(rest[inside] ** 2).sum(axis=1), kind="stable")  # the nearest is written last
    found = _nothing(near.shown.shape)
    _put(found, to[inside][order], source[inside][order], rest[inside][order])
    return found


def _nothing(shape: tuple[int, ...]) -> Motion:
    return Motion(np.zeros((*shape, 2), np.int64), np.zeros((*shape, 2)), np.zeros(shape, bool))


def _put(motion: Motion, to: np.ndarray, source: np.ndarray, displacement: np.ndarray) -> None:
    row, column = to.T
    motion.source[row, column], motion.displacement[row, column] = source, displacement
    motion.shown[row, column] = True


def motions_around(frames: Sequence[Frame], picture: int, reach: int) -> dict[int, Motion]:
    """Returns the motions from a frame to those up to `reach` frames before and after it, up to a shot change."""
    found = {picture: own(*frames[picture].features.shape[:2])}
    for other in range(picture - 1, max(picture - reach, 0) - 1, -1):
        if (step := frames[other + 1].before) is None:
            break
        found[other] = joined(found[other + 1], step)
    for other in range(picture + 1, min(picture + reach, len(frames) - 1) + 1):
        if (step := frames[other].before) is None:
            break
        found[other] = joined(found[other - 1], inverse(step))
    return found


def cropped(film: Film, before: Motion | None, part: tuple[slice, slice]) -> tuple[Film, Motion | None]:
    """Returns rows and columns of a film. Surfaces that come from outside are shown by no pixel of the frame before."""
    a, b = (Half(*(getattr(half, field.name)[part] for field in fields(Half))) for half in film)
    if before is None:
        return (a, b), None
    rows, columns = part
    source = before.source[part] - (rows.start, columns.start)
    size = rows.stop - rows.start, columns.stop - columns.start
    shown = before.shown[part] & ((source >= 0) & (source < size)).all(axis=2)
    return (a, b), Motion(np.where(shown[:, :, None], source, 0), before.displacement[part], shown)
