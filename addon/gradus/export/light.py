"""Lights in the units of the running Blender.

The meaning of a watt changed in Blender 4.0: area lights changed by 4/pi, and spots lost a cosine. It depends on the
running version and not on the file, because Blender converts old files when it loads them. All factors were measured
with Cycles in 3.4, 4.5 and 5.0.
"""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass
from typing import Any

POINT, SPOT, SUN, RECTANGLE, ELLIPSE = range(5)
NO_SHADOW, SPOT_COSINE, DISK_FACING, NO_MIS, ROUND_CONE, WORLD_UV, NO_OBJECT = 1, 2, 4, 8, 16, 32, 64
NO_LIMIT = 0xFFFFFFFF


@dataclass
class LightState:
    """The values of a GradusLight, without its matrix."""

    type: int
    strength: tuple[float, float, float]
    flags: int = 0
    radius: float = 0.0
    angle: float = 0.0
    size: tuple[float, float] = (0.0, 0.0)
    spread: float = math.pi
    cone: float = math.pi
    blend: float = 0.0
    sun_radiance_per_irradiance: float = 0.0
    max_bounces: int = NO_LIMIT


def _power(light: Any) -> tuple[float, float, float]:
    """Returns colour times energy, with exposure and temperature, which Blender has from 4.5 on."""
    power = light.energy * 2.0 ** getattr(light, "exposure", 0.0)
    color = tuple(light.color)
    if getattr(light, "use_temperature", False):
        color = tuple(c * t for c, t in zip(color, light.temperature_color, strict=True))
    return tuple(c * power for c in color)


def _scaled(values: tuple[float, ...], factor: float) -> tuple[float, float, float]:
    return tuple(value * factor for value in values)


def _flags(light: Any, version: tuple[int, ...]) -> int:
    cycles = getattr(light, "cycles", None)
    flags = 0
    if version < (4, 0, 0):
        flags |= ROUND_CONE | WORLD_UV
    if not is_object(version):
        flags |= NO_OBJECT
    # Before 4.2, Cycles has a switch of its own.
    if not getattr(cycles, "cast_shadow", light.use_shadow):
        flags |= NO_SHADOW
    if not getattr(cycles, "use_multiple_importance_sampling", True):
        flags |= NO_MIS
    return flags


def _is_disk(light: Any, version: tuple[int, ...]) -> bool:
    """Returns whether a round light is a disk that faces the receiver.

    This is always so before 4.1, and with soft falloff from then on.
    """
    return version < (4, 1, 0) or getattr(light, "use_soft_falloff", True)


def _round(light: Any, power: tuple[float, float, float], version: tuple[int, ...]) -> LightState:
    """Returns a point light with the intensity P / (4 pi) W/sr. Spot lights are derived from it."""
    radius = max(light.shadow_soft_size, 0.0)
    intensity = _scaled(power, 0.25 / math.pi)
    if not getattr(light, "normalize", True):
        # The disk has the radiance energy/pi; without a radius, the intensity is energy/pi (measured in 4.5 and 5.0).
        intensity = _scaled(power, radius * radius if radius > 0.0 else 1.0 / math.pi)
    state = LightState(POINT, intensity, radius=radius)
    if _is_disk(light, version):
        state.flags |= DISK_FACING
    return state


def _spot(light: Any, power: tuple[float, float, float], version: tuple[int, ...]) -> LightState:
    state = _round(light, power, version)
    state.type = SPOT
    state.cone = light.spot_size
    state.blend = light.spot_blend
    if version < (4, 0, 0):
        state.flags |= SPOT_COSINE
    return state


def sun_radiance(angle: float, version: tuple[int, ...]) -> float:
    """Returns the radiance per W/m2 of a sun with an angle, or 0 for a disk with the exact irradiance.

    Before 4.0, a sun was a disk of radius tan(angle/2) at distance 1, weighted with 1/cos^3: its irradiance is too
    small by the mean cosine over that disk.
    """
    half = 0.5 * angle
    if version >= (4, 0, 0) or half <= 1e-4 or half >= 0.5 * math.pi:
        return 0.0
    mean_cosine = 2.0 * (1.0 / math.cos(half) - 1.0) / math.tan(half) ** 2
    return mean_cosine / (math.pi * math.sin(half) ** 2)


