"""Images for the native library.

The library decodes files and packed files itself, and OpenImageIO those whose format it does not know. Pixels come from
Blender only if no file contains them, because Blender hands out floats: an 8192 x 8192 byte image takes 1.07 GB on its
way.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
from dataclasses import dataclass
from typing import Any

from .. import compat, native
from . import blender_pixels, file_pixels

FILE, ENCODED, FLOAT, BYTE = range(4)
STRAIGHT, PREMULTIPLIED, CHANNEL_PACKED, ALPHA_NONE, ALWAYS_STRAIGHT = range(5)
_UNCONVERTED_SPACES = {"sRGB", "Linear", "Linear Rec.709"}
"""Colour spaces in which Cycles reads images without OpenColorIO."""
_ALPHA = {"STRAIGHT": STRAIGHT, "PREMUL": PREMULTIPLIED, "CHANNEL_PACKED": CHANNEL_PACKED, "NONE": ALPHA_NONE}

# From this version on, Cycles multiplies colours by alpha if the mode is STRAIGHT, whatever the file says. Before, it
# multiplied those of floats never, and of other images in both modes, unless the file says that it was done.
_MODE_DECIDES_SINCE = (5, 2, 0)

# Before these versions, Cycles repeats the tile of an image that has only one, and the first tile on boxes, whose sides
# never show another.
_SINGLE_TILE_REPEATS_UNTIL, _BOX_REPEATS_UNTIL = (4, 4, 0), (5, 2, 0)
_FIRST_TILE = 1001

# First bytes of the formats that the library reads itself: PNG, JPEG, TIFF (both byte orders, and BigTIFF), OpenEXR,
# Radiance.
_READABLE = (b"\x89PNG", b"\xff\xd8\xff", b"II*\x00", b"MM\x00*", b"II+\x00", b"MM\x00+", b"\x76\x2f\x31\x01", b"#?")
_OPEN_EXR = b"\x76\x2f\x31\x01"
_FILM_SCANS = (b"SDPX", b"XPDS", b"\x80\x2a\x5f\xd7", b"\xd7\x5f\x2a\x80")  # DPX and Cineon, both byte orders
_FLOAT_FORMATS = (_OPEN_EXR, b"#?")
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
    is_linear: bool = False  # scene-linear whatever the colour space of the image
    has_straight_alpha: bool | None = None  # whether colours are not yet multiplied by alpha; None if not known
    is_webp: bool = False


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
    u, v = (number - _FIRST_TILE) % 10 + 1, (number - _FIRST_TILE) // 10 + 1
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


def _is_deep_png(head: bytes) -> bool:
    """Returns whether the first bytes of a file are those of a PNG of 16 bits per channel, by its IHDR chunk."""
    return head.startswith(b"\x89PNG") and len(head) > 24 and head[24] == 16


def _is_webp(head: bytes) -> bool:
    return head.startswith(b"RIFF") and head[8:12] == b"WEBP"


def _comes_from_blender(image: Any, head: bytes) -> bool:
    """Returns whether Blender's pixels differ from those of a packed file that the library could read itself.

    In Cycles packed images come from Blender, which multiplies and divides them by alpha before.
    """
    if image.alpha_mode == "PREMUL":
        return not head.startswith(_FLOAT_FORMATS)
    is_deep_and_new = _is_deep_png(head) and compat.VERSION >= _MODE_DECIDES_SINCE
    return image.alpha_mode == "STRAIGHT" and (is_deep_and_new or head.startswith(_OPEN_EXR))


def _decoded(image: Any, number: int, pixels: blender_pixels.Pixels | None) -> tuple[TileState, bool] | None:
    """Returns a tile from pixels that Blender decoded, and whether it is stored as floats."""
    if pixels is None:
        return None
    source = BYTE if pixels.values.typecode == "B" else FLOAT
    tile = TileState(source, image.name, number, pixels.width, pixels.height, pixels.values)
    tile.is_linear = pixels.is_float
    tile.is_webp = image.has_data and image.file_format == "WEBP"  # would load an image that has no data yet
    return tile, pixels.is_float


def _packed_data(image: Any, number: int) -> bytes | None:
    """Returns the bytes of the packed file of a tile, or None."""
    if number == 0 and image.packed_file is not None:
        return bytes(image.packed_file.data)
    for packed in image.packed_files:
        if number in {0, packed.tile_number}:
            return bytes(packed.packed_file.data)
    return None


def _file_tile(image: Any, path: str, number: int, frame_number: int | None) -> tuple[TileState, bool]:
    """Returns a tile from packed data or a file, and whether it is stored as floats.

    number: that of the tile; 0 if the image has none. frame_number: that of the frame, if the image has frames. A
    missing file is passed on as FILE, so that the library warns of its path.
    """
    packed = _packed_data(image, number)
    head = packed[:32] if packed is not None else _head(path)
    tile, is_float = _tile_of_format(image, path, number, frame_number, packed, head)
    tile.is_webp = _is_webp(head)
    return tile, is_float


def _tile_of_format(
    image: Any, path: str, number: int, frame_number: int | None, packed: bytes | None, head: bytes
) -> tuple[TileState, bool]:
    """Returns what _file_tile() returns, read as the format needs it. head: the first bytes of the file."""
    if not head or (head.startswith(_READABLE) and packed is None):
        return TileState(FILE, path, number, stamp=_stamp(path)), head.startswith(_FLOAT_FORMATS)
    if packed is not None and head.startswith(_READABLE) and not _comes_from_blender(image, head):
        # In Blender, packed images of 16 bits per channel are floats.
        is_float = head.startswith(_FLOAT_FORMATS) or _is_deep_png(head)
        return TileState(ENCODED, path or image.name, number, data=packed), is_float
    read = file_pixels.of_file(path) if packed is None else None
    if read is not None:
        source = BYTE if read.values.typecode == "B" else FLOAT
        tile = TileState(source, path, number, read.width, read.height, read.values, _stamp(path))
        tile.has_straight_alpha = read.has_straight_alpha
        return tile, read.is_float
    if packed is None and image.alpha_mode == "PREMUL":
        # Blender divides premultiplied colours by alpha, but Cycles takes those of the file.
        pixels = blender_pixels.of_file(image, path, "STRAIGHT")
    elif number == 0:
        pixels = _own_pixels(image, frame_number)
    elif packed is None:
        pixels = blender_pixels.of_file(image, path, image.alpha_mode)
    else:
        pixels = blender_pixels.of_packed(image, packed)
    return _decoded(image, number, pixels) or (TileState(FILE, path, number, stamp=_stamp(path)), False)


def _path(image: Any, frame_number: int | None, abspath: Any) -> str:
    """Returns the file of an image, or of a frame of a sequence. The names of tiles are still placeholders."""
    path = abspath(image.filepath, library=image.library) if image.filepath else ""
    return sequence_path(path, frame_number) if image.source == "SEQUENCE" and frame_number is not None else path


def _tiles(image: Any, frame_number: int | None, abspath: Any, is_boxed: bool) -> tuple[list[TileState], bool]:
    path = _path(image, frame_number, abspath)
    if image.source == "TILED":
        numbers = [_FIRST_TILE] if is_boxed else [tile.number for tile in image.tiles]
        results = [_udim_tile(image, path, number) for number in numbers]
        repeats_until = _BOX_REPEATS_UNTIL if is_boxed else _SINGLE_TILE_REPEATS_UNTIL
        if len(numbers) == 1 and repeats_until > compat.VERSION:
            results[0][0].number = 0
        return [tile for tile, _ in results], any(is_float for _, is_float in results)
    decoded = None
    if image.source in {"GENERATED", "VIEWER", "MOVIE"} or image.is_dirty:
        decoded = _decoded(image, 0, _own_pixels(image, frame_number))
    tile, is_float = decoded or _file_tile(image, path, 0, frame_number)
    return [tile], is_float


def _own_pixels(image: Any, frame_number: int | None) -> blender_pixels.Pixels | None:
    return blender_pixels.of_image(image) if frame_number is None else blender_pixels.of_frame(image, frame_number)


def _udim_tile(image: Any, path: str, number: int) -> tuple[TileState, bool]:
    """Returns a tile of a tiled image. Of tiles that were painted or never saved, only the first one can be read."""
    file = tile_path(path, number)
    is_saved = _packed_data(image, number) is not None or os.path.exists(file)
    decoded = None
    if number == image.tiles[0].number and (image.is_dirty or not is_saved):
        decoded = _decoded(image, number, blender_pixels.of_image(image))
    return decoded or _file_tile(image, file, number, None)


def number_of_frame(image: Any, user: Any, frame: int) -> int | None:
    """Returns the number of an image's frame at a scene frame, or None if the image has no frames."""
    return user_frame(user, frame) if user is not None and image.source in {"SEQUENCE", "MOVIE"} else None


