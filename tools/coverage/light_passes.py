"""Light passes times their colours, as a compositor uses them.

Where next to nothing of a pixel shows a surface, the light divided by the colour is that of the few samples that meet
it, and 0 in an engine whose samples miss it. The product is as small as the share of the surface.
"""

from __future__ import annotations

import re

import numpy as np
from support import images

_PASS = re.compile(r"(.*(?:Diff|Gloss|Trans|Diffuse |Glossy |Transmission ))(?:Dir|Ind|Direct|Indirect)")


def color_name(name: str) -> str | None:
    """Returns the full name of the colour pass of a light pass, or None for another pass."""
    match = _PASS.fullmatch(name)
    if match is None:
        return None
    return match.group(1) + ("Color" if match.group(1).endswith(" ") else "Col")


def multiplied(passes: images.Passes, name: str) -> np.ndarray:
    """Returns a pass, times its colour pass if there is one."""
    color = passes.get(color_name(name) or "")
    return passes[name] if color is None else passes[name] * color
