"""The passes: Blender's names, channels and switches, and the native plane.

Registration, the settings mask and the upload are all made from list_passes(). The rows are generated in pass_table.py.
This module does not use Blender.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from . import pass_table
from .abi import ChannelKind, ComponentPass, Pass
from .layer_channels import Channel, channels_of

LONG_NAMES_SINCE = (5, 0, 0)
COMPONENT_MOTION = (
    ComponentPass.MOTION,
    ComponentPass.TRACKED,
    ComponentPass.IRRADIANCE_MOTION,
    ComponentPass.IRRADIANCE_TRACKED,
)


@dataclass(frozen=True)
class ComponentPlane:
    """A plane of one component."""

    component: str
    plane: ComponentPass


@dataclass(frozen=True)
class ChannelPlane:
    """A layer of a channel that the view layer asks for."""

    channel: Channel
    layer: int = 0


Plane = Pass | ComponentPlane | ChannelPlane


@dataclass(frozen=True)
class PassInfo:
    """A pass of Blender.

    `switch` is a property of the view layer, or of view_layer.gradus if it starts with "gradus.". A pass without a
    plane is 0.
    """

    plane: Plane | None
    name: str
    long_name: str  # from Blender 5.0 on
    ids: str  # one letter per channel
    kind: str  # VALUE, VECTOR or COLOR
    switch: str  # "": always on; "reconstructed": on if automatic.Method.is_reconstructed

    @property
    def channels(self) -> int:
        return len(self.ids)

    @property
    def is_motion(self) -> bool:
        """Returns whether the pass needs the times before and after the frame."""
        if isinstance(self.plane, ComponentPlane):
            return self.plane.plane in COMPONENT_MOTION
        return self.plane == Pass.VECTOR

    def blender_name(self, version: tuple[int, ...]) -> str:
        return self.long_name if version >= LONG_NAMES_SINCE else self.name


def _same(plane: Plane, name: str, ids: str, kind: str, switch: str) -> PassInfo:
    return PassInfo(plane, name, name, ids, kind, switch)


TABLE = tuple(PassInfo(*row) for row in pass_table.PASSES)

OF_VOLUMES = (
    PassInfo(None, "VolumeDir", "Volume Direct", "RGB", "COLOR", "use_pass_volume_direct"),
    PassInfo(None, "VolumeInd", "Volume Indirect", "RGB", "COLOR", "use_pass_volume_indirect"),
    PassInfo(None, "Volume Scatter", "Volume Scatter", "RGB", "COLOR", "use_pass_volume_scatter"),
    PassInfo(None, "Volume Transmit", "Volume Transmit", "RGB", "COLOR", "use_pass_volume_transmit"),
    PassInfo(None, "Volume Majorant", "Volume Majorant", "Z", "VALUE", "use_pass_volume_majorant"),
)
"""Passes by switches of view_layer.cycles. They are 0, because volumes are not rendered."""

_CYCLES_SWITCHES = {
    "gradus.use_pass_denoising": "denoising_store_passes",
    "gradus.use_pass_sample_count": "pass_debug_sample_count",
    "gradus.use_pass_shadow_catcher": "use_pass_shadow_catcher",
}
"""Switches of view_layer.cycles that also ask for passes with switches of Gradus."""

_CHANNEL_IDS = {
    ChannelKind.AOV_COLOR: ("RGBA", "COLOR"),
    ChannelKind.AOV_VALUE: ("X", "VALUE"),
    ChannelKind.LIGHT_GROUP: ("RGB", "COLOR"),
}
"""Letters and kind of passes of channels other than Cryptomattes."""


@dataclass(frozen=True)
class ComponentPassInfo:
    """A pass that every component has. Its name is `Path`, the name of the component, and `suffix`."""

    plane: ComponentPass
    suffix: str
    ids: str
    kind: str
    switch: str

    def of(self, component: str) -> PassInfo:
        plane, name = ComponentPlane(component, self.plane), f"Path {component}{self.suffix}"
        return _same(plane, name, self.ids, self.kind, self.switch)


COMPONENT_TABLE = tuple(ComponentPassInfo(*row) for row in pass_table.COMPONENT_PASSES)
"""Passes of a component: Path NAME, Path NAME Reflectance …."""

_ALL_SWITCHES = tuple(row[0] for row in pass_table.SWITCHES)
_OF_COMPONENTS = frozenset(info.switch.removeprefix("gradus.") for info in COMPONENT_TABLE)

COMPONENT_SWITCHES = tuple(name for name in _ALL_SWITCHES if name in _OF_COMPONENTS)
"""Properties of view_layer.gradus that switch passes of components, in the order of the schema."""

SAMPLING_SWITCHES = tuple(name for name in _ALL_SWITCHES if name not in _OF_COMPONENTS)
"""The other properties of view_layer.gradus, which switch passes of the whole picture."""

GROUPS = {**pass_table.GROUPS, "ALL": tuple(info.plane for info in TABLE)}
"""Names that `--gradus-passes` takes besides those of single planes."""


@dataclass(frozen=True)
class ExtraPasses:
    """Planes that the command line adds."""

    planes: frozenset[Pass] = frozenset()
    component_planes: frozenset[ComponentPass] = frozenset()


NO_EXTRA = ExtraPasses()


def list_passes(
    view_layer: Any, reconstructed: bool, components: Iterable[str] = (), extra: ExtraPasses = NO_EXTRA
) -> Iterator[PassInfo]:
    """Yields the passes of a view layer. `components`: names of all components, if the image is decomposed."""
    for info in TABLE:
        if info.plane in extra.planes or _is_on(info.switch, view_layer, reconstructed):
            yield info
    cycles = getattr(view_layer, "cycles", None)
    yield from (info for info in OF_VOLUMES if getattr(cycles, info.switch, False))
    for channel in channels_of(view_layer):
        yield from (_of_channel(channel, layer) for layer in range(channel.layers))
    infos = [
        info
        for info in COMPONENT_TABLE
        if info.plane in extra.component_planes or _is_on(info.switch, view_layer, reconstructed)
    ]
    for component in components:
        yield from (info.of(component) for info in infos)


def _of_channel(channel: Channel, layer: int) -> PassInfo:
    """Returns a pass with the channels and the kind that it has in Cycles.

    Identifiers have lower-case letters, which lossy compression does not touch.
    """
    ids, kind = _CHANNEL_IDS.get(channel.kind, ("rgba", "COLOR"))
    return _same(ChannelPlane(channel, layer), channel.pass_name(layer), ids, kind, "")


def _is_on(switch: str, view_layer: Any, reconstructed: bool) -> bool:
    if not switch:
        return True
    if switch == "reconstructed":
        return reconstructed
    if switch.startswith("gradus."):
        cycles = getattr(view_layer, "cycles", None)
        is_on_in_cycles = bool(getattr(cycles, _CYCLES_SWITCHES.get(switch, ""), False))
        return is_on_in_cycles or bool(getattr(view_layer.gradus, switch.removeprefix("gradus.")))
    return bool(getattr(view_layer, switch, False))


def mask(infos: Iterable[PassInfo]) -> int:
    """Returns GradusSettings.passes: one bit for each plane."""
    return _bits(info.plane for info in infos if isinstance(info.plane, Pass))


def component_mask(infos: Iterable[PassInfo]) -> int:
    """Returns GradusSettings.component_passes: one bit for each plane."""
    return _bits(info.plane.plane for info in infos if isinstance(info.plane, ComponentPlane))


def needs_next_frame(infos: Iterable[PassInfo]) -> bool:
    """Returns whether passes need optical flow between two frames: the motion of irradiance and of Residual."""
    return any(info.is_motion and isinstance(info.plane, ComponentPlane) for info in infos)


def _bits(planes: Iterable[int]) -> int:
    bits = 0
    for plane in planes:
        bits |= 1 << plane
    return bits


def by_name(infos: Iterable[PassInfo], version: tuple[int, ...]) -> dict[str, PassInfo]:
    return {info.blender_name(version): info for info in infos}
