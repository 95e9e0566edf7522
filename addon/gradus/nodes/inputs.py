"""Nodes that read properties of the surface point, the object or the ray."""

from __future__ import annotations

from ..attribute_names import INSTANCER, OBJECT, PARTICLE
from .node import NodeView, translator
from .ops import Geometry, LightPath, Op, Tangent, TexCoord
from .program import COLOR, FLOAT, VECTOR, Value, constant_color, constant_float, constant_vector

_GEOMETRY = {
    "Position": Geometry.POSITION,
    "Normal": Geometry.NORMAL,
    "Tangent": Geometry.TANGENT,
    "True Normal": Geometry.TRUE_NORMAL,
    "Incoming": Geometry.INCOMING,
    "Parametric": Geometry.PARAMETRIC,
}
_GEOMETRY_BY_EDGES = {
    "Pointiness": Geometry.POINTINESS,
    "Random Per Island": Geometry.RANDOM_PER_ISLAND,
}
_LIGHT_PATH = {
    "Is Camera Ray": LightPath.CAMERA,
    "Is Shadow Ray": LightPath.SHADOW,
    "Is Diffuse Ray": LightPath.DIFFUSE,
    "Is Glossy Ray": LightPath.GLOSSY,
    "Is Singular Ray": LightPath.SINGULAR,
    "Is Reflection Ray": LightPath.REFLECTION,
    "Is Transmission Ray": LightPath.TRANSMISSION,
    "Ray Length": LightPath.LENGTH,
    "Ray Depth": LightPath.DEPTH,
    "Diffuse Depth": LightPath.DIFFUSE_DEPTH,
    "Glossy Depth": LightPath.GLOSSY_DEPTH,
    "Transparent Depth": LightPath.TRANSPARENT_DEPTH,
    "Transmission Depth": LightPath.TRANSMISSION_DEPTH,
    "Portal Depth": LightPath.PORTAL_DEPTH,
}
_TEX_COORD = {
    "Generated": TexCoord.GENERATED,
    "Normal": TexCoord.NORMAL,
    "UV": TexCoord.UV,
    "Object": TexCoord.OBJECT,
    "Camera": TexCoord.CAMERA,
    "Window": TexCoord.WINDOW,
    "Reflection": TexCoord.REFLECTION,
}
_INSTANCER = {"Generated": TexCoord.INSTANCER_GENERATED, "UV": TexCoord.INSTANCER_UV}
_OBJECT_INFO = {"Location": 0, "Color": 1, "Object Index": 2, "Random": 3, "Alpha": 4}


@translator("ShaderNodeNewGeometry")
def geometry(view: NodeView) -> Value:
    if view.output == "Backfacing":
        return view.add_float(Op.GEOMETRY, (), Geometry.BACKFACING)
    if view.output in _GEOMETRY_BY_EDGES:
        view.program.reads_edges = True
        return view.add_float(Op.GEOMETRY, (), _GEOMETRY_BY_EDGES[view.output])
    return view.add_vector(Op.GEOMETRY, (), _GEOMETRY[view.output])


@translator("ShaderNodeLightPath")
def light_path(view: NodeView) -> Value:
    mode = _LIGHT_PATH.get(view.output)
    return constant_float(0.0) if mode is None else view.add_float(Op.LIGHT_PATH, (), mode)


def _column_major(matrix: object) -> tuple[float, ...]:
    return tuple(float(matrix[row][column]) for column in range(4) for row in range(4))


@translator("ShaderNodeTexCoord")
def texture_coordinate(view: NodeView) -> Value:
    modes = {**_TEX_COORD, **_INSTANCER} if view.node.from_instancer else _TEX_COORD
    floats: tuple[float, ...] = ()
    if view.output == "Object" and view.node.object is not None:
        floats = _column_major(view.node.object.matrix_world.inverted_safe())
    return view.add_vector(Op.TEX_COORD, (), modes[view.output], floats=floats)