def signature(image: Any, number: int | None, abspath: Any) -> tuple[Any, ...] | None:
    """Returns a value that identifies the content of files and packed data without reading them.

    number: that of the image's frame. Returns None if only Blender has the pixels.
    """
    if image.is_dirty or image.source not in {"FILE", "SEQUENCE", "TILED", "MOVIE"}:
        return None
    path = _path(image, number, abspath)
    numbers = tuple(tile.number for tile in image.tiles) if image.source == "TILED" else (0,)
    stamps = tuple(_stamp(tile_path(path, tile)) for tile in numbers)
    packed = tuple((item.packed_file.as_pointer(), item.packed_file.size) for item in image.packed_files)
    settings = image.colorspace_settings
    return (image.name, path, number, numbers, stamps, packed, image.alpha_mode, settings.is_data, settings.name)


def image_state(image: Any, number: int | None, abspath: Any, is_boxed: bool = False) -> ImageState:
    """Returns what the library needs of an image.

    number: that of its frame; abspath: bpy.path.abspath; is_boxed: whether the image is projected from the sides of a
    box, where Cycles has the first tile only.
    """
    tiles, is_float = _tiles(image, number, abspath, is_boxed)
    settings = image.colorspace_settings
    space = "" if compat.is_data(settings) else settings.name
    if tiles[0].is_linear:
        space = ""
    return ImageState(image.name, _alpha_mode(image, tiles[0], is_float), space, is_float, tiles)


