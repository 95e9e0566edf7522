"""Mean radiance of sky textures, for as long as they are not rendered themselves.

Measured with Cycles at default air, dust and ozone: the sky over the whole sphere, and the sun's irradiance on a plane that faces it.
"""

from __future__ import annotations

import math
from typing import Any

Rgb = tuple[float, float, float]

_ELEVATIONS = (0.0, 5.0, 15.0, 30.0, 45.0, 60.0, 90.0)  # of the sun, degrees
# NISHITA of Blender 3.4; SINGLE_SCATTERING of 5.0 differs by less than 2 %.
_SINGLE_SKY = (
    (0.308, 0.243, 0.206),
    (1.475, 1.223, 0.905),
    (2.104, 2.083, 2.004),
    (1.895, 2.119, 2.442),
    (1.662, 1.985, 2.497),
    (1.509, 1.867, 2.467),
    (1.394, 1.766, 2.416),
)
_SINGLE_SUN = (
    (2.5, 0.5, 0.0),
    (70.9, 37.1, 7.9),
    (121.3, 87.8, 48.7),
    (140.1, 111.2, 79.0),
    (146.6, 119.9, 92.2),
    (149.6, 124.0, 98.7),
    (152.2, 127.1, 103.4),
)
# MULTIPLE_SCATTERING of Blender 5.0.
_MULTIPLE_SKY = (
    (0.385, 0.301, 0.363),
    (1.369, 1.410, 1.507),
    (1.932, 2.581, 3.484),
    (2.019, 3.011, 4.498),
    (2.078, 3.221, 4.995),
    (2.130, 3.355, 5.295),
    (2.180, 3.461, 5.520),
)
_MULTIPLE_SUN = (
    (4.1, 0.5, 0.0),
    (72.2, 36.8, 8.4),
    (126.8, 93.7, 53.1),
    (149.5, 122.6, 87.2),
    (157.6, 133.6, 102.2),
    (161.5, 138.8, 109.7),
    (164.1, 142.4, 114.7),
)
_PREETHAM = (0.597, 0.679, 0.997)
_HOSEK_WILKIE = (0.083, 0.154, 0.219)


def _at(table: tuple[Rgb, ...], degrees: float) -> Rgb:
    degrees = min(max(degrees, _ELEVATIONS[0]), _ELEVATIONS[-1])
    i = max(k for k in range(len(_ELEVATIONS) - 1) if _ELEVATIONS[k] <= degrees)
    t = (degrees - _ELEVATIONS[i]) / (_ELEVATIONS[i + 1] - _ELEVATIONS[i])
    return tuple(a + (b - a) * t for a, b in zip(table[i], table[i + 1], strict=True))


def mean_radiance(node: Any) -> Rgb:
    """Scene-linear RGB over the whole sphere, the sun's disk included where the node draws it."""
    if node.sky_type == "PREETHAM":
        return _PREETHAM
    if node.sky_type == "HOSEK_WILKIE":
        return _HOSEK_WILKIE
    multiple = node.sky_type == "MULTIPLE_SCATTERING"
    degrees = math.degrees(node.sun_elevation)
    sky = _at(_MULTIPLE_SKY if multiple else _SINGLE_SKY, degrees)
    if not node.sun_disc or degrees < -1.0:
        return sky
    sun = _at(_MULTIPLE_SUN if multiple else _SINGLE_SUN, degrees)
    return tuple(a + b * node.sun_intensity / (4.0 * math.pi) for a, b in zip(sky, sun, strict=True))