@translator("ShaderNodeUVMap")
def uv_map(view: NodeView) -> Value:
    if view.node.from_instancer:
        return view.add_vector(Op.TEX_COORD, (), TexCoord.INSTANCER_UV)
    name = view.node.uv_map
    return view.add_vector(Op.TEX_COORD, (), TexCoord.UV, resource=view.name_resource(name) if name else 0)


@translator("ShaderNodeTangent")
def tangent(view: NodeView) -> Value:
    if view.node.direction_type == "RADIAL":
        axes = {"X": Tangent.RADIAL_X, "Y": Tangent.RADIAL_Y, "Z": Tangent.RADIAL_Z}
        return view.add_vector(Op.TANGENT, (), axes[view.node.axis])
    name = view.node.uv_map
    return view.add_vector(Op.TANGENT, (), Tangent.UV, resource=view.name_resource(name) if name else 0)


_ATTRIBUTE_OUTPUTS = {"Color": (0, "color"), "Vector": (1, VECTOR), "Fac": (2, FLOAT), "Alpha": (3, FLOAT)}


@translator("ShaderNodeAttribute")
def attribute(view: NodeView) -> Value:
    output, kind = _ATTRIBUTE_OUTPUTS[view.output]
    name = view.node.attribute_name
    if view.node.attribute_type == "GEOMETRY":
        return view.add(Op.ATTRIBUTE, resource=view.name_resource(name), kind=kind, output=output)
    if view.node.attribute_type == "VIEW_LAYER":
        return _constant_attribute(view.walker.resources.view_layer_color(name), view.output)
    prefix = {"OBJECT": OBJECT, "INSTANCER": INSTANCER}[view.node.attribute_type]
    return view.instance_attribute(prefix + name, kind=kind, output=output)


def _constant_attribute(color: tuple[float, ...], output: str) -> Value:
    if output == "Alpha":
        return constant_float(color[3])
    if output == "Fac":
        return constant_float(sum(color[:3]) / 3.0)
    return constant_color(color) if output == "Color" else constant_vector(color)


_MISSING_IS_TRANSPARENT = 1


@translator("ShaderNodeVertexColor")
def color_attribute(view: NodeView) -> Value:
    output, kind = _ATTRIBUTE_OUTPUTS[view.output]
    resource = view.name_resource(view.node.layer_name)
    return view.add(Op.ATTRIBUTE, mode=_MISSING_IS_TRANSPARENT, resource=resource, kind=kind, output=output)


@translator("ShaderNodeObjectInfo")
def object_info(view: NodeView) -> Value:
    if view.output == "Material Index":
        return constant_float(view.program.pass_index)
    kind = {"Location": VECTOR, "Color": "color"}.get(view.output, FLOAT)
    return view.add(Op.OBJECT_INFO, kind=kind, output=_OBJECT_INFO[view.output])


@translator("ShaderNodeParticleInfo")
def particle_info(view: NodeView) -> Value:
    is_vector = view.output in {"Location", "Velocity", "Angular Velocity"}
    kind, output = (VECTOR, 1) if is_vector else (FLOAT, 2)
    return view.instance_attribute(PARTICLE + view.output, kind=kind, output=output)


@translator("ShaderNodeHairInfo", "ShaderNodePointInfo")
def hair_or_point_info(view: NodeView) -> Value:
    """Returns the value of surfaces, which are neither hair nor points."""
    is_vector = view.output in {"Tangent Normal", "Position"}
    return constant_vector((0.0, 0.0, 0.0)) if is_vector else constant_float(0.0)


@translator("ShaderNodeWireframe")
def wireframe(view: NodeView) -> Value:
    mode = 1 if view.node.use_pixel_size else 0
    return view.add_float(Op.WIREFRAME, (view.value("Size"),), mode, floats=view.walker.resources.pixel)


@translator("ShaderNodeAmbientOcclusion")
def ambient_occlusion(view: NodeView) -> Value:
    distance = view.value("Distance")
    # A constant distance of 0 stands for that of the world.
    of_world = distance.is_constant and distance.is_zero()
    mode = view.node.inside + 2 * view.node.only_local + 4 * of_world
    inputs = (view.value("Color"), distance, view.direction("Normal"))
    kind, output = (FLOAT, 1) if view.output == "AO" else (COLOR, 0)
    floats = (float(view.node.samples),)
    return view.add(Op.AMBIENT_OCCLUSION, inputs, mode, floats, kind=kind, output=output)