def _sun(light: Any, power: tuple[float, float, float], version: tuple[int, ...]) -> LightState:
    angle = min(max(light.angle, 0.0), math.pi)
    if not getattr(light, "normalize", True) and angle > 0.0:
        power = _scaled(power, math.pi * math.sin(0.5 * angle) ** 2)  # the energy is a radiance
    return LightState(SUN, power, angle=angle, sun_radiance_per_irradiance=sun_radiance(angle, version))


def _old_spread(spread: float) -> tuple[float, float]:
    """Returns the spread that Cycles before 4.0 allows, and the factor by which rounding errors brighten its light.

    Its formula for the normalisation loses most digits of single precision: 25 % at 1 degree, 0.2 % at 5 degrees.
    """

    def rounded(value: float) -> float:
        return ctypes.c_float(value).value

    spread = max(spread, math.radians(1.0))
    pi, half = rounded(math.pi), 0.5 * spread
    complement = rounded(0.5 * rounded(pi - rounded(spread)))
    product = rounded(rounded(rounded(2.0 * complement) - pi) * rounded(math.tan(complement)))
    exact = math.tan(half) / (math.tan(half) - half)
    return spread, rounded(2.0 / rounded(2.0 + product)) / exact


def _area(
    light: Any, power: tuple[float, float, float], version: tuple[int, ...], scale: tuple[float, ...]
) -> LightState:
    """Returns an area light. Its strength is a radiance, and its size includes the scale of the object."""
    round_shape = light.shape in {"DISK", "ELLIPSE"}
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    size = (light.size * scale[0], height * scale[1])
    area = size[0] * size[1] * (0.25 * math.pi if round_shape else 1.0)
    if not getattr(light, "normalize", True):
        factor = 1.0 / math.pi
    elif area > 0.0:
        factor = 1.0 / ((4.0 if version < (4, 0, 0) else math.pi) * area)
    else:
        factor = 0.0
    kind, spread = ELLIPSE if round_shape else RECTANGLE, getattr(light, "spread", math.pi)
    if version < (4, 0, 0) and spread < math.pi:
        spread, brightening = _old_spread(spread)
        factor *= brightening
    return LightState(kind, _scaled(power, factor), size=size, spread=spread)


def light_state(light: Any, scale: tuple[float, ...], version: tuple[int, ...]) -> LightState:
    """Returns the state of an evaluated light.

    scale: lengths of the object's axes; version: that of the running Blender.
    """
    power = _power(light)
    if light.type == "AREA":
        state = _area(light, power, version, scale)
    elif light.type == "SUN":
        state = _sun(light, power, version)
    elif light.type == "SPOT":
        state = _spot(light, power, version)
    else:
        state = _round(light, power, version)
    state.flags |= _flags(light, version)
    bounces = getattr(getattr(light, "cycles", None), "max_bounces", None)
    if bounces is not None and bounces < 1024:  # 1024 is Cycles' default and stands for no limit
        state.max_bounces = max(bounces, 0)
    return state


def is_object(version: tuple[int, ...]) -> bool:
    """Returns whether nodes of a light read the properties of its object, as in Cycles since 4.5."""
    return version >= (4, 5, 0)


def constant_emission(light: Any) -> tuple[float, float, float] | None:
    """Returns colour times strength of a light's Emission node, or (1, 1, 1) without nodes.

    Returns None if the light needs a node program.
    """
    tree = light.node_tree if light.use_nodes else None
    if tree is None:
        return (1.0, 1.0, 1.0)
    output = tree.get_output_node("CYCLES")
    if output is None:
        return (0.0, 0.0, 0.0)
    surface = output.inputs["Surface"]
    if not surface.is_linked:
        return (0.0, 0.0, 0.0)
    link = surface.links[0]
    node = link.from_node
    if node.bl_idname != "ShaderNodeEmission" or node.mute or not link.is_valid or link.is_muted:
        return None
    if node.inputs["Color"].is_linked or node.inputs["Strength"].is_linked:
        return None
    strength = node.inputs["Strength"].default_value
    return tuple(channel * strength for channel in node.inputs["Color"].default_value[:3])
