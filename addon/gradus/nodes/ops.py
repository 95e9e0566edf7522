"""Operations of gradus_nodes.h and their modes. Written by tools/nodes/generate_ops.py; a test compares both."""

from __future__ import annotations

from enum import IntEnum


class Op(IntEnum):
    DIFFUSE = 0
    TRANSLUCENT = 1
    GLOSSY = 2
    REFRACTION = 3
    GLASS = 4
    SHEEN = 5
    TRANSPARENT = 6
    HOLDOUT = 7
    EMISSION = 8
    MIX_SHADER = 9
    ADD_SHADER = 10
    PRINCIPLED = 11
    PRINCIPLED_3 = 12
    METALLIC = 13
    GEOMETRY = 32
    TEX_COORD = 33
    TANGENT = 34
    ATTRIBUTE = 35
    OBJECT_INFO = 36
    LIGHT_PATH = 37
    LAYER_WEIGHT = 38
    FRESNEL = 39
    CAMERA_DATA = 40
    NORMAL_MAP = 41
    BUMP = 42
    IMAGE = 64
    ENVIRONMENT = 65
    NOISE = 66
    CHECKER = 67
    GRADIENT = 68
    WHITE_NOISE = 69
    WAVE = 70
    MAGIC = 71
    BRICK = 72
    SKY = 73
    MAPPING = 96
    VECTOR_TRANSFORM = 97
    VECTOR_ROTATE = 98
    MIX = 99
    MIX_COLOR = 100
    MATH = 101
    VECTOR_MATH = 102
    CLAMP = 103
    MAP_RANGE = 104
    RAMP = 105
    CURVES = 106
    SEPARATE = 107
    COMBINE = 108
    HUE_SATURATION = 109
    GAMMA = 110
    INVERT = 111
    BRIGHT_CONTRAST = 112
    RGB_TO_BW = 113
    AVERAGE = 114
    BLACKBODY = 115
    LIGHT_FALLOFF = 116
    NORMAL_DOT = 117


class Geometry(IntEnum):
    POSITION = 0
    NORMAL = 1
    TANGENT = 2
    TRUE_NORMAL = 3
    INCOMING = 4
    PARAMETRIC = 5
    BACKFACING = 6


class TexCoord(IntEnum):
    GENERATED = 0
    NORMAL = 1
    UV = 2
    OBJECT = 3
    CAMERA = 4
    WINDOW = 5
    REFLECTION = 6
    INSTANCER_GENERATED = 7
    INSTANCER_UV = 8


class Tangent(IntEnum):
    RADIAL_X = 0
    RADIAL_Y = 1
    RADIAL_Z = 2
    UV = 3


class LightPath(IntEnum):
    CAMERA = 0
    SHADOW = 1
    DIFFUSE = 2
    GLOSSY = 3
    SINGULAR = 4
    REFLECTION = 5
    TRANSMISSION = 6
    LENGTH = 7
    DEPTH = 8
    DIFFUSE_DEPTH = 9
    GLOSSY_DEPTH = 10
    TRANSPARENT_DEPTH = 11
    TRANSMISSION_DEPTH = 12


class NormalSpace(IntEnum):
    TANGENT = 0
    OBJECT = 1
    WORLD = 2
    BLENDER_OBJECT = 3
    BLENDER_WORLD = 4


class Projection(IntEnum):
    FLAT = 0
    BOX = 1
    SPHERE = 2
    TUBE = 3


class NoiseType(IntEnum):
    FBM = 0
    MULTIFRACTAL = 1
    HYBRID_MULTIFRACTAL = 2
    RIDGED_MULTIFRACTAL = 3
    HETERO_TERRAIN = 4


class Gradient(IntEnum):
    LINEAR = 0
    QUADRATIC = 1
    EASING = 2
    DIAGONAL = 3
    RADIAL = 4
    QUADRATIC_SPHERE = 5
    SPHERICAL = 6


class Sky(IntEnum):
    PREETHAM = 0
    HOSEK_WILKIE = 1
    NISHITA = 2
    SINGLE_SCATTERING = 3
    MULTIPLE_SCATTERING = 4


class Mapping(IntEnum):
    POINT = 0
    TEXTURE = 1
    VECTOR = 2
    NORMAL = 3


class Blend(IntEnum):
    MIX = 0
    DARKEN = 1
    MULTIPLY = 2
    BURN = 3
    LIGHTEN = 4
    SCREEN = 5
    DODGE = 6
    ADD = 7
    OVERLAY = 8
    SOFT_LIGHT = 9
    LINEAR_LIGHT = 10
    DIFFERENCE = 11
    EXCLUSION = 12
    SUBTRACT = 13
    DIVIDE = 14
    HUE = 15
    SATURATION = 16
    COLOR = 17
    VALUE = 18


class Math(IntEnum):
    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    MULTIPLY_ADD = 4
    POWER = 5
    LOGARITHM = 6
    SQRT = 7
    INVERSE_SQRT = 8
    ABSOLUTE = 9
    EXPONENT = 10
    MINIMUM = 11
    MAXIMUM = 12
    LESS_THAN = 13
    GREATER_THAN = 14
    SIGN = 15
    COMPARE = 16
    SMOOTH_MIN = 17
    SMOOTH_MAX = 18
    ROUND = 19
    FLOOR = 20
    CEIL = 21
    TRUNC = 22
    FRACT = 23
    MODULO = 24
    FLOORED_MODULO = 25
    WRAP = 26
    SNAP = 27
    PINGPONG = 28
    SINE = 29
    COSINE = 30
    TANGENT = 31
    ARCSINE = 32
    ARCCOSINE = 33
    ARCTANGENT = 34
    ARCTAN2 = 35
    SINH = 36
    COSH = 37
    TANH = 38
    RADIANS = 39
    DEGREES = 40


