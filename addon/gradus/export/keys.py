"""64-bit keys of native objects, with mark and sweep.

A token is a hashable value that identifies the object, such as a content hash or a pointer with a kind. Keys are
numbered in the order of first appearance, so that they do not depend on Blender's addresses.
"""

from __future__ import annotations

from collections.abc import Hashable

KIND_MESH, KIND_IMAGE, KIND_MATERIAL = 0, 1, 2


class KeyTable:
    """Maps tokens of one kind to keys, over all syncs of an exporter."""

    def __init__(self) -> None:
        self._keys: dict[Hashable, int] = {}
        self._contents: dict[int, Hashable] = {}
        self._used: set[int] = set()
        self._next = 1

    def begin(self) -> None:
        """Starts a sync, in which no token is used yet."""
        self._used.clear()

    def key(self, token: Hashable) -> int:
        """Returns the key of a token and marks it as used. A new token gets a new key."""
        key = self._keys.get(token)
        if key is None:
            key = self._next
            self._next += 1
            self._keys[token] = key
        self._used.add(key)
        return key

    def changed(self, key: int, content: Hashable) -> bool:
        """Returns whether the native object of `key` must be set, because its content differs from the last one."""
        if self._contents.get(key) == content:
            return False
        self._contents[key] = content
        return True

    def content(self, key: int) -> Hashable:
        """Returns the content that the native object of `key` has, or None if there is no such object."""
        return self._contents.get(key)

    def invalidate(self) -> None:
        """Makes the next sync set all objects again, after a failed call."""
        self._contents = dict.fromkeys(self._contents)

    def sweep(self) -> list[int]:
        """Ends a sync: drops all tokens that were not used. Returns the keys of native objects that must be removed."""
        dead = [token for token, key in self._keys.items() if key not in self._used]
        unused = []
        for token in dead:
            key = self._keys.pop(token)
            if key in self._contents:
                del self._contents[key]
                unused.append(key)
        return unused
