"""Manifests of Cryptomattes, and the metadata by which compositors find names in their passes.

Cryptomatte specification 1.2 (Psyop), section "Metadata".
"""

from __future__ import annotations

import ctypes
import json
from collections.abc import Iterable
from ctypes import byref
from typing import Any

from . import native
from .abi import ChannelKind
from .layer_channels import Channel


class Manifests:
    """The hash of each name, as hexadecimal digits, by the kind of Cryptomatte.

    Most frames have the names of the frame before. Their manifests are compared as text, and neither read nor written
    again.
    """

    def __init__(self) -> None:
        self._names: dict[ChannelKind, dict[str, str]] = {}
        self._last: dict[ChannelKind, bytes] = {}
        self._texts: dict[ChannelKind, str] = {}
        self._has_more: dict[ChannelKind, bool] = {}  # whether there are names that the last manifest does not have

    def add(self, kind: ChannelKind, manifest: bytes, replaces: bool) -> None:
        """Adds the names of a frame, or replaces all others by them. manifest: a JSON object."""
        if self._last.get(kind) == manifest and not (replaces and self._has_more[kind]):
            return
        names = json.loads(manifest)
        self._last[kind] = manifest
        self._names[kind] = names if replaces else self._names.get(kind, {}) | names
        self._has_more[kind] = len(self._names[kind]) > len(names)
        self._texts[kind] = json.dumps(self._names[kind], ensure_ascii=False, separators=(",", ":"))

    def text(self, kind: ChannelKind) -> str:
        """Returns all names as a JSON object."""
        return self._texts.get(kind, "{}")


def add_names(library: Any, scene: int, channels: Iterable[Channel], manifests: Manifests, replaces: bool) -> None:
    """Adds the names of a native scene. The frames of an animation share them, because they are exported ahead."""
    for channel in channels:
        if channel.is_cryptomatte:
            text = ctypes.c_char_p()
            library.scene_manifest(scene, channel.kind, byref(text))
            manifests.add(channel.kind, text.value, replaces)


def stamp(library: Any, result: Any, layer: str, channels: Iterable[Channel], manifests: Manifests) -> None:
    """Adds the metadata to Blender's render result, whose files will have it. layer: the name of the view layer."""
    for channel in channels:
        if not channel.is_cryptomatte:
            continue
        name = f"{layer}.{channel.typename}"
        number = ctypes.c_uint32()
        library.cryptomatte_hash(native.name(name), byref(number))
        key = f"cryptomatte/{f'{number.value:08x}'[:7]}"
        fields = {
            "name": name,
            "hash": "MurmurHash3_32",
            "conversion": "uint32_to_float32",
            "manifest": manifests.text(channel.kind),
        }
        for field, value in fields.items():
            result.stamp_data_add_field(f"{key}/{field}", value)
