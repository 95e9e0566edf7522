"""In what runs of animations differ besides mode, samples and seed. Rows of different variants are never compared."""

from __future__ import annotations

from dataclasses import dataclass

SHUTTER = 0.5  # of a frame, where there is motion blur


@dataclass(frozen=True, order=True)
class Variant:
    size: tuple[int, int] = (160, 90)
    length: int = 10  # frames
    shutter: float = 0.0  # of a frame; 0 = no motion blur

    @property
    def title(self) -> str:
        """In what it differs from the usual one."""
        size = [f"{self.size[0]}×{self.size[1]} pixels"] if self.size != USUAL.size else []
        length = [f"{self.length} frames"] if self.length != USUAL.length else []
        blur = [f"motion blur, shutter {self.shutter:g}"] if self.shutter != USUAL.shutter else []
        return ", ".join(size + length + blur)

    def row(self) -> dict:
        """Its part of a stored row; the frames are those of the animation."""
        return {"width": self.size[0], "height": self.size[1], "shutter": self.shutter}


USUAL = Variant()


def of_row(row: dict) -> Variant:
    """The first rows were stored before there was motion blur."""
    first, last = row["frames"]
    return Variant((row["width"], row["height"]), last - first + 1, row.get("shutter", 0.0))
