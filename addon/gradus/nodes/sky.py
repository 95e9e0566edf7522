"""Mean radiance of sky textures, for as long as they are not rendered themselves."""

from __future__ import annotations

import math
from typing import Any

# Mean over the upper half of the sphere of Blender's NISHITA sky without its sun, strength 1, by sun elevation in degrees; measured
# with Cycles in Blender 3.4 at default air, dust and ozone.
_ELEVATIONS = (0.0, 15.0, 30.0, 60.0, 90.0)
_RADIANCE = ((0.09, 0.10, 0.17), (0.29, 0.38, 0.62), (0.42, 0.57, 0.94), (0.56, 0.78, 1.29), (0.61, 0.86, 1.42))
_OTHER_MODELS = (0.25, 0.3, 0.4)


def mean_radiance(node: Any) -> tuple[float, float, float]:
    """Scene-linear RGB over the whole sphere: sky above, little below the horizon."""
    if node.sky_type not in {"NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"}:
        return _OTHER_MODELS
    degrees = min(max(math.degrees(node.sun_elevation), 0.0), 90.0)
    i = max(k for k in range(len(_ELEVATIONS) - 1) if _ELEVATIONS[k] <= degrees)
    t = (degrees - _ELEVATIONS[i]) / (_ELEVATIONS[i + 1] - _ELEVATIONS[i])
    return tuple(a + (b - a) * t for a, b in zip(_RADIANCE[i], _RADIANCE[i + 1], strict=True))
