"""Pixels that Blender decodes: of movies, painted images, and files in formats that the library does not read.

`Image.pixels` holds the frame of a movie or sequence that was last looked up, and only the first tile of a tiled image.
Evaluating an image texture looks up any frame (measured in Blender 3.4, 4.5 and 5.2). Other tiles are loaded as images
of their own.
"""

from __future__ import annotations

import threading
from array import array
from dataclasses import dataclass
from typing import Any

import bpy

from .arrays import zeros

_NAME = ".gradus image reader"
_lock = threading.Lock()
"""Held from the look-up of a frame until it is read: a viewport and a final render export on different threads."""


@dataclass
class Pixels:
    """An image as Blender holds it in memory."""

    width: int
    height: int
    values: array  # RGBA, bottom row first: bytes, or floats from 0 to 1 if there is no NumPy to convert them
    is_float: bool  # whether Blender stores it as floats, which are scene-linear with associated alpha


def of_image(image: Any) -> Pixels | None:
    """Returns the current pixels of an image, or None if Blender cannot read it."""
    width, height = image.size
    if width == 0 or height == 0:
        return None
    values = zeros("f", width * height * image.channels)
    image.pixels.foreach_get(values)
    if image.channels != 4:
        values = _to_rgba(values, image.channels)
    is_float = bool(image.is_float)
    return Pixels(width, height, values if is_float else _to_bytes(values), is_float)


def of_frame(image: Any, number: int) -> Pixels | None:
    """Returns a frame of a movie or image sequence."""
    with _lock:
        texture = bpy.data.textures.get(_NAME) or bpy.data.textures.new(_NAME, "IMAGE")
        texture.image = image.original
        texture.image_user.frame_current = number
        texture.evaluate((0.0, 0.0, 0.0))
        return of_image(image.original)


def of_file(image: Any, path: str, alpha_mode: str) -> Pixels | None:
    """Returns the pixels of a file with the colour space of an image, such as one of its tiles."""
    try:
        loaded = bpy.data.images.load(path, check_existing=False)
    except RuntimeError:
        return None
    return _with_settings_of(image, loaded, alpha_mode)


def of_packed(image: Any, data: bytes) -> Pixels | None:
    """Returns the pixels of a packed file with the settings of an image, such as one of its tiles."""
    packed = bpy.data.images.new(_NAME, 1, 1)
    packed.pack(data=data, data_len=len(data))
    packed.source = "FILE"
    return _with_settings_of(image, packed, image.alpha_mode)


def _with_settings_of(image: Any, other: Any, alpha_mode: str) -> Pixels | None:
    """Returns the pixels of another image with the colour space of `image`, and removes that other image."""
    try:
        other.colorspace_settings.name = image.colorspace_settings.name
        other.alpha_mode = alpha_mode
        return of_image(other)
    finally:
        bpy.data.images.remove(other)


def _to_bytes(values: array) -> array:
    """Returns the bytes that Blender stores, which it hands out as floats of four times their size.

    The floats are overwritten.
    """
    try:
        import numpy as np  # imported late, because few images come from Blender and the import is slow
    except ImportError:  # Blender 3.4 of Debian has no NumPy of its own
        return values
    floats, stored = np.frombuffer(values, np.float32), zeros("B", len(values))
    np.multiply(floats, 255.0, out=floats)  # without temporary arrays, whose pages take longer than the arithmetic
    np.copyto(np.frombuffer(stored, np.uint8), np.rint(floats, out=floats), casting="unsafe")
    return stored


def _to_rgba(values: Any, channels: int) -> Any:
    """Returns the RGBA of pixels with 1 or 3 channels: grey fills all colours, and alpha is 1."""
    count = len(values) // channels
    rgba = type(values)("f", [1.0]) * (4 * count)
    for channel in range(3):
        rgba[channel::4] = values[min(channel, channels - 1) :: channels]
    return rgba


def release() -> None:
    """Removes the texture that looks up frames. It is kept until then, because a removal re-sorts all dependencies."""
    with _lock:
        texture = bpy.data.textures.get(_NAME)
        if texture is not None:
            bpy.data.textures.remove(texture)
