"""Cryptomattes as images of coverage, because floats that hold hashes have no mean."""

from __future__ import annotations

import re

import numpy as np
from support import images

_RANKS = re.compile(r"(.*Crypto[A-Za-z]+)\d\d")


def group(name: str) -> str | None:
    """Returns the name of a Cryptomatte without the number of its ranks, or None for another pass."""
    match = _RANKS.fullmatch(name)
    return match.group(1) if match else None


def coverage(passes: images.Passes, name: str) -> dict[int, np.ndarray]:
    """Returns the coverage of each identifier, as bits, of the Cryptomatte of that name."""
    found: dict[int, np.ndarray] = {}
    for image in (image for full_name, image in passes.items() if group(full_name) == name):
        for rank in (0, 2):
            bits = np.ascontiguousarray(image[..., rank], np.float32).view(np.uint32)
            for identifier in np.unique(bits[image[..., rank + 1] > 0.0]):
                plane = found.setdefault(int(identifier), np.zeros(bits.shape, np.float32))
                plane += np.where(bits == identifier, image[..., rank + 1], 0.0)
    return found


def stacked(planes: dict[int, np.ndarray], identifiers: list[int], like: np.ndarray) -> np.ndarray:
    """Returns the coverage of the identifiers as the channels of one image of the size of `like`."""
    nothing = np.zeros(like.shape[:2], np.float32)
    return np.stack([planes.get(identifier, nothing) for identifier in identifiers] or [nothing], axis=2)
