"""Variants of an animation: size, number of frames and motion blur. Runs of different variants are never compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

SHUTTER = 0.5  # in frames, if there is motion blur


@dataclass(frozen=True, order=True)
class Variant:
    size: tuple[int, int] = (640, 360)
    length: int = 24  # frames
    shutter: float = 0.0  # in frames; 0 = no motion blur

    @property
    def title(self) -> str:
        """Names the differences from the usual variant."""
        size = [f"{self.size[0]}×{self.size[1]} pixels"] if self.size != USUAL.size else []
        length = [f"{self.length} frames"] if self.length != USUAL.length else []
        blur = [f"motion blur, shutter {self.shutter:g}"] if self.shutter != USUAL.shutter else []
        return ", ".join(size + length + blur)

    def row(self) -> dict[str, Any]:
        """Returns the columns of a stored row that describe the variant.

        The frames are in a column of the animation.
        """
        return {"width": self.size[0], "height": self.size[1], "shutter": self.shutter}


USUAL = Variant()


def of_row(row: dict[str, Any]) -> Variant:
    first, last = row["frames"]
    return Variant((row["width"], row["height"]), last - first + 1, row["shutter"])
