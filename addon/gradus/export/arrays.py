"""Typed arrays from Blender's collections.

`foreach_get` is fast only with an `array.array` whose type code is that of the stored property. With another type code
it reads item by item, and ctypes arrays take a hundred times as long.
"""

from __future__ import annotations

from array import array
from typing import Any


def zeros(typecode: str, count: int) -> array:
    """Returns an array of `count` zeros."""
    values = array(typecode)
    return array(typecode, bytes(values.itemsize * count))


def read(collection: Any, attribute: str, typecode: str, per_item: int = 1) -> array:
    """Returns `attribute` of all items of a Blender collection, with `per_item` values each."""
    values = zeros(typecode, len(collection) * per_item)
    if values:
        collection.foreach_get(attribute, values)
    return values


def matrix_values(matrix: Any) -> array:
    """Returns the 16 values of a mathutils.Matrix in column-major order, as in the C API."""
    return array("f", [matrix[row][column] for column in range(4) for row in range(4)])
