"""Image and procedural textures."""

from __future__ import annotations

from typing import Any

from .. import compat
from . import ies_profile, working_space
from .node import NodeView, translator
from .ops import (
    Geometry,
    Gradient,
    Mapping,
    Math,
    NoiseType,
    Op,
    Projection,
    Sky,
    TexCoord,
    TransformKind,
    VoronoiFeature,
    VoronoiForm,
    VoronoiMetric,
)
from .program import COLOR, FLOAT, VECTOR, Value, constant_float, constant_vector

_INTERPOLATION = {"Linear": 0, "Closest": 1, "Cubic": 2, "Smart": 2}
_EXTENSION = {"REPEAT": 0, "EXTEND": 1, "CLIP": 2, "MIRROR": 3}
_PROJECTION = {"FLAT": Projection.FLAT, "BOX": Projection.BOX, "SPHERE": Projection.SPHERE, "TUBE": Projection.TUBE}
_NO_DISC = -1.0


def _mapped(view: NodeView, vector: Value) -> Value:
    """Applies the texture mapping of a node, which has no sockets and is set by scripts and old files."""
    mapping = getattr(view.node, "texture_mapping", None)
    if mapping is None:
        return vector
    vector = _with_axes(view, vector, (mapping.mapping_x, mapping.mapping_y, mapping.mapping_z))
    location, rotation, scale = tuple(mapping.translation), tuple(mapping.rotation), tuple(mapping.scale)
    if not any(location) and not any(rotation) and scale == (1.0, 1.0, 1.0):
        return vector
    inputs = (vector, constant_vector(location), constant_vector(rotation), constant_vector(scale))
    return view.add_vector(Op.MAPPING, inputs, Mapping[mapping.vector_type])


def _with_axes(view: NodeView, vector: Value, axes: tuple[str, str, str]) -> Value:
    """Returns a vector of the named components of another one: X, Y, Z, or NONE for 0."""
    if axes == ("X", "Y", "Z"):
        return vector
    parts = view.program.add(Op.SEPARATE, (vector,))
    by_name = {axis: Value(FLOAT, node=parts, output=index) for index, axis in enumerate("XYZ")}
    return view.add_vector(Op.COMBINE, tuple(by_name.get(axis, constant_float(0.0)) for axis in axes))


def coordinates(view: NodeView, default: TexCoord) -> Value:
    """Returns what is linked to Vector, or the default coordinates of the texture."""
    linked = view.linked("Vector")
    return _mapped(view, view.add_vector(Op.TEX_COORD, (), default) if linked is None else linked)


def _generated(view: NodeView) -> Value:
    return coordinates(view, TexCoord.GENERATED)


def _divides_by_alpha(view: NodeView, image: object) -> bool:
    """Returns whether colours are divided by alpha: if the Alpha output is used, as in Cycles."""
    if image is None or image.alpha_mode in {"CHANNEL_PACKED", "NONE"} or compat.is_data(image.colorspace_settings):
        return False
    return view.node.outputs["Alpha"].is_linked


@translator("ShaderNodeTexImage")
def image_texture(view: NodeView) -> Value:
    node, image = view.node, view.node.image
    is_boxed = node.projection == "BOX"
    key = view.walker.resources.image(image, node.image_user, is_boxed) if image is not None else 0
    mode = _PROJECTION[node.projection] | _INTERPOLATION[node.interpolation] << 2
    mode |= _EXTENSION.get(node.extension, 0) << 4
    mode |= _divides_by_alpha(view, image) << 6
    floats = (float(node.projection_blend),) if is_boxed else ()
    vector = coordinates(view, TexCoord.UV)
    kind, output = (FLOAT, 1) if view.output == "Alpha" else (COLOR, 0)
    return view.add(Op.IMAGE, (vector,), mode, floats, key, kind=kind, output=output)


@translator("ShaderNodeTexEnvironment")
def environment_texture(view: NodeView) -> Value:
    node = view.node
    key = view.walker.resources.image(node.image, node.image_user) if node.image is not None else 0
    linked = view.linked("Vector")
    vector = _mapped(view, view.add_vector(Op.GEOMETRY) if linked is None else linked)
    mode = (1 if node.projection == "MIRROR_BALL" else 0) | _INTERPOLATION[node.interpolation] << 2
    return view.add(Op.ENVIRONMENT, (vector,), mode, resource=key)


