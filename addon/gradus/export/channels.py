"""The channels of a view layer as structs, and the numbers by which lights and materials refer to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .. import native
from ..abi import ChannelKind
from ..layer_channels import Channel


def fill_channels(channels: Sequence[Channel]) -> Any:
    """Returns an array of native Channels, or None if there are none."""
    return native.struct_array(native.Channel, (_fill(channel) for channel in channels))


def _fill(channel: Channel) -> native.Channel:
    record = native.Channel()
    record.kind, record.levels = channel.kind, channel.levels
    record.name = native.name(channel.name)
    return record


def numbers(channels: Sequence[Channel], kind: ChannelKind) -> dict[str, int]:
    """Returns the index + 1 of the channels of a kind, by name."""
    return {channel.name: index + 1 for index, channel in enumerate(channels) if channel.kind == kind}


def aovs(channels: Sequence[Channel]) -> dict[str, int]:
    """Returns the index + 1 of AOVs by name."""
    return numbers(channels, ChannelKind.AOV_COLOR) | numbers(channels, ChannelKind.AOV_VALUE)
