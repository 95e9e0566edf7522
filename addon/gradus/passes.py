"""The table of passes: Blender's names, channels and switches, and the native plane. No Blender here.

Registration, the settings mask and the upload all use list_passes().
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from .abi import ComponentPass, Pass

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
class PassInfo:
    """A pass of Blender.

    `switch` is a property of the view layer, or of view_layer.gradus if it starts with "gradus.".
    """

    plane: Pass | ComponentPlane
    name: str
    long_name: str  # from Blender 5.0 on
    ids: str  # one letter per channel
    kind: str  # VALUE, VECTOR or COLOR
    switch: str  # "": always on; "reconstructed": on if Combined is a reconstruction

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


def _same(plane: Pass | ComponentPlane, name: str, ids: str, kind: str, switch: str) -> PassInfo:
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


COMPONENT_TABLE: tuple[ComponentPassInfo, ...] = (
    ComponentPassInfo(ComponentPass.COLOR, "", "RGB", "COLOR", "gradus.use_pass_components"),
    ComponentPassInfo(
        ComponentPass.REFLECTANCE, " Reflectance", "RGB", "COLOR", "gradus.use_pass_component_reflectance"
    ),
    ComponentPassInfo(ComponentPass.IRRADIANCE, " Irradiance", "RGB", "COLOR", "gradus.use_pass_component_irradiance"),
    ComponentPassInfo(ComponentPass.NORMAL, " Normal", "XYZ", "VECTOR", "gradus.use_pass_component_normal"),
    ComponentPassInfo(ComponentPass.MOTION, " Motion", "XYZW", "VECTOR", "gradus.use_pass_component_motion"),
    ComponentPassInfo(ComponentPass.TRACKED, " Tracked", "X", "VALUE", "gradus.use_pass_component_motion"),
    ComponentPassInfo(
        ComponentPass.IRRADIANCE_MOTION,
        " Irradiance Motion",
        "XYZW",
        "VECTOR",
        "gradus.use_pass_component_irradiance_motion",
    ),
    ComponentPassInfo(
        ComponentPass.IRRADIANCE_TRACKED,
        " Irradiance Tracked",
        "X",
        "VALUE",
        "gradus.use_pass_component_irradiance_motion",
    ),
    ComponentPassInfo(ComponentPass.DEPTH, " Depth", "X", "VALUE", "gradus.use_pass_component_depth"),
    ComponentPassInfo(ComponentPass.UV, " UV", "UVA", "VECTOR", "gradus.use_pass_component_uv"),
    ComponentPassInfo(ComponentPass.OBJECT_INDEX, " Object Index", "X", "VALUE", "gradus.use_pass_component_index"),
    ComponentPassInfo(ComponentPass.FACE_INDEX, " Face Index", "X", "VALUE", "gradus.use_pass_component_index"),
    ComponentPassInfo(ComponentPass.EMIT, " Emit", "RGB", "COLOR", "gradus.use_pass_component_emit"),
)
"""Passes of a component: Path NAME, Path NAME Reflectance …"""

GROUPS: dict[str, tuple[Pass, ...]] = {
    "GRADIENTS": (Pass.GRADIENT_X, Pass.GRADIENT_Y, Pass.GRADIENT_T, Pass.GRADIENT_T_LINK),
    "DENOISING": (Pass.DENOISING_NORMAL, Pass.DENOISING_ALBEDO, Pass.DENOISING_DEPTH),
    "ALL": tuple(info.plane for info in TABLE),
}
"""Names that `--gradus-passes` accepts besides those of single planes."""


def is_reconstructed(integrator: str, reconstruction: str, denoiser: str) -> bool:
    """Returns whether Combined may be a reconstruction, so that the sampled image gets a pass of its own.

    The arguments are identifiers of settings.py. AUTO may choose plain samples during the render: then both passes are
    equal.
    """
    return reconstruction == "REGULARIZED" or (integrator != "PATH" and reconstruction != "NONE") or denoiser != "NONE"


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
    infos = [
        info
        for info in COMPONENT_TABLE
        if info.plane in extra.component_planes or _is_on(info.switch, view_layer, reconstructed)
    ]
    for component in components:
        yield from (info.of(component) for info in infos)


def _is_on(switch: str, view_layer: Any, reconstructed: bool) -> bool:
    if not switch:
        return True
    if switch == "reconstructed":
        return reconstructed
    if switch.startswith("gradus."):
        return bool(getattr(view_layer.gradus, switch.removeprefix("gradus.")))
    return bool(getattr(view_layer, switch, False))


def mask(infos: Iterable[PassInfo]) -> int:
    """Returns GradusSettings.passes: one bit for each plane."""
    return _bits(info.plane for info in infos if not isinstance(info.plane, ComponentPlane))


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
