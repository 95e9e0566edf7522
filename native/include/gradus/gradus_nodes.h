/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Gradus: operations of the node program (GradusMaterial). C99.
 *
 * Values
 *   - Every value has 4 floats. A float is spread over all of them; a vector or colour uses the first three.
 *   - A float operand reads the first component. So float -> vector needs no operation; colour -> float is GRADUS_OP_RGB_TO_BW,
 *     vector -> float GRADUS_OP_AVERAGE.
 *   - Inputs that a node does not give (input_count smaller than here) are 0. More than here are refused.
 *   - Normals and tangents: the zero vector stands for the surface's own.
 *   - Closures are no values: only MIX_SHADER, ADD_SHADER and `surface` take them, with output 0 of a closure operation.
 * Space
 *   - Positions and normals are in world space. Shading normals face the viewer, as in Cycles.
 * Meaning and formulas are those of the Cycles node of the same name, in Blender 3.4 to 5.0, unless said otherwise.
 *
 * GRADUS_OPS(X): X(name, value, inputs, outputs, is closure)
 */
#ifndef GRADUS_NODES_H
#define GRADUS_NODES_H

/* Closures. color is a weight for all of them.
 *   DIFFUSE       color, roughness (Oren-Nayar), normal                                 mode: 1 = energy conserving
 *   TRANSLUCENT   color, normal
 *   GLOSSY        color, roughness, anisotropy, rotation (turns), normal, tangent       mode: GradusDistribution
 *   REFRACTION    color, roughness, ior, normal
 *   GLASS         color, roughness, ior, normal                                         mode: GradusDistribution, + 2: as before 4.0
 *   SHEEN         color, roughness, normal                                              roughness 0: the grazing term of Velvet's kin
 *   TRANSPARENT   color
 *   HOLDOUT       -
 *   EMISSION      color, strength                                                       also Background
 *   MIX_SHADER    factor, closure, closure          factor is clamped to 0…1; 1 = the second
 *   ADD_SHADER    closure, closure
 *   PRINCIPLED    Blender 4.0 and later, without alpha (mix with TRANSPARENT):           mode: GradusDistribution
 *                 base color, metallic, roughness, ior, diffuse roughness, specular level, specular tint, anisotropic,
 *                 anisotropic rotation, transmission, coat weight, coat roughness, coat ior, coat tint, sheen weight,
 *                 sheen roughness, sheen tint, emission (colour times strength), normal, coat normal, tangent, thin film ignored
 *   PRINCIPLED_3  Blender before 4.0, without alpha and emission:                        mode: GradusDistribution
 *                 base color, diffuse color (base mixed with subsurface), metallic, specular, specular tint, roughness, anisotropic,
 *                 anisotropic rotation, sheen, sheen tint, clearcoat, clearcoat roughness, ior, transmission,
 *                 transmission roughness, normal, clearcoat normal, tangent
 *   METALLIC      base color, edge tint, roughness, anisotropy, rotation, normal, tangent  mode: GradusDistribution
 *
 * What is known at the point. A mode chooses the one output.
 *   GEOMETRY      -                                     mode: GradusGeometryMode
 *   TEX_COORD     -                                     mode: GradusTexCoordMode; resource: name of the UV map, 0 = default;
 *                                                       floats: 16, world to object (column-major), OBJECT with another object only
 *   TANGENT       -                                     mode: GradusTangentMode; resource: UV map
 *   ATTRIBUTE     - -> color, vector, factor, alpha     resource: name
 *   OBJECT_INFO   - -> location, color, index, random, alpha
 *   LIGHT_PATH    -                                     mode: GradusLightPathMode
 *   LAYER_WEIGHT  blend, normal -> fresnel, facing
 *   FRESNEL       ior, normal
 *   CAMERA_DATA   - -> view vector, z depth, distance
 *   NORMAL_MAP    strength, color                       mode: GradusNormalSpace; resource: UV map
 *   BUMP          strength, distance, height, normal, filter width   mode: 1 = invert. height is evaluated at three points.
 *
 * Textures
 *   IMAGE         vector -> color, alpha                mode: GRADUS_IMAGE_MODE(); floats: blend of BOX; resource: image key
 *   ENVIRONMENT   vector -> color                       mode: GRADUS_IMAGE_MODE() with projection 0 = equirectangular, 1 = mirror ball
 *   NOISE         vector, w, scale, detail, roughness, lacunarity, offset, gain, distortion -> factor, color
 *                                                       mode: GRADUS_NOISE_MODE()
 *   CHECKER       vector, color1, color2, scale -> color, factor
 *   GRADIENT      vector                                mode: GradusGradientMode
 *   WHITE_NOISE   vector, w -> value, color             mode: dimensions 1…4
 *   WAVE          vector, scale, distortion, detail, detail scale, detail roughness, phase    mode: GRADUS_WAVE_MODE()
 *   MAGIC         vector, scale, distortion -> color, factor     mode: depth
 *   BRICK         vector, color1, color2, mortar, scale, mortar size, mortar smooth, bias, brick width, row height -> color, factor
 *                                                       floats: offset, offset frequency, squash, squash frequency
 *   SKY           vector                                mode: GradusSkyMode; floats: PREETHAM and HOSEK_WILKIE: sun direction (3),
 *                                                       turbidity, ground albedo; others: sun elevation, sun rotation, sun size (negative:
 *                                                       no disc), sun intensity, altitude (m), air, dust or aerosols, ozone
 *
 * Vectors, colours, numbers
 *   MAPPING       vector, location, rotation, scale     mode: GradusMappingMode
 *   VECTOR_TRANSFORM vector                             mode: GradusTransformKind + 4·from + 16·to, spaces: 0 world, 1 object, 2 camera
 *   VECTOR_ROTATE vector, center, axis, angle, rotation mode: 0 axis, 1–3 x y z, 4 Euler; + 8: inverse
 *   MIX           factor, a, b                          componentwise a + factor (b − a)
 *   MIX_COLOR     factor, a, b                          mode: GradusBlend, + 32: clamp the result
 *   MATH          a, b, c                               mode: GradusMath, + 64: clamp the result to 0…1
 *   VECTOR_MATH   a, b, c, scale -> vector, value       mode: GradusVectorMath
 *   CLAMP         value, min, max                       mode: 0 min max, 1 range (swapped where min > max); componentwise
 *   MAP_RANGE     value, from min, from max, to min, to max, steps    mode: GradusMapRange, + 8: clamp, + 16: of vectors; componentwise
 *   RAMP          factor -> color, alpha                mode: 1 = no interpolation; floats: RGBA at even steps over 0…1
 *   CURVES        factor, value                         mode: GradusCurves; floats: min x, max x, extrapolate, then rows of mode's channels
 *   SEPARATE      color -> 3 floats                     mode: GradusColorModel
 *   COMBINE       3 floats                              mode: GradusColorModel
 *   HUE_SATURATION hue, saturation, value, factor, color
 *   GAMMA         color, gamma
 *   INVERT        factor, color
 *   BRIGHT_CONTRAST color, bright, contrast
 *   RGB_TO_BW     color
 *   AVERAGE       vector
 *   BLACKBODY     temperature
 *   LIGHT_FALLOFF strength, smooth                      mode: 0 quadratic, 1 linear, 2 constant
 *   NORMAL_DOT    vector -> vector, dot                 floats: 3, the node's direction
 */