class VectorMath(IntEnum):
    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    MULTIPLY_ADD = 4
    CROSS_PRODUCT = 5
    PROJECT = 6
    REFLECT = 7
    REFRACT = 8
    FACEFORWARD = 9
    DOT_PRODUCT = 10
    DISTANCE = 11
    LENGTH = 12
    SCALE = 13
    NORMALIZE = 14
    ABSOLUTE = 15
    POWER = 16
    SIGN = 17
    MINIMUM = 18
    MAXIMUM = 19
    ROUND = 20
    FLOOR = 21
    CEIL = 22
    FRACTION = 23
    MODULO = 24
    WRAP = 25
    SNAP = 26
    SINE = 27
    COSINE = 28
    TANGENT = 29


class MapRange(IntEnum):
    LINEAR = 0
    STEPPED = 1
    SMOOTHSTEP = 2
    SMOOTHERSTEP = 3


class Curves(IntEnum):
    RGB = 0
    VECTOR = 1
    FLOAT = 2


class ColorModel(IntEnum):
    RGB = 0
    HSV = 1
    HSL = 2


INPUTS = {
    Op.DIFFUSE: 3,
    Op.TRANSLUCENT: 2,
    Op.GLOSSY: 6,
    Op.REFRACTION: 4,
    Op.GLASS: 4,
    Op.SHEEN: 3,
    Op.TRANSPARENT: 1,
    Op.HOLDOUT: 0,
    Op.EMISSION: 2,
    Op.MIX_SHADER: 3,
    Op.ADD_SHADER: 2,
    Op.PRINCIPLED: 21,
    Op.PRINCIPLED_3: 18,
    Op.METALLIC: 7,
    Op.GEOMETRY: 0,
    Op.TEX_COORD: 0,
    Op.TANGENT: 0,
    Op.ATTRIBUTE: 0,
    Op.OBJECT_INFO: 0,
    Op.LIGHT_PATH: 0,
    Op.LAYER_WEIGHT: 2,
    Op.FRESNEL: 2,
    Op.CAMERA_DATA: 0,
    Op.NORMAL_MAP: 2,
    Op.BUMP: 5,
    Op.IMAGE: 1,
    Op.ENVIRONMENT: 1,
    Op.NOISE: 9,
    Op.CHECKER: 4,
    Op.GRADIENT: 1,
    Op.WHITE_NOISE: 2,
    Op.WAVE: 7,
    Op.MAGIC: 3,
    Op.BRICK: 10,
    Op.SKY: 1,
    Op.MAPPING: 4,
    Op.VECTOR_TRANSFORM: 1,
    Op.VECTOR_ROTATE: 5,
    Op.MIX: 3,
    Op.MIX_COLOR: 3,
    Op.MATH: 3,
    Op.VECTOR_MATH: 4,
    Op.CLAMP: 3,
    Op.MAP_RANGE: 6,
    Op.RAMP: 1,
    Op.CURVES: 2,
    Op.SEPARATE: 1,
    Op.COMBINE: 3,
    Op.HUE_SATURATION: 5,
    Op.GAMMA: 2,
    Op.INVERT: 2,
    Op.BRIGHT_CONTRAST: 3,
    Op.RGB_TO_BW: 1,
    Op.AVERAGE: 1,
    Op.BLACKBODY: 1,
    Op.LIGHT_FALLOFF: 2,
    Op.NORMAL_DOT: 1,
}
"""Number of inputs."""

OUTPUTS = {
    Op.DIFFUSE: 1,
    Op.TRANSLUCENT: 1,
    Op.GLOSSY: 1,
    Op.REFRACTION: 1,
    Op.GLASS: 1,
    Op.SHEEN: 1,
    Op.TRANSPARENT: 1,
    Op.HOLDOUT: 1,
    Op.EMISSION: 1,
    Op.MIX_SHADER: 1,
    Op.ADD_SHADER: 1,
    Op.PRINCIPLED: 1,
    Op.PRINCIPLED_3: 1,
    Op.METALLIC: 1,
    Op.GEOMETRY: 1,
    Op.TEX_COORD: 1,
    Op.TANGENT: 1,
    Op.ATTRIBUTE: 4,
    Op.OBJECT_INFO: 5,
    Op.LIGHT_PATH: 1,
    Op.LAYER_WEIGHT: 2,
    Op.FRESNEL: 1,
    Op.CAMERA_DATA: 3,
    Op.NORMAL_MAP: 1,
    Op.BUMP: 1,
    Op.IMAGE: 2,
    Op.ENVIRONMENT: 1,
    Op.NOISE: 2,
    Op.CHECKER: 2,
    Op.GRADIENT: 1,
    Op.WHITE_NOISE: 2,
    Op.WAVE: 1,
    Op.MAGIC: 2,
    Op.BRICK: 2,
    Op.SKY: 1,
    Op.MAPPING: 1,
    Op.VECTOR_TRANSFORM: 1,
    Op.VECTOR_ROTATE: 1,
    Op.MIX: 1,
    Op.MIX_COLOR: 1,
    Op.MATH: 1,
    Op.VECTOR_MATH: 2,
    Op.CLAMP: 1,
    Op.MAP_RANGE: 1,
    Op.RAMP: 2,
    Op.CURVES: 1,
    Op.SEPARATE: 3,
    Op.COMBINE: 1,
    Op.HUE_SATURATION: 1,
    Op.GAMMA: 1,
    Op.INVERT: 1,
    Op.BRIGHT_CONTRAST: 1,
    Op.RGB_TO_BW: 1,
    Op.AVERAGE: 1,
    Op.BLACKBODY: 1,
    Op.LIGHT_FALLOFF: 1,
    Op.NORMAL_DOT: 2,
}
"""Number of outputs."""