def _color_or_factor(
    view: NodeView, op: Op, inputs: tuple[Value, ...], mode: int = 0, floats: tuple[float, ...] = ()
) -> Value:
    """Adds a pattern, whose output 0 is the colour and whose output 1 is the factor."""
    factor = view.output == "Fac"
    return view.add(op, inputs, mode, floats, kind=FLOAT if factor else COLOR, output=1 if factor else 0)


@translator("ShaderNodeTexNoise")
def noise(view: NodeView) -> Value:
    node = view.node
    legacy = not view.has("Lacunarity")
    kind = NoiseType[getattr(node, "noise_type", "FBM")]
    mode = int(node.noise_dimensions[0]) | kind << 3 | bool(getattr(node, "normalize", True)) << 6 | legacy << 7
    inputs = (
        _generated(view),
        view.value("W"),
        view.value("Scale"),
        view.value("Detail"),
        view.value("Roughness"),
        view.value("Lacunarity", default=2.0),
        view.value("Offset"),
        view.value("Gain"),
        view.value("Distortion"),
    )
    factor = view.output == "Fac"
    return view.add(Op.NOISE, inputs, mode, kind=FLOAT if factor else COLOR, output=0 if factor else 1)


@translator("ShaderNodeTexMusgrave")
def musgrave(view: NodeView) -> Value:
    node = view.node
    names = ("W", "Scale", "Detail", "Dimension", "Lacunarity", "Offset", "Gain")
    inputs = (_generated(view), *(view.value(name) for name in names))
    return view.add_float(Op.MUSGRAVE, inputs, int(node.musgrave_dimensions[0]) | NoiseType[node.musgrave_type] << 3)


@translator("ShaderNodeTexChecker")
def checker(view: NodeView) -> Value:
    inputs = (_generated(view), view.value("Color1"), view.value("Color2"), view.value("Scale"))
    return _color_or_factor(view, Op.CHECKER, inputs)


@translator("ShaderNodeTexGradient")
def gradient(view: NodeView) -> Value:
    mode = Gradient[view.node.gradient_type]
    return view.add(Op.GRADIENT, (_generated(view),), mode, kind=FLOAT if view.output == "Fac" else COLOR)


@translator("ShaderNodeTexWhiteNoise")
def white_noise(view: NodeView) -> Value:
    value = view.output == "Value"
    linked = view.linked("Vector")
    vector = view.value("Vector") if linked is None else linked
    mode = int(view.node.noise_dimensions[0])
    kind, output = (FLOAT, 0) if value else (COLOR, 1)
    return view.add(Op.WHITE_NOISE, (vector, view.value("W")), mode, kind=kind, output=output)


@translator("ShaderNodeTexWave")
def wave(view: NodeView) -> Value:
    node = view.node
    bands = node.wave_type == "BANDS"
    direction = {"X": 0, "Y": 1, "Z": 2}.get(node.bands_direction if bands else node.rings_direction, 3)
    mode = (0 if bands else 1) | direction << 1 | {"SIN": 0, "SAW": 1, "TRI": 2}[node.wave_profile] << 3
    names = ("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset")
    inputs = (_generated(view), *(view.value(name) for name in names))
    return view.add(Op.WAVE, inputs, mode, kind=FLOAT if view.output == "Fac" else COLOR)


@translator("ShaderNodeTexMagic")
def magic(view: NodeView) -> Value:
    inputs = (_generated(view), view.value("Scale"), view.value("Distortion"))
    return _color_or_factor(view, Op.MAGIC, inputs, min(max(view.node.turbulence_depth, 0), 10))