#define GRADUS_OPS(X)              \
  X(DIFFUSE, 0, 3, 1, 1)           \
  X(TRANSLUCENT, 1, 2, 1, 1)       \
  X(GLOSSY, 2, 6, 1, 1)            \
  X(REFRACTION, 3, 4, 1, 1)        \
  X(GLASS, 4, 4, 1, 1)             \
  X(SHEEN, 5, 3, 1, 1)             \
  X(TRANSPARENT, 6, 1, 1, 1)       \
  X(HOLDOUT, 7, 0, 1, 1)           \
  X(EMISSION, 8, 2, 1, 1)          \
  X(MIX_SHADER, 9, 3, 1, 1)        \
  X(ADD_SHADER, 10, 2, 1, 1)       \
  X(PRINCIPLED, 11, 21, 1, 1)      \
  X(PRINCIPLED_3, 12, 18, 1, 1)    \
  X(METALLIC, 13, 7, 1, 1)         \
  X(GEOMETRY, 32, 0, 1, 0)         \
  X(TEX_COORD, 33, 0, 1, 0)        \
  X(TANGENT, 34, 0, 1, 0)          \
  X(ATTRIBUTE, 35, 0, 4, 0)        \
  X(OBJECT_INFO, 36, 0, 5, 0)      \
  X(LIGHT_PATH, 37, 0, 1, 0)       \
  X(LAYER_WEIGHT, 38, 2, 2, 0)     \
  X(FRESNEL, 39, 2, 1, 0)          \
  X(CAMERA_DATA, 40, 0, 3, 0)      \
  X(NORMAL_MAP, 41, 2, 1, 0)       \
  X(BUMP, 42, 5, 1, 0)             \
  X(IMAGE, 64, 1, 2, 0)            \
  X(ENVIRONMENT, 65, 1, 1, 0)      \
  X(NOISE, 66, 9, 2, 0)            \
  X(CHECKER, 67, 4, 2, 0)          \
  X(GRADIENT, 68, 1, 1, 0)         \
  X(WHITE_NOISE, 69, 2, 2, 0)      \
  X(WAVE, 70, 7, 1, 0)             \
  X(MAGIC, 71, 3, 2, 0)            \
  X(BRICK, 72, 10, 2, 0)           \
  X(SKY, 73, 1, 1, 0)              \
  X(MAPPING, 96, 4, 1, 0)          \
  X(VECTOR_TRANSFORM, 97, 1, 1, 0) \
  X(VECTOR_ROTATE, 98, 5, 1, 0)    \
  X(MIX, 99, 3, 1, 0)              \
  X(MIX_COLOR, 100, 3, 1, 0)       \
  X(MATH, 101, 3, 1, 0)            \
  X(VECTOR_MATH, 102, 4, 2, 0)     \
  X(CLAMP, 103, 3, 1, 0)           \
  X(MAP_RANGE, 104, 6, 1, 0)       \
  X(RAMP, 105, 1, 2, 0)            \
  X(CURVES, 106, 2, 1, 0)          \
  X(SEPARATE, 107, 1, 3, 0)        \
  X(COMBINE, 108, 3, 1, 0)         \
  X(HUE_SATURATION, 109, 5, 1, 0)  \
  X(GAMMA, 110, 2, 1, 0)           \
  X(INVERT, 111, 2, 1, 0)          \
  X(BRIGHT_CONTRAST, 112, 3, 1, 0) \
  X(RGB_TO_BW, 113, 1, 1, 0)       \
  X(AVERAGE, 114, 1, 1, 0)         \
  X(BLACKBODY, 115, 1, 1, 0)       \
  X(LIGHT_FALLOFF, 116, 2, 1, 0)   \
  X(NORMAL_DOT, 117, 1, 2, 0)

