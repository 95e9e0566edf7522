"""Images for the native library.

The library decodes files and packed files itself. Blender's pixels are read only if no file contains them, because
Blender would then load the whole image into memory: an 8192 x 8192 byte image becomes 1.07 GB of floats.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
from dataclasses import dataclass
from typing import Any

from .. import compat, native
from .arrays import zeros

FILE, ENCODED, FLOAT, BYTE = range(4)
STRAIGHT, PREMULTIPLIED, CHANNEL_PACKED, ALPHA_NONE = range(4)
_ALPHA = {"STRAIGHT": STRAIGHT, "PREMUL": PREMULTIPLIED, "CHANNEL_PACKED": CHANNEL_PACKED, "NONE": ALPHA_NONE}

# The version from which Cycles multiplies the colours of float images whose alpha mode is STRAIGHT by their alpha.
_STRAIGHT_FLOATS_SINCE = (5, 2, 0)

# First bytes of the formats that the library reads itself: PNG, JPEG, TIFF (both byte orders, and BigTIFF), OpenEXR,
# Radiance.
_READABLE = (b"\x89PNG", b"\xff\xd8\xff", b"II*\x00", b"MM\x00*", b"II+\x00", b"MM\x00+", b"\x76\x2f\x31\x01", b"#?")
_FLOAT_FORMATS = (b"\x76\x2f\x31\x01", b"#?")
_SEQUENCE_NUMBER = re.compile(r"(\d+)(?!.*\d)")


@dataclass
class TileState:
    """One file or pixel buffer of an image."""

    source: int
    path: str
    number: int = 0  # UDIM
    width: int = 0
    height: int = 0
    data: Any = None  # bytes or array
    stamp: tuple[int, int] = (0, 0)  # modification time and size of the file: changed files are read again


@dataclass
class ImageState:
    name: str
    alpha_mode: int
    color_space: str
    is_float: bool
    tiles: list[TileState]


def user_frame(user: Any, frame: int) -> int:
    """Returns the number of the file of an image sequence at a scene frame, as in Blender."""
    length = user.frame_duration
    if length <= 0:
        return 0
    number = frame - user.frame_start + 1
    if user.use_cyclic:
        number %= length
        if number == 0:
            number = length
    return min(max(number, 0), length) + user.frame_offset


def sequence_path(path: str, number: int) -> str:
    """Returns `path` with its last number replaced. The number keeps its digits at least."""
    folder, name = os.path.split(path)
    match = _SEQUENCE_NUMBER.search(name)
    if match is None:
        return path
    text = f"{number:0{len(match.group())}d}"
    return os.path.join(folder, name[: match.start()] + text + name[match.end() :])


def tile_path(path: str, number: int) -> str:
    """Returns the file of a UDIM tile."""
    u, v = (number - 1001) % 10 + 1, (number - 1001) // 10 + 1
    return path.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{u}_v{v}")


def _stamp(path: str) -> tuple[int, int]:
    try:
        info = os.stat(path)
    except (OSError, ValueError):
        return (0, 0)
    return (info.st_mtime_ns, info.st_size)


def _head(path: str) -> bytes:
    try:
        with open(path, "rb") as file:
            return file.read(32)
    except (OSError, ValueError):
        return b""


def _is_float(head: bytes) -> bool:
    """Returns whether Blender stores the image as floats, by the first bytes of its file."""
    if head.startswith(b"\x89PNG") and len(head) > 24:
        return head[24] == 16  # bits per channel in the IHDR chunk
    return head.startswith(_FLOAT_FORMATS)


def _pixels(image: Any, number: int) -> TileState | None:
    """Returns Blender's own pixels: float RGBA, bottom row first. Tiled images have pixels of the first tile only."""
    width, height = image.size
    if width == 0 or height == 0:
        return None
    values = zeros("f", width * height * image.channels)
    image.pixels.foreach_get(values)
    if image.channels != 4:
        values = _to_rgba(values, image.channels)
    return TileState(FLOAT, image.name, number, width, height, values)


def _to_rgba(values: Any, channels: int) -> Any:
    """Returns RGBA pixels. Grey becomes red, green and blue, and a missing alpha becomes 1."""
    count = len(values) // channels
    rgba = type(values)("f", [1.0]) * (4 * count)
    for channel in range(3):
        rgba[channel::4] = values[min(channel, channels - 1) :: channels]
    return rgba


def _packed_data(image: Any, number: int) -> bytes | None:
    """Returns the bytes of the packed file of a tile, or None."""
    if number == 0 and image.packed_file is not None:
        return bytes(image.packed_file.data)
    for packed in image.packed_files:
        if number in {0, packed.tile_number}:
            return bytes(packed.packed_file.data)
    return None


