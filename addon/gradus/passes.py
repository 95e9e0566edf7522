"""THE table of passes: Blender's names, channels and switches, and the native plane. Registration, the settings mask and the upload
are all made from list_passes(). No Blender here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

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


def _light(plane: Pass, name: str, long_name: str, switch: str) -> PassInfo:
    return PassInfo(plane, name, long_name, "RGB", "COLOR", switch)


TABLE: tuple[PassInfo, ...] = (
    _same(Pass.COMBINED, "Combined", "RGBA", "COLOR", ""),
    _same(Pass.NOISY_IMAGE, "Noisy Image", "RGBA", "COLOR", "reconstructed"),
    _same(Pass.DEPTH, "Depth", "Z", "VALUE", "use_pass_z"),
    _same(Pass.MIST, "Mist", "Z", "VALUE", "use_pass_mist"),
    _same(Pass.POSITION, "Position", "XYZ", "VECTOR", "use_pass_position"),
    _same(Pass.NORMAL, "Normal", "XYZ", "VECTOR", "use_pass_normal"),
    _same(Pass.VECTOR, "Vector", "XYZW", "VECTOR", "use_pass_vector"),
    _same(Pass.UV, "UV", "UVA", "VECTOR", "use_pass_uv"),
    PassInfo(Pass.OBJECT_INDEX, "IndexOB", "Object Index", "X", "VALUE", "use_pass_object_index"),
    PassInfo(Pass.MATERIAL_INDEX, "IndexMA", "Material Index", "X", "VALUE", "use_pass_material_index"),
    _light(Pass.DIFFUSE_DIRECT, "DiffDir", "Diffuse Direct", "use_pass_diffuse_direct"),
    _light(Pass.DIFFUSE_INDIRECT, "DiffInd", "Diffuse Indirect", "use_pass_diffuse_indirect"),
    _light(Pass.DIFFUSE_COLOR, "DiffCol", "Diffuse Color", "use_pass_diffuse_color"),
    _light(Pass.GLOSSY_DIRECT, "GlossDir", "Glossy Direct", "use_pass_glossy_direct"),
    _light(Pass.GLOSSY_INDIRECT, "GlossInd", "Glossy Indirect", "use_pass_glossy_indirect"),
    _light(Pass.GLOSSY_COLOR, "GlossCol", "Glossy Color", "use_pass_glossy_color"),
    _light(Pass.TRANSMISSION_DIRECT, "TransDir", "Transmission Direct", "use_pass_transmission_direct"),
    _light(Pass.TRANSMISSION_INDIRECT, "TransInd", "Transmission Indirect", "use_pass_transmission_indirect"),
    _light(Pass.TRANSMISSION_COLOR, "TransCol", "Transmission Color", "use_pass_transmission_color"),
    _light(Pass.EMISSION, "Emit", "Emission", "use_pass_emit"),
    _light(Pass.ENVIRONMENT, "Env", "Environment", "use_pass_environment"),
    _light(Pass.AMBIENT_OCCLUSION, "AO", "Ambient Occlusion", "use_pass_ambient_occlusion"),
    _same(Pass.DENOISING_NORMAL, "Denoising Normal", "XYZ", "VECTOR", "gradus.use_pass_denoising"),
    _same(Pass.DENOISING_ALBEDO, "Denoising Albedo", "RGB", "COLOR", "gradus.use_pass_denoising"),
    _same(Pass.DENOISING_DEPTH, "Denoising Depth", "Z", "VALUE", "gradus.use_pass_denoising"),
    _same(Pass.SAMPLE_COUNT, "Debug Sample Count", "X", "VALUE", "gradus.use_pass_sample_count"),
    _same(Pass.GRADIENT_X, "Gradient X", "RGB", "COLOR", "gradus.use_pass_gradients"),
    _same(Pass.GRADIENT_Y, "Gradient Y", "RGB", "COLOR", "gradus.use_pass_gradients"),
    _same(Pass.GRADIENT_T, "Gradient T", "RGB", "COLOR", "gradus.use_pass_gradients"),
    _same(Pass.GRADIENT_T_LINK, "Gradient T Link", "XYZ", "VECTOR", "gradus.use_pass_gradients"),
    _same(Pass.VARIANCE, "Variance", "RGB", "COLOR", "gradus.use_pass_variance"),
    _same(Pass.ERROR, "Error", "X", "VALUE", "gradus.use_pass_error"),
    _same(Pass.FALLBACK, "Fallback", "X", "VALUE", "option"),
)


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


PARTS: tuple[PartInfo, ...] = (
    PartInfo(ComponentPass.COLOR, "", "RGB", "COLOR", "gradus.use_pass_components"),
    PartInfo(ComponentPass.REFLECTANCE, " Reflectance", "RGB", "COLOR", "gradus.use_pass_component_reflectance"),
    PartInfo(ComponentPass.IRRADIANCE, " Irradiance", "RGB", "COLOR", "gradus.use_pass_component_irradiance"),
    PartInfo(ComponentPass.NORMAL, " Normal", "XYZ", "VECTOR", "gradus.use_pass_component_normal"),
    PartInfo(ComponentPass.MOTION, " Motion", "XYZW", "VECTOR", "gradus.use_pass_component_motion"),
    PartInfo(ComponentPass.TRACKED, " Tracked", "X", "VALUE", "gradus.use_pass_component_motion"),
    PartInfo(ComponentPass.IRRADIANCE_MOTION, " Irradiance Motion", "XYZW", "VECTOR", "gradus.use_pass_component_irradiance_motion"),
    PartInfo(ComponentPass.IRRADIANCE_TRACKED, " Irradiance Tracked", "X", "VALUE", "gradus.use_pass_component_irradiance_motion"),
    PartInfo(ComponentPass.DEPTH, " Depth", "X", "VALUE", "gradus.use_pass_component_depth"),
    PartInfo(ComponentPass.UV, " UV", "UVA", "VECTOR", "gradus.use_pass_component_uv"),
    PartInfo(ComponentPass.OBJECT_INDEX, " Object Index", "X", "VALUE", "gradus.use_pass_component_index"),
    PartInfo(ComponentPass.FACE_INDEX, " Face Index", "X", "VALUE", "gradus.use_pass_component_index"),
    PartInfo(ComponentPass.EMIT, " Emit", "RGB", "COLOR", "gradus.use_pass_component_emit"),
)
"""Passes of a component: Path NAME, Path NAME Reflectance … (contract 6.6)."""

GROUPS: dict[str, tuple[Pass, ...]] = {
    "GRADIENTS": (Pass.GRADIENT_X, Pass.GRADIENT_Y, Pass.GRADIENT_T, Pass.GRADIENT_T_LINK),
    "DENOISING": (Pass.DENOISING_NORMAL, Pass.DENOISING_ALBEDO, Pass.DENOISING_DEPTH),
    "ALL": tuple(info.plane for info in TABLE),
}
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