@translator("ShaderNodeTexBrick")
def brick(view: NodeView) -> Value:
    node = view.node
    names = ("Color1", "Color2", "Mortar", "Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    inputs = (_generated(view), *(view.value(name) for name in names))
    floats = (float(node.offset), float(node.offset_frequency), float(node.squash), float(node.squash_frequency))
    return _color_or_factor(view, Op.BRICK, inputs, 0, floats)


def _voronoi_form(view: NodeView) -> VoronoiForm:
    if view.version < (4, 0, 0):
        return VoronoiForm.LIMITED
    return VoronoiForm.FLOATS if view.version < (5, 0, 0) else VoronoiForm.INTEGERS


_VORONOI_OUTPUTS = {"Distance": (0, FLOAT), "Color": (1, COLOR), "Position": (2, VECTOR), "W": (3, FLOAT)}
_VORONOI_RADIUS = (4, FLOAT)


@translator("ShaderNodeTexVoronoi")
def voronoi(view: NodeView) -> Value:
    """Without octaves before 4.0, whose nodes have no input for them."""
    node = view.node
    mode = int(node.voronoi_dimensions[0]) | VoronoiFeature[node.feature] << 3 | VoronoiMetric[node.distance] << 6
    mode |= bool(getattr(node, "normalize", False)) << 8 | _voronoi_form(view) << 9
    names = ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")
    inputs = (_generated(view), *(view.value(name) for name in names))
    output, kind = _VORONOI_OUTPUTS.get(view.output, _VORONOI_RADIUS)
    return view.add(Op.VORONOI, inputs, mode, kind=kind, output=output)


@translator("ShaderNodeTexGabor")
def gabor(view: NodeView) -> Value:
    names = ("Scale", "Frequency", "Anisotropy", "Orientation 2D", "Orientation 3D")
    inputs = (_generated(view), *(view.value(name) for name in names))
    output = ("Value", "Phase", "Intensity").index(view.output)
    return view.add_float(Op.GABOR, inputs, int(view.node.gabor_type[0]), output=output)


def _sky_settings(node: Any) -> tuple[float, ...]:
    """Returns the floats of SKY in the order of gradus_nodes.h. The library interprets them."""
    if node.sky_type in {"PREETHAM", "HOSEK_WILKIE"}:
        return (*node.sun_direction, node.turbidity, node.ground_albedo)
    aerosols = node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density  # renamed in 5.0
    size = node.sun_size if node.sun_disc else _NO_DISC
    densities = (node.air_density, aerosols, node.ozone_density)
    return (node.sun_elevation, node.sun_rotation, size, node.sun_intensity, node.altitude, *densities)


@translator("ShaderNodeTexSky")
def sky_texture(view: NodeView) -> Value:
    vector = coordinates(view, TexCoord.GENERATED)
    sky = view.add(Op.SKY, (vector,), Sky[view.node.sky_type], _sky_settings(view.node))
    return working_space.from_rec709(view.program, sky)


_WORLD_TO_OBJECT = TransformKind.NORMAL | 1 << 4
_WITHOUT_PROFILE = 100.0  # what Cycles has in place of a profile that cannot be read


@translator("ShaderNodeTexIES")
def ies_texture(view: NodeView) -> Value:
    """The intensity of a luminaire, by default in the direction of emission, and before 4.0 in that of the normal."""
    strength = view.value("Strength")
    profile = ies_profile.parse(_ies_text(view) or "")
    if profile is None:
        view.warn_replaced(f"has no profile that can be read and is {_WITHOUT_PROFILE:.0f} everywhere, as in Cycles")
        return view.math(Math.MULTIPLY, strength, constant_float(_WITHOUT_PROFILE))
    vector = view.linked("Vector")
    if vector is None and view.version < (4, 0, 0):
        vector = view.add_vector(Op.TEX_COORD, (), TexCoord.NORMAL)
    elif vector is None:
        incoming = view.add_vector(Op.GEOMETRY, (), Geometry.INCOMING)
        vector = view.add_vector(Op.VECTOR_TRANSFORM, (incoming,), _WORLD_TO_OBJECT)
    continuation = 0 if view.version < (4, 0, 0) else 1 if view.version < (5, 0, 0) else 2
    return view.add_float(Op.IES, (_mapped(view, vector), strength), continuation, floats=profile.table())


def _ies_text(view: NodeView) -> str | None:
    node = view.node
    if node.mode == "INTERNAL":
        return node.ies.as_string() if node.ies is not None else None
    return view.walker.resources.text(node.filepath, node.id_data)
