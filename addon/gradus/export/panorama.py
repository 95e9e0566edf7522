"""Panoramic cameras: the window of the frame in the film coordinates of each type; see GradusPanorama."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..native import Panorama

TYPES = {
    "EQUIRECTANGULAR": Panorama.EQUIRECTANGULAR,
    "EQUIANGULAR_CUBEMAP_FACE": Panorama.CUBE_FACE,
    "MIRRORBALL": Panorama.MIRROR_BALL,
    "FISHEYE_EQUIDISTANT": Panorama.FISHEYE_EQUIDISTANT,
    "FISHEYE_EQUISOLID": Panorama.FISHEYE_EQUISOLID,
    "FISHEYE_LENS_POLYNOMIAL": Panorama.FISHEYE_POLYNOMIAL,
    "CENTRAL_CYLINDRICAL": Panorama.CYLINDER,
}
Window = tuple[float, float, float, float]
_WHOLE = (0.0, 1.0, 0.0, 1.0)


@dataclass(frozen=True)
class Projection:
    """The properties of a panoramic projection besides its window."""

    kind: Panorama
    fov: float  # of the image circle
    polynomial: tuple[float, ...]  # of the lens, from the constant term on

    @classmethod
    def of(cls, data: Any) -> Projection:
        settings = settings_of(data)
        polynomial = tuple(getattr(settings, f"fisheye_polynomial_k{power}") for power in range(5))
        return cls(TYPES[settings.panorama_type], settings.fisheye_fov, polynomial)


def is_known(data: Any) -> bool:
    settings = settings_of(data)
    return settings is not None and settings.panorama_type in TYPES


def settings_of(data: Any) -> Any:
    """Returns the owner of a camera's panorama properties: Cycles before Blender 4.5, the camera from then on."""
    return data if hasattr(data, "panorama_type") else getattr(data, "cycles", None)


def sensor_size(data: Any, size: tuple[int, int], aspect: tuple[float, float]) -> tuple[float, float]:
    """Returns width and height in millimetres, in the proportions of the frame."""
    x, y = size[0] * aspect[0], size[1] * aspect[1]
    horizontal = x > y if data.sensor_fit == "AUTO" else data.sensor_fit == "HORIZONTAL"
    side = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    return (side, side * y / x) if horizontal else (side * x / y, side)


def _centred(width: float, height: float) -> Window:
    return (-0.5 * width, 0.5 * width, -0.5 * height, 0.5 * height)


def _whole_frame(kind: Panorama, panorama: Any, sensor: tuple[float, float]) -> Window:
    if kind == Panorama.EQUIRECTANGULAR:
        return (panorama.longitude_min, panorama.longitude_max, panorama.latitude_min, panorama.latitude_max)
    if kind == Panorama.CYLINDER:
        radius = panorama.central_cylindrical_radius
        bottom, top = panorama.central_cylindrical_range_v_min, panorama.central_cylindrical_range_v_max
        left, right = panorama.central_cylindrical_range_u_min, panorama.central_cylindrical_range_u_max
        return (left, right, bottom / radius, top / radius)
    if kind == Panorama.CUBE_FACE:
        return _centred(0.5 * math.pi, 0.5 * math.pi)
    if kind == Panorama.MIRROR_BALL:
        return _centred(2.0, 2.0)
    if kind == Panorama.FISHEYE_EQUIDISTANT:
        return _centred(panorama.fisheye_fov, panorama.fisheye_fov)
    scale = 1.0 / (2.0 * panorama.fisheye_lens) if kind == Panorama.FISHEYE_EQUISOLID else 1.0
    return _centred(sensor[0] * scale, sensor[1] * scale)


def window(
    data: Any, shift: tuple[float, float], size: tuple[int, int], aspect: tuple[float, float], section: Window = _WHOLE
) -> Window:
    """Returns left, right, bottom, top of a section of the frame.

    Shift and section are relative to the size of the frame.
    """
    panorama = settings_of(data)
    left, right, bottom, top = _whole_frame(TYPES[panorama.panorama_type], panorama, sensor_size(data, size, aspect))
    width, height = right - left, top - bottom
    return (
        left + width * (section[0] + shift[0]),
        left + width * (section[1] + shift[0]),
        bottom + height * (section[2] + shift[1]),
        bottom + height * (section[3] + shift[1]),
    )
