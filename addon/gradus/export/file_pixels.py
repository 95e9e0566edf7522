"""Pixels of files in formats that the library does not read, as Cycles reads them: through OpenImageIO.

Blender has its Python module from 4.0 on. Blender's own pixels differ from those of Cycles: BMP files lose their alpha,
and the densities of DPX and Cineon files become colours.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from functools import cache
from typing import Any

_ALWAYS_STRAIGHT = {"dds", "psd"}
"""Formats whose files hold straight alpha, although OpenImageIO does not say so."""

_PREMULTIPLIED_TARGA = 4
_MOST_PIXELS = 1 << 30  # of the images that the library reads itself


@dataclass
class FilePixels:
    """The pixels of a file in the file's own colour space."""

    width: int
    height: int
    values: array  # RGBA, bottom row first: bytes, or floats
    is_float: bool  # whether the file stores floats; if not, floats are from 0 to 1
    has_straight_alpha: bool


@cache
def _library() -> Any:
    """Returns OpenImageIO, or None where it is missing. It is imported late, because few files need it."""
    try:
        import numpy  # noqa: F401  (pixels are arrays of it)
        import OpenImageIO
    except ImportError:
        return None
    return OpenImageIO


def is_available() -> bool:
    return _library() is not None


def of_file(path: str) -> FilePixels | None:
    """Returns the pixels of a file, or None if OpenImageIO is missing or cannot read it."""
    oiio = _library()
    if oiio is None:
        return None
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    file = oiio.ImageInput.open(path, config)
    if file is None:
        oiio.geterror()  # which would else be printed at exit
        return None
    try:
        return _read(file)
    finally:
        file.close()


def _read(file: Any) -> FilePixels | None:
    spec = file.spec()
    if spec.depth > 1 or spec.width * spec.height > _MOST_PIXELS:
        return None
    is_byte = spec.format.basesize() == 1
    values = file.read_image("uint8" if is_byte else "float")
    if values is None:
        file.geterror()
        return None
    values = _rgba(values.reshape(spec.height, spec.width, -1), 255 if is_byte else 1.0)[::-1]
    is_float = str(spec.format) in {"half", "float", "double"}
    kind = "B" if is_byte else "f"
    return FilePixels(spec.width, spec.height, array(kind, values.tobytes()), is_float, _has_straight_alpha(file, spec))


def _rgba(values: Any, opaque: float) -> Any:
    """Returns four channels: grey fills all colours, and a missing alpha is opaque."""
    import numpy as np

    channels = values.shape[2]
    if channels >= 4:
        return values[:, :, :4]
    colors = values[:, :, [0, 0, 0]] if channels < 3 else values
    alpha = values[:, :, 1:2] if channels == 2 else np.full_like(values[:, :, :1], opaque)
    return np.concatenate([colors, alpha], axis=2)


def _has_straight_alpha(file: Any, spec: Any) -> bool:
    """Returns whether colours are to be multiplied by alpha, as Cycles decides it."""
    if spec.nchannels != 4:
        return False
    if spec.get_int_attribute("oiio:UnassociatedAlpha", 0):
        return True
    if spec.alpha_channel < 0:
        return False
    name = file.format_name()
    if name == "targa":
        return spec.get_int_attribute("targa:alpha_type", -1) != _PREMULTIPLIED_TARGA
    return name in _ALWAYS_STRAIGHT