def warning(image: Any, number: int | None, abspath: Any) -> str:
    """Returns a warning about what is shown of an image, or "". The arguments are those of image_state()."""
    if image.source == "TILED" and image.is_dirty and len(image.tiles) > 1:
        return f"Image '{image.name}' has changes that are not saved: tiles other than the first are shown as saved"
    if _is_divided_by_cycles(image):
        return (
            f"Image '{image.name}' is channel-packed, and Cycles before Blender 5.0 divides colours of its colour "
            "space by the fourth channel"
        )
    # OpenImageIO is looked for last, because its import takes longer than most exports.
    if not _head(_path(image, number, abspath)).startswith(_FILM_SCANS) or file_pixels.is_available():
        return ""
    return f"Image '{image.name}' is shown in linear values, while Cycles shows the film densities of its file"


def _is_divided_by_cycles(image: Any) -> bool:
    """Returns whether Cycles divides the channels of an image by the fourth one, although that is no alpha."""
    settings = image.colorspace_settings
    is_converted = not compat.is_data(settings) and settings.name not in _UNCONVERTED_SPACES
    return image.alpha_mode == "CHANNEL_PACKED" and compat.VERSION < (5, 0, 0) and is_converted


def _alpha_mode(image: Any, tile: TileState, is_float: bool) -> int:
    """Returns how the colours of an image relate to its alpha in Cycles (measured in 3.4, 4.5 and 5.2)."""
    mode = _ALPHA.get(image.alpha_mode, STRAIGHT)
    if tile.is_webp and compat.VERSION < (4, 0, 0) and tile.has_straight_alpha is None:
        return STRAIGHT  # the OpenImageIO of 3.4 multiplies whatever the mode, data too, and Blender's pixels are not
    if compat.is_data(image.colorspace_settings) and mode != ALPHA_NONE:
        return CHANNEL_PACKED  # data are never multiplied by alpha
    if mode not in {STRAIGHT, PREMULTIPLIED}:
        return mode
    if compat.VERSION >= _MODE_DECIDES_SINCE:
        return ALWAYS_STRAIGHT if mode == STRAIGHT else PREMULTIPLIED
    if tile.has_straight_alpha is not None:
        return ALWAYS_STRAIGHT if tile.has_straight_alpha else PREMULTIPLIED
    if tile.is_webp or tile.is_linear:
        return PREMULTIPLIED
    return mode if is_float else STRAIGHT


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
