"""Nodes that read properties of the surface point, the object or the ray."""

from __future__ import annotations

from .node import NodeView, translator
from .ops import Geometry, LightPath, Op, Tangent, TexCoord
from .program import FLOAT, VECTOR, Value, constant_color, constant_float

_GEOMETRY = {
    "Position": Geometry.POSITION,
    "Normal": Geometry.NORMAL,
    "Tangent": Geometry.TANGENT,
    "True Normal": Geometry.TRUE_NORMAL,
    "Incoming": Geometry.INCOMING,
    "Parametric": Geometry.PARAMETRIC,
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
def geometry(view: NodeView) -> Value | None:
    if view.output == "Backfacing":
        return view.add_float(Op.GEOMETRY, (), Geometry.BACKFACING)
    if view.output in _GEOMETRY:
        return view.add_vector(Op.GEOMETRY, (), _GEOMETRY[view.output])
    view.warn_replaced(f"has an output that is not supported: {view.output}")
    return constant_float(0.5)


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
# Properties of objects that are also outputs of Object Info.
_OBJECT_PROPERTIES = {"color": 1, "pass_index": 2, "location": 0}


@translator("ShaderNodeAttribute")
def attribute(view: NodeView) -> Value:
    output, kind = _ATTRIBUTE_OUTPUTS[view.output]
    name = view.node.attribute_name
    if view.node.attribute_type == "GEOMETRY":
        return view.add(Op.ATTRIBUTE, resource=view.name_resource(name), kind=kind, output=output)
    if view.node.attribute_type in {"OBJECT", "INSTANCER"} and name in _OBJECT_PROPERTIES:
        if view.output == "Alpha":
            return view.add(Op.OBJECT_INFO, kind=kind, output=4) if name == "color" else constant_float(1.0)
        return view.add(Op.OBJECT_INFO, kind=kind, output=_OBJECT_PROPERTIES[name])
    view.warn_replaced(f"uses the property '{name}', which is not supported")
    return constant_float(0.0)


@translator("ShaderNodeVertexColor")
def color_attribute(view: NodeView) -> Value:
    output, kind = _ATTRIBUTE_OUTPUTS[view.output]
    return view.add(Op.ATTRIBUTE, resource=view.name_resource(view.node.layer_name), kind=kind, output=output)


@translator("ShaderNodeObjectInfo")
def object_info(view: NodeView) -> Value:
    if view.output == "Material Index":
        return constant_float(view.program.pass_index)
    kind = {"Location": VECTOR, "Color": "color"}.get(view.output, FLOAT)
    return view.add(Op.OBJECT_INFO, kind=kind, output=_OBJECT_INFO[view.output])


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


@translator("ShaderNodeValue")
def value(view: NodeView) -> Value:
    return constant_float(view.node.outputs[0].default_value)


@translator("ShaderNodeRGB")
def rgb(view: NodeView) -> Value:
    return constant_color(view.node.outputs[0].default_value)
