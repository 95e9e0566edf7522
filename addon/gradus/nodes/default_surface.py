"""What surfaces without a material are made of: until Blender 5.0 Cycles' grey diffuse, from then on an untouched Principled BSDF."""

from __future__ import annotations

from .ops import Op
from .program import NO_NORMAL, Program, constant_color, constant_float
from .shaders import MULTIPLE_SCATTERING

_WHITE, _NONE = constant_color((1.0, 1.0, 1.0)), constant_float(0.0)
_INPUTS = (
    constant_color((0.8, 0.8, 0.8)),  # base colour
    _NONE,  # metallic
    constant_float(0.5),  # roughness
    constant_float(1.5),  # IOR
    _NONE,  # diffuse roughness
    constant_float(0.5),  # specular IOR level
    _WHITE,  # specular tint
    _NONE,  # anisotropic
    _NONE,  # anisotropic rotation
    _NONE,  # transmission
    _NONE,  # coat
    constant_float(0.03),  # coat roughness
    constant_float(1.5),  # coat IOR
    _WHITE,  # coat tint
    _NONE,  # sheen
    constant_float(0.5),  # sheen roughness
    _WHITE,  # sheen tint
    _NONE,  # emission
    NO_NORMAL,
    NO_NORMAL,  # of the coat
    NO_NORMAL,  # tangent
)


def default_surface() -> Program:
    """The program from Blender 5.0 on; before, it is the library's own (key 0)."""
    program = Program(name="Default Surface")
    program.surface = program.add(Op.PRINCIPLED, _INPUTS, MULTIPLE_SCATTERING)
    return program
