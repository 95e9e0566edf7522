"""Mean radiance of sky textures, for as long as they are not rendered themselves.

Measured with Cycles at default air, dust, ozone and ground albedo: the mean over the hemisphere above the horizon, for what lies below is
hidden by the ground in most scenes, and Hosek-Wilkie and Preetham shine brightest there; and the sun's irradiance on a plane that faces it.
"""

from __future__ import annotations

import math
from typing import Any

Rgb = tuple[float, float, float]

_ELEVATIONS = (0.0, 5.0, 15.0, 30.0, 45.0, 60.0, 90.0)  # of the sun, degrees
# NISHITA of Blender 4.5, as in 3.4; SINGLE_SCATTERING of 5.0 differs by less than 4 %.
_SINGLE_SKY = (
    (0.545, 0.473, 0.412),
    (2.156, 2.066, 1.746),
    (3.273, 3.537, 3.729),
    (3.188, 3.752, 4.575),
    (2.893, 3.580, 4.704),
    (2.670, 3.403, 4.669),
    (2.487, 3.238, 4.588),
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
    (0.736, 0.591, 0.707),
    (2.430, 2.627, 2.902),
    (3.526, 4.829, 6.622),
    (3.752, 5.684, 8.551),
    (3.868, 6.082, 9.486),
    (3.961, 6.332, 10.049),
    (4.042, 6.521, 10.463),
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
# At turbidity 2.2, the default.
_PREETHAM = (
    (0.412, 0.414, 0.369),
    (0.412, 0.414, 0.369),
    (0.455, 0.501, 0.602),
    (0.457, 0.565, 0.864),
    (0.429, 0.567, 0.931),
    (0.396, 0.538, 0.877),
    (0.415, 0.601, 1.056),
)
_HOSEK_WILKIE = (
    (0.039, 0.043, 0.040),
    (0.039, 0.043, 0.040),
    (0.055, 0.074, 0.090),
    (0.060, 0.092, 0.133),
    (0.060, 0.098, 0.157),
    (0.060, 0.099, 0.167),
    (0.068, 0.108, 0.174),
)
# Times this at other turbidities: the geometric mean for suns at 30 and 90 degrees.
_TURBIDITIES = (2.2, 4.0, 8.0)
_PREETHAM_HAZE = ((1.0, 1.0, 1.0), (1.28, 1.20, 1.05), (2.27, 1.85, 1.19))
_HOSEK_WILKIE_HAZE = ((1.0, 1.0, 1.0), (1.41, 1.19, 1.02), (2.34, 1.56, 1.11))


def _at(places: tuple[float, ...], table: tuple[Rgb, ...], x: float) -> Rgb:
    """Linear between the places, constant beyond them."""
    x = min(max(x, places[0]), places[-1])
    i = max(k for k in range(len(places) - 1) if places[k] <= x)
    t = (x - places[i]) / (places[i + 1] - places[i])
    return tuple(a + (b - a) * t for a, b in zip(table[i], table[i + 1], strict=True))


def _clear_sky(node: Any) -> Rgb:
    preetham = node.sky_type == "PREETHAM"
    x, y, z = node.sun_direction
    degrees = math.degrees(math.atan2(z, math.hypot(x, y)))
    sky = _at(_ELEVATIONS, _PREETHAM if preetham else _HOSEK_WILKIE, degrees)
    haze = _at(_TURBIDITIES, _PREETHAM_HAZE if preetham else _HOSEK_WILKIE_HAZE, node.turbidity)
    return tuple(a * b for a, b in zip(sky, haze, strict=True))


def mean_radiance(node: Any) -> Rgb:
    """Scene-linear RGB over the upper hemisphere, the sun's disk included where the node draws it."""
    if node.sky_type in ("PREETHAM", "HOSEK_WILKIE"):
        return _clear_sky(node)
    multiple = node.sky_type == "MULTIPLE_SCATTERING"
    degrees = math.degrees(node.sun_elevation)
    sky = _at(_ELEVATIONS, _MULTIPLE_SKY if multiple else _SINGLE_SKY, degrees)
    if not node.sun_disc or degrees < -1.0:
        return sky
    sun = _at(_ELEVATIONS, _MULTIPLE_SUN if multiple else _SINGLE_SUN, degrees)
    return tuple(a + b * node.sun_intensity / (2.0 * math.pi) for a, b in zip(sky, sun, strict=True))
