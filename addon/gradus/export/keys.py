"""64-bit keys of native objects, with mark and sweep, and ids of instances.

A token is a hashable value that identifies the object, such as a content hash or a pointer with a kind. Keys are
numbered in the order of first appearance, so that they do not depend on Blender's addresses.
"""

from __future__ import annotations

import hashlib
from collections.abc import Hashable, Sequence

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


_NOBODY = 2**64 - 1
"""The id that the library gives to instances that belong to no object."""


class InstanceIds:
    """Maps keys of instances to ids, which are the same in all frames and in all jobs that share a frame store.

    An id is a hash of names and numbers, so that it depends neither on the frames in which its instance is visible nor
    on the order of exports. An object has the name that it had in the first export that showed it: handlers may rename
    objects from frame to frame. An object that is made again under a name takes the place of the one that had it.
    """

    def __init__(self) -> None:
        self._ids: dict[tuple[int, ...], int] = {}  # of the last sync, so that few ids are computed again
        self._names: dict[int, str] = {}  # by the address of the object
        self._addresses: dict[str, int] = {}  # by name
        self._shown: set[int] = set()  # addresses of the objects and instancers of the sync

    def of(self, instances: Sequence[tuple[tuple[int, ...], tuple[str, str]]]) -> list[int]:
        """Returns the ids of all instances that a sync shows, each given by its key and its names.

        A key has the addresses of the object and of its instancer, or 0, and the numbers of the instance. The names are
        those of both objects. Names of objects that the sync does not show may pass to others.
        """
        self._shown = {address for key, _ in instances for address in key[:2]}
        last, self._ids = self._ids, {}
        for key, names in instances:
            self._ids[key] = last.get(key) or self._hash(key, names)
        return [self._ids[key] for key, _ in instances]

    def forget(self) -> None:
        """Drops all ids and names at the end of a job, because objects may be renamed before the next one."""
        for kept in (self._ids, self._names, self._addresses):
            kept.clear()

    def _hash(self, key: tuple[int, ...], names: tuple[str, str]) -> int:
        first_names = [self._name(address, name) for address, name in zip(key, names, strict=False)]
        text = ascii((*first_names, *key[len(names) :]))
        return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little") % _NOBODY

    def _name(self, address: int, name: str) -> str:
        """Returns the first name of an object, or one of its own while another object has that name."""
        if address not in self._names:
            while self._addresses.get(name) in self._shown:
                name += "\0"
            self._names.pop(self._addresses.get(name, -1), None)
            self._names[address] = name
            self._addresses[name] = address
        return self._names[address]