#define GRADUS_OP_ENUM(name, value, inputs, outputs, closure) GRADUS_OP_##name = value, /* NOLINT(bugprone-macro-parentheses) */
typedef enum GradusOp { GRADUS_OPS(GRADUS_OP_ENUM) GRADUS_OP_LIMIT = 128 } GradusOp;
#undef GRADUS_OP_ENUM

typedef enum GradusDistribution {
  GRADUS_DISTRIBUTION_SINGLE = 0, /* GGX, single scattering; also what stands for Beckmann and Ashikhmin-Shirley */
  GRADUS_DISTRIBUTION_MULTIPLE = 1
} GradusDistribution;

typedef enum GradusGeometryMode {
  GRADUS_GEOMETRY_POSITION = 0,
  GRADUS_GEOMETRY_NORMAL = 1,
  GRADUS_GEOMETRY_TANGENT = 2,
  GRADUS_GEOMETRY_TRUE_NORMAL = 3,
  GRADUS_GEOMETRY_INCOMING = 4,
  GRADUS_GEOMETRY_PARAMETRIC = 5,
  GRADUS_GEOMETRY_BACKFACING = 6
} GradusGeometryMode;

typedef enum GradusTexCoordMode {
  GRADUS_TEX_COORD_GENERATED = 0,
  GRADUS_TEX_COORD_NORMAL = 1,
  GRADUS_TEX_COORD_UV = 2,
  GRADUS_TEX_COORD_OBJECT = 3,
  GRADUS_TEX_COORD_CAMERA = 4,
  GRADUS_TEX_COORD_WINDOW = 5,
  GRADUS_TEX_COORD_REFLECTION = 6,
  GRADUS_TEX_COORD_INSTANCER_GENERATED = 7,
  GRADUS_TEX_COORD_INSTANCER_UV = 8
} GradusTexCoordMode;

