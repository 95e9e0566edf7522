"""Typed arrays from Blender's collections.

`foreach_get` is fast only with an `array.array` whose type code is that of the stored property. With another type code
it reads item by item, and ctypes arrays take a hundred times as long.
"""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Callable
from typing import Any

Values = array | memoryview
Reader = Callable[..., Values]  # read() or view()

_memory_view = ctypes.pythonapi.PyMemoryView_FromMemory
_memory_view.argtypes = (ctypes.c_void_p, ctypes.c_ssize_t, ctypes.c_int)
_memory_view.restype = ctypes.py_object
_WRITABLE = 0x200  # PyBUF_WRITE: ctypes makes pointers to nothing else


def zeros(typecode: str, count: int) -> array:
    """Returns an array of `count` zeros."""
    return array(typecode, (0,)) * count


def read(collection: Any, attribute: str, typecode: str, per_item: int = 1) -> array:
    """Returns `attribute` of all items of a Blender collection, with `per_item` values each."""
    values = zeros(typecode, len(collection) * per_item)
    if values:
        collection.foreach_get(attribute, values)
    return values


def view(collection: Any, attribute: str, typecode: str, per_item: int = 1) -> Values:
    """Returns the values of read() where Blender stores them, without a copy of large arrays.

    They are valid until Blender changes or frees them. The items of the collection must consist of these values alone,
    which shows in their addresses; others are copied.
    """
    count = len(collection)
    if count < 2:
        return read(collection, attribute, typecode, per_item)
    first, last = collection[0].as_pointer(), collection[count - 1].as_pointer()
    size = array(typecode).itemsize * per_item
    if last - first != size * (count - 1):
        return read(collection, attribute, typecode, per_item)
    return _memory_view(first, size * count, _WRITABLE).cast(typecode)


def matrix_values(matrix: Any) -> array:
    """Returns the 16 values of a mathutils.Matrix in column-major order, as in the C API."""
    return array("f", [matrix[row][column] for column in range(4) for row in range(4)])
