"""Runs inside Blender and joins small copies of pictures in rows.

The environment variable GRADUS_STRIP_FRAMES has the files as JSON, and GRADUS_STRIP is the file to write.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import bpy
import numpy as np

WIDTH, COLUMNS, GAP = 160, 6, 2  # pixels of a small picture, pictures in a row, pixels between them


def small(file: str) -> np.ndarray:
    """Returns a small copy of a picture as RGBA (height, width, 4), lowest row first."""
    image = bpy.data.images.load(file)
    width, height = image.size
    image.scale(WIDTH, max(1, round(WIDTH * height / width)))
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)


def strip(pictures: list[np.ndarray]) -> np.ndarray:
    """Joins pictures of equal size in rows from the top left, on black."""
    height, width, _ = pictures[0].shape
    rows = -(-len(pictures) // COLUMNS)
    columns = min(COLUMNS, len(pictures))
    joined = np.zeros((rows * (height + GAP) - GAP, columns * (width + GAP) - GAP, 4), dtype=np.float32)
    joined[..., 3] = 1.0
    for i, picture in enumerate(pictures):
        row, column = divmod(i, COLUMNS)
        bottom, left = joined.shape[0] - row * (height + GAP) - height, column * (width + GAP)
        joined[bottom : bottom + height, left : left + width] = picture
    return joined


def save(pixels: np.ndarray, file: str) -> None:
    height, width, _ = pixels.shape
    image = bpy.data.images.new("Strip", width, height)
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = file, "PNG"
    image.save()


frames = [file for file in json.loads(os.environ["GRADUS_STRIP_FRAMES"]) if Path(file).exists()]
if not frames:
    raise SystemExit("film strip: there are no frames")
save(strip([small(file) for file in frames]), os.environ["GRADUS_STRIP"])
