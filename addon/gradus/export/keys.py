"""64-bit keys of native objects, with mark and sweep.

A token is anything hashable that says what the object is (a content hash, a pointer with a kind). Keys count up in
order of first appearance, so that two runs of the same file give the same keys whatever Blender's addresses are.
"""

from __future__ import annotations

from collections.abc import Hashable

KIND_MESH, KIND_IMAGE, KIND_MATERIAL = 0, 1, 2


class KeyTable:
    """Tokens of one kind to keys, over all syncs of an exporter."""

    def __init__(self) -> None:
        self._keys: dict[Hashable, int] = {}
        self._contents: dict[int, Hashable] = {}
        self._used: set[int] = set()
        self._next = 1

    def begin(self) -> None:
        """Starts a sync: nothing is used yet."""
        self._used.clear()

    def key(self, token: Hashable) -> int:
        """The key of a token, made at its first appearance, and marked as used."""
        key = self._keys.get(token)
        if key is None:
            key = self._next
            self._next += 1
            self._keys[token] = key
        self._used.add(key)
        return key

    def changed(self, key: int, content: Hashable) -> bool:
        """Whether the native object of `key` must be set (again): its content differs from what was set before."""
        if self._contents.get(key) == content:
            return False
        self._contents[key] = content
        return True

    def distrust(self) -> None:
        """After a failed call: everything is set anew by the next sync."""
        self._contents = dict.fromkeys(self._contents)

    def sweep(self) -> list[int]:
        """Ends a sync: drops all tokens that were not used, and returns the keys that the native side holds in vain."""
        dead = [token for token, key in self._keys.items() if key not in self._used]
        held = []
        for token in dead:
            key = self._keys.pop(token)
            if key in self._contents:
                del self._contents[key]
                held.append(key)
        return held
