"""Shader graphs of Blender as native node programs.

    program = nodes.translate(material, "SURFACE", resources)
    struct, keep_alive = program.to_native(native)

`resources` has image(image, image_user) -> key. Warnings are in program.warnings, one per replaced node, naming material and node.
"""

from __future__ import annotations

from . import (  # noqa: F401  (they register themselves)
    colors,
    inputs,
    normals,
    numbers,
    principled,
    shaders,
    sky,
    tables,
    textures,
    vectors,
)
from .default_surface import default_surface
from .program import Program
from .translate import translate

__all__ = ["Program", "default_surface", "translate"]
