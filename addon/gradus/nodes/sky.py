"""Sky Texture. What the settings mean is up to the native library."""

from __future__ import annotations

from typing import Any

from .node import NodeView
from .ops import Op, Sky, TexCoord
from .program import Value
from .registry import translator
from .textures import coordinates

_NO_DISC = -1.0


def _settings(node: Any) -> tuple[float, ...]:
    """The floats of gradus_nodes.h, in order."""
    if node.sky_type in {"PREETHAM", "HOSEK_WILKIE"}:
        return (*node.sun_direction, node.turbidity, node.ground_albedo)
    aerosols = node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density  # renamed in 5.0
    size = node.sun_size if node.sun_disc else _NO_DISC
    densities = (node.air_density, aerosols, node.ozone_density)
    return (node.sun_elevation, node.sun_rotation, size, node.sun_intensity, node.altitude, *densities)


@translator("ShaderNodeTexSky")
def sky_texture(view: NodeView) -> Value:
    vector = coordinates(view, TexCoord.GENERATED)
    return view.add(Op.SKY, (vector,), Sky[view.node.sky_type], _settings(view.node))
