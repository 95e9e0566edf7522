"""The rows of each section of the table. They are found in the Blender that runs; see all_rows()."""

from __future__ import annotations

from collections.abc import Iterator

from ..row import Row
from . import cameras, films, image_rows, lights, materials, modifiers, nodes, objects, passes, worlds

FAMILIES = (nodes, lights, worlds, cameras, objects, materials, modifiers, passes, films, image_rows)


def all_rows() -> Iterator[Row]:
    """Yields the rows of all families. Empties the file."""
    for family in FAMILIES:
        yield from family.rows()