typedef enum GradusTangentMode {
  GRADUS_TANGENT_RADIAL_X = 0,
  GRADUS_TANGENT_RADIAL_Y = 1,
  GRADUS_TANGENT_RADIAL_Z = 2,
  GRADUS_TANGENT_UV = 3
} GradusTangentMode;

typedef enum GradusLightPathMode {
  GRADUS_LIGHT_PATH_CAMERA = 0,
  GRADUS_LIGHT_PATH_SHADOW = 1,
  GRADUS_LIGHT_PATH_DIFFUSE = 2,
  GRADUS_LIGHT_PATH_GLOSSY = 3,
  GRADUS_LIGHT_PATH_SINGULAR = 4,
  GRADUS_LIGHT_PATH_REFLECTION = 5,
  GRADUS_LIGHT_PATH_TRANSMISSION = 6,
  GRADUS_LIGHT_PATH_LENGTH = 7,
  GRADUS_LIGHT_PATH_DEPTH = 8,
  GRADUS_LIGHT_PATH_DIFFUSE_DEPTH = 9,
  GRADUS_LIGHT_PATH_GLOSSY_DEPTH = 10,
  GRADUS_LIGHT_PATH_TRANSPARENT_DEPTH = 11,
  GRADUS_LIGHT_PATH_TRANSMISSION_DEPTH = 12
} GradusLightPathMode;

typedef enum GradusNormalSpace {
  GRADUS_NORMAL_TANGENT = 0,
  GRADUS_NORMAL_OBJECT = 1,
  GRADUS_NORMAL_WORLD = 2,
  GRADUS_NORMAL_BLENDER_OBJECT = 3, /* y and z inverted */
  GRADUS_NORMAL_BLENDER_WORLD = 4
} GradusNormalSpace;

typedef enum GradusProjection {
  GRADUS_PROJECTION_FLAT = 0,
  GRADUS_PROJECTION_BOX = 1,
  GRADUS_PROJECTION_SPHERE = 2,
  GRADUS_PROJECTION_TUBE = 3
} GradusProjection;
/* interpolation: 0 linear, 1 closest, 2 cubic; extension: 0 repeat, 1 extend, 2 clip, 3 mirror; unassociate: divide colour by alpha */
#define GRADUS_IMAGE_MODE(projection, interpolation, extension, unassociate) \
  ((projection) | (interpolation) << 2 | (extension) << 4 | (unassociate) << 6)

