"""Translation of Blender's shader graphs to native node programs.

program = nodes.translate(material, "SURFACE", resources) struct, keep_alive = program.to_native(native)

`resources` has image(image, image_user) -> key, and text(path, owner) -> the content of a text file or None.
program.warnings has one warning for each replaced node, with its name and its material.
"""

from __future__ import annotations

from . import (  # noqa: F401  (importing them registers their translators)
    colors,
    displacement,
    inputs,
    normals,
    numbers,
    principled,
    shaders,
    tables,
    textures,
    vectors,
)
from .principled import default_surface
from .program import Program
from .translate import translate

__all__ = ["Program", "default_surface", "translate"]
