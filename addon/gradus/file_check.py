"""Checks that an image file that Blender wrote is complete: on a full disk Blender truncates files without an error."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

PNG_START, PNG_END = b"\x89PNG\r\n\x1a\n", b"\x00\x00\x00\x00IEND\xaeB`\x82"
JPEG_START, JPEG_END = b"\xff\xd8\xff", b"\xff\xd9"
EXR_START = b"\x76\x2f\x31\x01"
EXR_TILED_BIT, EXR_MULTIPART_BIT = 0x200, 0x1000
EXR_ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
"""Rows of pixels in a chunk by compression method, as listed in OpenEXR's technical introduction."""


def is_complete(path: Path) -> bool:
    """Returns whether a file has its end. Formats other than PNG, JPEG and OpenEXR need a minimum size only.

    Raises OSError if the file does not exist.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        start = file.read(8)
        if start == PNG_START:
            return _ends_with(file, size, PNG_END)
        if start.startswith(JPEG_START):
            return _ends_with(file, size, JPEG_END)
        if start.startswith(EXR_START):
            try:
                return _has_all_chunks(file, size)
            except (struct.error, KeyError, IndexError):  # truncated within the header
                return False
    return size >= len(PNG_START)  # no image file is smaller


def _ends_with(file: BinaryIO, size: int, end: bytes) -> bool:
    file.seek(max(0, size - len(end)))
    return file.read() == end


def _has_all_chunks(file: BinaryIO, size: int) -> bool:
    """Returns whether an OpenEXR file has its last chunk.

    The table of chunks is written last: in a truncated file it holds zeros, or offsets beyond the end of the file.
    """
    file.seek(4)
    (version,) = struct.unpack("<I", file.read(4))
    if version & EXR_TILED_BIT:
        return True  # Blender does not write tiled files
    multipart = bool(version & EXR_MULTIPART_BIT)
    headers = [_read_header(file)]
    while multipart and (header := _read_header(file)):
        headers.append(header)
    chunks = sum(_chunk_count(header) for header in headers)
    offsets = struct.unpack(f"<{chunks}Q", file.read(8 * chunks))
    if not offsets or min(offsets) == 0:
        return False
    last = max(offsets)
    file.seek(last + (8 if multipart else 4))  # behind the number of the part, if there are several, and the row
    (length,) = struct.unpack("<I", file.read(4))
    return length > 0 and file.tell() + length <= size


def _read_header(file: BinaryIO) -> dict[str, bytes]:
    """Returns the attributes of the next header by name; none at the end of the list of headers."""
    attributes: dict[str, bytes] = {}
    while name := _read_text(file):
        _read_text(file)  # type
        (length,) = struct.unpack("<I", file.read(4))
        attributes[name] = file.read(length)
    return attributes


def _read_text(file: BinaryIO) -> str:
    text = b""
    while (byte := file.read(1)) not in (b"", b"\0"):
        text += byte
    return text.decode("latin-1")


def _chunk_count(header: dict[str, bytes]) -> int:
    if "chunkCount" in header:
        return struct.unpack("<i", header["chunkCount"])[0]
    _, first_row, _, last_row = struct.unpack("<4i", header["dataWindow"])
    rows = EXR_ROWS[header["compression"][0]]
    return (last_row - first_row) // rows + 1
