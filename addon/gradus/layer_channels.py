"""The channels that a view layer asks for beside passes: AOVs, light groups and Cryptomattes.

This module does not use Blender.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from .abi import ChannelKind

MAXIMUM_LEVELS = 16
_CRYPTOMATTES = (
    (ChannelKind.CRYPTOMATTE_OBJECT, "use_pass_cryptomatte_object", "CryptoObject"),
    (ChannelKind.CRYPTOMATTE_MATERIAL, "use_pass_cryptomatte_material", "CryptoMaterial"),
    (ChannelKind.CRYPTOMATTE_ASSET, "use_pass_cryptomatte_asset", "CryptoAsset"),
)
_PASS_NAMES = {kind: name for kind, _, name in _CRYPTOMATTES}


@dataclass(frozen=True)
class Channel:
    """A channel of the library's films."""

    kind: ChannelKind
    name: str = ""  # of the AOV or the light group
    levels: int = 0  # names that each pixel of a Cryptomatte keeps

    @property
    def is_cryptomatte(self) -> bool:
        return self.kind in _PASS_NAMES

    @property
    def layers(self) -> int:
        """The number of Blender's passes that show the channel."""
        return (self.levels + 1) // 2 if self.is_cryptomatte else 1

    def pass_name(self, layer: int = 0) -> str:
        """Returns the name of Blender's pass for a layer. It is that of Cycles."""
        if self.is_cryptomatte:
            return f"{_PASS_NAMES[self.kind]}{layer:02d}"
        return f"Combined_{self.name}" if self.kind == ChannelKind.LIGHT_GROUP else self.name

    @property
    def typename(self) -> str:
        """The name of a Cryptomatte without the number of a layer, which its metadata has."""
        return _PASS_NAMES[self.kind]


def channels_of(view_layer: Any) -> tuple[Channel, ...]:
    """Returns the channels of a view layer in the order in which Blender lists their passes."""
    return tuple(_channels(view_layer))


def _channels(view_layer: Any) -> Iterator[Channel]:
    levels = min(view_layer.pass_cryptomatte_depth, MAXIMUM_LEVELS)
    for kind, switch, _ in _CRYPTOMATTES:
        if getattr(view_layer, switch):
            yield Channel(kind, levels=levels)
    for aov in view_layer.aovs:
        if aov.is_valid:
            yield Channel(ChannelKind.AOV_COLOR if aov.type == "COLOR" else ChannelKind.AOV_VALUE, aov.name)
    for group in view_layer.lightgroups:
        yield Channel(ChannelKind.LIGHT_GROUP, group.name)