def _file_tile(image: Any, path: str, number: int, allow_pixels: bool) -> tuple[TileState, bool]:
    """Returns a tile from packed data or a file, and whether it is stored as floats.

    A missing file is passed on as FILE, so that the library warns of its path.
    """
    packed = _packed_data(image, number)
    head = packed[:32] if packed is not None else _head(path)
    if head.startswith(_READABLE) or not allow_pixels or not head:
        if packed is not None:
            return TileState(ENCODED, path or image.name, number, data=packed), _is_float(head)
        return TileState(FILE, path, number, stamp=_stamp(path)), _is_float(head)
    tile = _pixels(image, number)
    if tile is None:
        return TileState(FILE, path, number, stamp=_stamp(path)), False
    return tile, bool(image.is_float)


def _tiles(image: Any, user: Any, frame: int, abspath: Any) -> tuple[list[TileState], bool]:
    path = abspath(image.filepath, library=image.library) if image.filepath else ""
    if image.source == "TILED":
        numbers = [tile.number for tile in image.tiles]
        results = [_file_tile(image, tile_path(path, number), number, number == 1001) for number in numbers]
        return [tile for tile, _ in results], any(is_float for _, is_float in results)
    if image.source == "SEQUENCE" and user is not None:
        path = sequence_path(path, user_frame(user, frame))
    own_pixels = image.source in {"GENERATED", "VIEWER", "MOVIE"} or image.is_dirty
    if own_pixels:
        tile = _pixels(image, 0)
        if tile is not None:
            return [tile], bool(image.is_float)
    tile, is_float = _file_tile(image, path, 0, image.source != "SEQUENCE")
    return [tile], is_float


def signature(image: Any, user: Any, frame: int, abspath: Any) -> tuple[Any, ...] | None:
    """Returns a value that identifies the content of files and packed data without reading them.

    Returns None if only Blender has the pixels.
    """
    if image.is_dirty or image.source not in {"FILE", "SEQUENCE", "TILED"}:
        return None
    path = abspath(image.filepath, library=image.library) if image.filepath else ""
    if image.source == "SEQUENCE" and user is not None:
        path = sequence_path(path, user_frame(user, frame))
    numbers = tuple(tile.number for tile in image.tiles) if image.source == "TILED" else (0,)
    stamps = tuple(_stamp(tile_path(path, number)) for number in numbers)
    packed = tuple((item.packed_file.as_pointer(), item.packed_file.size) for item in image.packed_files)
    settings = image.colorspace_settings
    return (image.name, path, numbers, stamps, packed, image.alpha_mode, settings.is_data, settings.name)


def image_state(image: Any, user: Any, frame: int, abspath: Any) -> ImageState:
    """Returns what the library needs of an image. user: the node's ImageUser or None; abspath: bpy.path.abspath."""
    tiles, is_float = _tiles(image, user, frame, abspath)
    settings = image.colorspace_settings
    space = "" if settings.is_data else settings.name
    alpha = _ALPHA.get(image.alpha_mode, STRAIGHT)
    if is_float and tiles[0].source == FLOAT:
        # Blender's float buffers are scene-linear with associated alpha.
        space = ""
        if alpha == STRAIGHT and compat.VERSION < _STRAIGHT_FLOATS_SINCE:
            alpha = PREMULTIPLIED
    if settings.is_data and alpha != ALPHA_NONE:
        alpha = CHANNEL_PACKED  # Cycles never multiplies data by alpha
    return ImageState(image.name, alpha, space, is_float, tiles)


def content(state: ImageState) -> tuple[Any, ...]:
    """Returns a value that is equal for equal content. Files are compared by path, time and size, data by a hash."""
    tiles = tuple(
        (tile.source, tile.path, tile.number, tile.width, tile.height, tile.stamp, _digest(tile.data))
        for tile in state.tiles
    )
    return (state.alpha_mode, state.color_space, state.is_float, tiles)


def _digest(data: Any) -> bytes:
    return b"" if data is None else hashlib.sha1(data, usedforsecurity=False).digest()


def fill_image(state: ImageState) -> tuple[native.Image, list[Any]]:
    """Returns a native Image, and the objects that must stay alive until the library has copied it."""
    records = native.struct_array(native.ImageTile, (native.ImageTile() for _ in state.tiles))
    for record, tile in zip(records, state.tiles, strict=True):
        record.number = tile.number
        record.source = tile.source
        record.width = tile.width
        record.height = tile.height
        record.path = native.text(tile.path)
        if tile.source == ENCODED:
            record.data = ctypes.cast(ctypes.c_char_p(tile.data), ctypes.c_void_p)
            record.data_size = len(tile.data)
        elif tile.data is not None:
            record.data = tile.data.buffer_info()[0]
            record.data_size = len(tile.data) * tile.data.itemsize
    struct = native.Image()
    struct.alpha_mode = state.alpha_mode
    struct.is_float = state.is_float
    struct.tile_count = len(state.tiles)
    struct.tiles = records
    struct.color_space = native.name(state.color_space)
    struct.name = native.name(state.name)
    return struct, [records, state]
