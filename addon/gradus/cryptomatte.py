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

Manifests = dict[ChannelKind, dict[str, str]]
"""The hash of each name, as hexadecimal digits."""


def add_names(library: Any, scene: int, channels: Iterable[Channel], manifests: Manifests) -> None:
    """Adds the names of a native scene. The frames of an animation share them, because they are exported ahead."""
    for channel in channels:
        if channel.is_cryptomatte:
            text = ctypes.c_char_p()
            library.scene_manifest(scene, channel.kind, byref(text))
            manifests.setdefault(channel.kind, {}).update(json.loads(text.value))


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
            "manifest": json.dumps(manifests.get(channel.kind, {}), ensure_ascii=False, separators=(",", ":")),
        }
        for field, value in fields.items():
            result.stamp_data_add_field(f"{key}/{field}", value)