@translator("ShaderNodeBevel")
def bevel(view: NodeView) -> Value:
    inputs = (view.value("Radius"), view.direction("Normal"))
    return view.add_vector(Op.BEVEL, inputs, floats=(float(view.node.samples),))


_RAYCAST_OUTPUTS = {
    "Is Hit": (0, FLOAT),
    "Self Hit": (1, FLOAT),
    "Hit Distance": (2, FLOAT),
    "Hit Position": (3, VECTOR),
    "Hit Normal": (4, VECTOR),
}


_RAYCAST_SURFACE = 5
"""Output with the place where the ray ends, which RAYCAST_ATTRIBUTE reads."""


@translator("ShaderNodeRaycast")
def raycast(view: NodeView) -> Value | None:
    position = view.linked("Position") or view.add_vector(Op.GEOMETRY, (), Geometry.POSITION)
    direction = view.linked("Direction") or view.add_vector(Op.GEOMETRY, (), Geometry.NORMAL)
    inputs = (position, direction, view.value("Length"))
    mode = int(view.node.only_local)
    if view.output in _RAYCAST_OUTPUTS:
        output, kind = _RAYCAST_OUTPUTS[view.output]
        return view.add(Op.RAYCAST, inputs, mode, kind=kind, output=output)
    surface = view.add(Op.RAYCAST, inputs, mode, kind=VECTOR, output=_RAYCAST_SURFACE)
    return _raycast_attribute(view, surface)


def _raycast_attribute(view: NodeView, surface: Value) -> Value | None:
    """Returns an output that reads an attribute where the ray ends. An input of text holds its name."""
    _, index, *rest = view.output.split("_")
    text = view.find(f"Value_{index}")
    if text is None:
        return None
    types = {"VALUE": "Fac", "VECTOR": "Vector", "RGBA": "Color"}
    output, kind = _ATTRIBUTE_OUTPUTS["Alpha" if rest else types[view.socket.type]]
    return view.add(
        Op.RAYCAST_ATTRIBUTE, (surface,), resource=view.name_resource(text.default_value), kind=kind, output=output
    )


@translator("ShaderNodeCameraData")
def camera_data(view: NodeView) -> Value:
    output = {"View Vector": 0, "View Z Depth": 1, "View Distance": 2}[view.output]
    return view.add(Op.CAMERA_DATA, kind=FLOAT if output else VECTOR, output=output)


@translator("ShaderNodeLayerWeight")
def layer_weight(view: NodeView) -> Value:
    inputs = (view.value("Blend"), view.direction("Normal"))
    return view.add_float(Op.LAYER_WEIGHT, inputs, output=1 if view.output == "Facing" else 0)


@translator("ShaderNodeFresnel")
def fresnel(view: NodeView) -> Value:
    return view.add_float(Op.FRESNEL, (view.value("IOR"), view.direction("Normal")))


@translator("ShaderNodeLightFalloff")
def light_falloff(view: NodeView) -> Value:
    mode = {"Quadratic": 0, "Linear": 1, "Constant": 2}[view.output]
    return view.add_float(Op.LIGHT_FALLOFF, (view.value("Strength"), view.value("Smooth")), mode)


@translator("GeometryNodeInputSceneTime")
def scene_time(view: NodeView) -> Value:
    seconds, frame = view.walker.resources.scene_time()
    return constant_float(frame if view.output == "Frame" else seconds)


@translator("FunctionNodeInputVector")
def vector(view: NodeView) -> Value:
    """Returns a constant, which Blender makes of values of groups since 5.2."""
    return constant_vector(view.node.vector)


@translator("ShaderNodeValue")
def value(view: NodeView) -> Value:
    return constant_float(view.node.outputs[0].default_value)


@translator("ShaderNodeRGB")
def rgb(view: NodeView) -> Value:
    return constant_color(view.node.outputs[0].default_value)