typedef enum GradusNoiseType {
  GRADUS_NOISE_FBM = 0,
  GRADUS_NOISE_MULTIFRACTAL = 1,
  GRADUS_NOISE_HYBRID_MULTIFRACTAL = 2,
  GRADUS_NOISE_RIDGED_MULTIFRACTAL = 3,
  GRADUS_NOISE_HETERO_TERRAIN = 4
} GradusNoiseType;
/* dimensions 1…4; normalize: 0…1; legacy: octaves and distortion as before Blender 4.1 */
#define GRADUS_NOISE_MODE(dimensions, type, normalize, legacy) ((dimensions) | (type) << 3 | (normalize) << 6 | (legacy) << 7)

typedef enum GradusGradientMode {
  GRADUS_GRADIENT_LINEAR = 0,
  GRADUS_GRADIENT_QUADRATIC = 1,
  GRADUS_GRADIENT_EASING = 2,
  GRADUS_GRADIENT_DIAGONAL = 3,
  GRADUS_GRADIENT_RADIAL = 4,
  GRADUS_GRADIENT_QUADRATIC_SPHERE = 5,
  GRADUS_GRADIENT_SPHERICAL = 6
} GradusGradientMode;

/* type: 0 bands, 1 rings; direction: 0–2 x y z, 3 diagonal or spherical; profile: 0 sine, 1 saw, 2 triangle */
#define GRADUS_WAVE_MODE(type, direction, profile) ((type) | (direction) << 1 | (profile) << 3)

typedef enum GradusSkyMode {
  GRADUS_SKY_PREETHAM = 0,
  GRADUS_SKY_HOSEK_WILKIE = 1,
  GRADUS_SKY_NISHITA = 2, /* Blender before 5.0 */
  GRADUS_SKY_SINGLE_SCATTERING = 3,
  GRADUS_SKY_MULTIPLE_SCATTERING = 4
} GradusSkyMode;

typedef enum GradusMappingMode {
  GRADUS_MAPPING_POINT = 0,
  GRADUS_MAPPING_TEXTURE = 1,
  GRADUS_MAPPING_VECTOR = 2,
  GRADUS_MAPPING_NORMAL = 3
} GradusMappingMode;

typedef enum GradusTransformKind {
  GRADUS_TRANSFORM_VECTOR = 0,
  GRADUS_TRANSFORM_POINT = 1,
  GRADUS_TRANSFORM_NORMAL = 2
} GradusTransformKind;

typedef enum GradusBlend {
  GRADUS_BLEND_MIX = 0,
  GRADUS_BLEND_DARKEN = 1,
  GRADUS_BLEND_MULTIPLY = 2,
  GRADUS_BLEND_BURN = 3,
  GRADUS_BLEND_LIGHTEN = 4,
  GRADUS_BLEND_SCREEN = 5,
  GRADUS_BLEND_DODGE = 6,
  GRADUS_BLEND_ADD = 7,
  GRADUS_BLEND_OVERLAY = 8,
  GRADUS_BLEND_SOFT_LIGHT = 9,
  GRADUS_BLEND_LINEAR_LIGHT = 10,
  GRADUS_BLEND_DIFFERENCE = 11,
  GRADUS_BLEND_EXCLUSION = 12,
  GRADUS_BLEND_SUBTRACT = 13,
  GRADUS_BLEND_DIVIDE = 14,
  GRADUS_BLEND_HUE = 15,
  GRADUS_BLEND_SATURATION = 16,
  GRADUS_BLEND_COLOR = 17,
  GRADUS_BLEND_VALUE = 18
} GradusBlend;

