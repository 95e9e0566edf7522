"""The passes: Blender's names, channels and switches, and the native plane. Registration, the settings mask and the upload are
all made from list_passes(). The rows are generated: pass_table.py. This module does not use Blender."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from . import pass_table
from .abi import ComponentPass, Pass

LONG_NAMES_SINCE = (5, 0, 0)
MOTION_OF_COMPONENTS = (
    ComponentPass.MOTION,
    ComponentPass.TRACKED,
    ComponentPass.IRRADIANCE_MOTION,
    ComponentPass.IRRADIANCE_TRACKED,
)


@dataclass(frozen=True)
class Part:
    """A plane of one component of the picture."""

    component: str
    plane: ComponentPass


@dataclass(frozen=True)
class PassInfo:
    """A pass as Blender knows it. `switch`: property of the view layer, or of view_layer.gradus where it starts with "gradus."."""

    plane: Pass | Part
    name: str
    long_name: str  # from Blender 5.0 on
    ids: str  # one letter per channel
    kind: str  # VALUE, VECTOR or COLOR
    switch: str  # "" = always, "reconstructed" = whenever Combined is a reconstruction

    @property
    def channels(self) -> int:
        return len(self.ids)

    @property
    def is_motion(self) -> bool:
        """Whether it needs the moments before and after the frame."""
        if isinstance(self.plane, Part):
            return self.plane.plane in MOTION_OF_COMPONENTS
        return self.plane == Pass.VECTOR

    def blender_name(self, version: tuple[int, ...]) -> str:
        return self.long_name if version >= LONG_NAMES_SINCE else self.name


def _same(plane: Pass | Part, name: str, ids: str, kind: str, switch: str) -> PassInfo:
    return PassInfo(plane, name, name, ids, kind, switch)


TABLE = tuple(PassInfo(*row) for row in pass_table.PASSES)


@dataclass(frozen=True)
class PartInfo:
    """A pass that every component has. `suffix`: of its name, after that of the component."""

    plane: ComponentPass
    suffix: str
    ids: str
    kind: str
    switch: str

    def of(self, component: str) -> PassInfo:
        return _same(Part(component, self.plane), f"Path {component}{self.suffix}", self.ids, self.kind, self.switch)


PARTS = tuple(PartInfo(*row) for row in pass_table.COMPONENT_PASSES)
"""Passes of a component: Path NAME, Path NAME Reflectance … (contract 6.6)."""

GROUPS = {**pass_table.GROUPS, "ALL": tuple(info.plane for info in TABLE)}
"""Names that `--gradus-passes` takes besides those of single planes."""


def is_reconstructed(integrator: str, reconstruction: str, denoiser: str) -> bool:
    """Whether Combined is a reconstruction, so that the sampled image becomes a pass of its own (contract 6.1). Identifiers of
    settings.py; AUTO may find that gradients do not pay, or no denoiser: then both are the same."""
    return reconstruction == "REGULARIZED" or (integrator != "PATH" and reconstruction != "NONE") or denoiser != "NONE"


@dataclass(frozen=True)
class Extra:
    """Planes asked for on the command line."""

    planes: frozenset[Pass] = frozenset()
    parts: frozenset[ComponentPass] = frozenset()


NOTHING = Extra()


def list_passes(view_layer: Any, reconstructed: bool, components: Iterable[str] = (), extra: Extra = NOTHING) -> Iterator[PassInfo]:
    """The passes of a view layer. `components`: names of those into which the picture is taken apart."""
    for info in TABLE:
        if info.plane in extra.planes or _is_on(info.switch, view_layer, reconstructed):
            yield info
    parts = [part for part in PARTS if part.plane in extra.parts or _is_on(part.switch, view_layer, reconstructed)]
    for component in components:
        yield from (part.of(component) for part in parts)


def _is_on(switch: str, view_layer: Any, reconstructed: bool) -> bool:
    if not switch:
        return True
    if switch == "reconstructed":
        return reconstructed
    if switch.startswith("gradus."):
        return bool(getattr(view_layer.gradus, switch.removeprefix("gradus.")))
    return bool(getattr(view_layer, switch, False))


def mask(infos: Iterable[PassInfo]) -> int:
    """GradusSettings.passes: one bit for each plane."""
    return _bits(info.plane for info in infos if not isinstance(info.plane, Part))


def component_mask(infos: Iterable[PassInfo]) -> int:
    """GradusSettings.component_passes."""
    return _bits(info.plane.plane for info in infos if isinstance(info.plane, Part))


def needs_next_frame(infos: Iterable[PassInfo]) -> bool:
    """Whether some are made of two frames of an animation, by optical flow: irradiance's motion, and Residual's."""
    return any(info.is_motion and isinstance(info.plane, Part) for info in infos)


def _bits(planes: Iterable[int]) -> int:
    bits = 0
    for plane in planes:
        bits |= 1 << plane
    return bits


def by_name(infos: Iterable[PassInfo], version: tuple[int, ...]) -> dict[str, PassInfo]:
    return {info.blender_name(version): info for info in infos}
