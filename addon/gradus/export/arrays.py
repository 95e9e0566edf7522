"""Typed arrays from Blender's collections.

`foreach_get` is fast only when the type code of the array is the one that the property is stored in (a wrong one
silently goes item by item), and only with `array.array`: ctypes arrays take a hundred times as long.
"""

from __future__ import annotations

from array import array
from typing import Any


def zeros(typecode: str, count: int) -> array:
    """An array of `count` zeros."""
    values = array(typecode)
    return array(typecode, bytes(values.itemsize * count))


def read(collection: Any, attribute: str, typecode: str, per_item: int = 1) -> array:
    """`attribute` of all items of a Blender collection, `per_item` values each."""
    values = zeros(typecode, len(collection) * per_item)
    if values:
        collection.foreach_get(attribute, values)
    return values


def matrix_values(matrix: Any) -> array:
    """The 16 values of a mathutils.Matrix, column after column as the C API wants them."""
    return array("f", [matrix[row][column] for column in range(4) for row in range(4)])
