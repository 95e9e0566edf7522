"""A digest of everything that an export sets. Equal digests mean equal pictures.

The keys of meshes, materials and images differ from export to export, so that their contents are digested instead. Ids
of instances and names are left out, because they change no picture.
"""

from __future__ import annotations

import ctypes
import hashlib
from array import array
from collections.abc import Iterable, Mapping
from typing import Any

_KEYS = frozenset({"meshes", "ids", "materials"})


class Digest:
    """Takes the parts of one export in order."""

    def __init__(self) -> None:
        self._hash = hashlib.sha1(usedforsecurity=False)

    def value(self) -> bytes:
        return self._hash.digest()

    def contents(self, values: Iterable[Any]) -> None:
        """Adds values whose repr() tells everything about them."""
        self._add(repr(list(values)).encode("utf-8", "surrogateescape"))

    def arrays(self, values: Iterable[array | None]) -> None:
        for each in values:
            self._add(each if each is not None else b"")

    def columns(self, values: Mapping[str, array | None]) -> None:
        """Adds the arrays of instances, without those of keys."""
        self.arrays(column for name, column in values.items() if name not in _KEYS)

    def struct(self, struct: ctypes.Structure) -> None:
        """Adds the numbers of a struct, without its keys and what its pointers lead to."""
        copy = type(struct).from_buffer_copy(struct)
        for name, kind in copy._fields_:
            if name == "material" or kind is ctypes.c_char_p or issubclass(kind, ctypes._Pointer):
                setattr(copy, name, kind())
        self._add(bytes(copy))

    def _add(self, data: Any) -> None:
        with memoryview(data).cast("B") as view:
            self._hash.update(view.nbytes.to_bytes(8, "little"))  # so that parts cannot run into each other
            self._hash.update(view)