typedef enum GradusMath {
  GRADUS_MATH_ADD = 0,
  GRADUS_MATH_SUBTRACT,
  GRADUS_MATH_MULTIPLY,
  GRADUS_MATH_DIVIDE,
  GRADUS_MATH_MULTIPLY_ADD,
  GRADUS_MATH_POWER,
  GRADUS_MATH_LOGARITHM,
  GRADUS_MATH_SQRT,
  GRADUS_MATH_INVERSE_SQRT,
  GRADUS_MATH_ABSOLUTE,
  GRADUS_MATH_EXPONENT,
  GRADUS_MATH_MINIMUM,
  GRADUS_MATH_MAXIMUM,
  GRADUS_MATH_LESS_THAN,
  GRADUS_MATH_GREATER_THAN,
  GRADUS_MATH_SIGN,
  GRADUS_MATH_COMPARE,
  GRADUS_MATH_SMOOTH_MIN,
  GRADUS_MATH_SMOOTH_MAX,
  GRADUS_MATH_ROUND,
  GRADUS_MATH_FLOOR,
  GRADUS_MATH_CEIL,
  GRADUS_MATH_TRUNC,
  GRADUS_MATH_FRACT,
  GRADUS_MATH_MODULO,
  GRADUS_MATH_FLOORED_MODULO,
  GRADUS_MATH_WRAP,
  GRADUS_MATH_SNAP,
  GRADUS_MATH_PINGPONG,
  GRADUS_MATH_SINE,
  GRADUS_MATH_COSINE,
  GRADUS_MATH_TANGENT,
  GRADUS_MATH_ARCSINE,
  GRADUS_MATH_ARCCOSINE,
  GRADUS_MATH_ARCTANGENT,
  GRADUS_MATH_ARCTAN2,
  GRADUS_MATH_SINH,
  GRADUS_MATH_COSH,
  GRADUS_MATH_TANH,
  GRADUS_MATH_RADIANS,
  GRADUS_MATH_DEGREES,
  GRADUS_MATH_COUNT
} GradusMath;

typedef enum GradusVectorMath {
  GRADUS_VECTOR_ADD = 0,
  GRADUS_VECTOR_SUBTRACT,
  GRADUS_VECTOR_MULTIPLY,
  GRADUS_VECTOR_DIVIDE,
  GRADUS_VECTOR_MULTIPLY_ADD,
  GRADUS_VECTOR_CROSS_PRODUCT,
  GRADUS_VECTOR_PROJECT,
  GRADUS_VECTOR_REFLECT,
  GRADUS_VECTOR_REFRACT,
  GRADUS_VECTOR_FACEFORWARD,
  GRADUS_VECTOR_DOT_PRODUCT,
  GRADUS_VECTOR_DISTANCE,
  GRADUS_VECTOR_LENGTH,
  GRADUS_VECTOR_SCALE,
  GRADUS_VECTOR_NORMALIZE,
  GRADUS_VECTOR_ABSOLUTE,
  GRADUS_VECTOR_POWER,
  GRADUS_VECTOR_SIGN,
  GRADUS_VECTOR_MINIMUM,
  GRADUS_VECTOR_MAXIMUM,
  GRADUS_VECTOR_ROUND,
  GRADUS_VECTOR_FLOOR,
  GRADUS_VECTOR_CEIL,
  GRADUS_VECTOR_FRACTION,
  GRADUS_VECTOR_MODULO,
  GRADUS_VECTOR_WRAP,
  GRADUS_VECTOR_SNAP,
  GRADUS_VECTOR_SINE,
  GRADUS_VECTOR_COSINE,
  GRADUS_VECTOR_TANGENT,
  GRADUS_VECTOR_COUNT
} GradusVectorMath;

typedef enum GradusMapRange {
  GRADUS_MAP_RANGE_LINEAR = 0,
  GRADUS_MAP_RANGE_STEPPED = 1,
  GRADUS_MAP_RANGE_SMOOTHSTEP = 2,
  GRADUS_MAP_RANGE_SMOOTHERSTEP = 3
} GradusMapRange;

/* RGB and VECTOR: rows of 3; VECTOR maps -1…1 like any other range; FLOAT: rows of 1. */
typedef enum GradusCurves { GRADUS_CURVES_RGB = 0, GRADUS_CURVES_VECTOR = 1, GRADUS_CURVES_FLOAT = 2 } GradusCurves;

typedef enum GradusColorModel { GRADUS_COLOR_RGB = 0, GRADUS_COLOR_HSV = 1, GRADUS_COLOR_HSL = 2 } GradusColorModel;

#endif
