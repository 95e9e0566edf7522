"""Nodes of vectors: mapping, arithmetic and transforms."""

from __future__ import annotations

from .node import NodeView, translator
from .ops import Mapping, Op, VectorMath
from .program import FLOAT, VECTOR, Value, constant_float, constant_vector


@translator("ShaderNodeMapping")
def mapping(view: NodeView) -> Value:
    location = view.value("Location")
    inputs = (view.value("Vector"), location, view.value("Rotation"), view.value("Scale"))
    return view.add_vector(Op.MAPPING, inputs, Mapping[view.node.vector_type])


# The version from which normals are transformed by the transposed inverse. Before, they were directions of length 1.
_NORMALS_BY_INVERSE_SINCE = (4, 0, 0)


@translator("ShaderNodeVectorMath")
def vector_math(view: NodeView) -> Value:
    inputs = (view.value("Vector"), view.value("Vector_001"), view.value("Vector_002"), view.value("Scale"))
    scalar = view.output == "Value"
    mode = VectorMath[view.node.operation]
    return view.add(Op.VECTOR_MATH, inputs, mode, kind=FLOAT if scalar else VECTOR, output=1 if scalar else 0)


@translator("ShaderNodeVectorRotate")
def vector_rotate(view: NodeView) -> Value:
    mode = {"AXIS_ANGLE": 0, "X_AXIS": 1, "Y_AXIS": 2, "Z_AXIS": 3, "EULER_XYZ": 4}[view.node.rotation_type]
    names = ("Vector", "Center", "Axis", "Angle", "Rotation")
    inputs = tuple(view.value(name) for name in names)
    return view.add_vector(Op.VECTOR_ROTATE, inputs, mode | bool(view.node.invert) << 3)


@translator("ShaderNodeVectorTransform")
def vector_transform(view: NodeView) -> Value:
    kinds, spaces = {"VECTOR": 0, "POINT": 1, "NORMAL": 2}, {"WORLD": 0, "OBJECT": 1, "CAMERA": 2}
    node = view.node
    is_scaled_direction = node.vector_type == "NORMAL" and view.version < _NORMALS_BY_INVERSE_SINCE
    kind = kinds["VECTOR" if is_scaled_direction else node.vector_type]
    mode = kind | spaces[node.convert_from] << 2 | spaces[node.convert_to] << 4
    transformed = view.add_vector(Op.VECTOR_TRANSFORM, (view.value("Vector"),), mode)
    if not is_scaled_direction:
        return transformed
    unused = (constant_vector((0.0, 0.0, 0.0)), constant_vector((0.0, 0.0, 0.0)), constant_float(1.0))
    return view.add_vector(Op.VECTOR_MATH, (transformed, *unused), VectorMath.NORMALIZE)


@translator("ShaderNodeSeparateXYZ")
def separate_xyz(view: NodeView) -> Value:
    return view.add_float(Op.SEPARATE, (view.value("Vector"),), output="XYZ".index(view.output))


@translator("ShaderNodeCombineXYZ")
def combine_xyz(view: NodeView) -> Value:
    return view.add_vector(Op.COMBINE, (view.value("X"), view.value("Y"), view.value("Z")))


_TILING = {
    "Segment Coordinates": (0, VECTOR),
    "Segment ID": (1, FLOAT),
    "Segment Width": (2, FLOAT),
    "Segment Rotation": (3, FLOAT),
}


@translator("ShaderNodeRadialTiling")
def radial_tiling(view: NodeView) -> Value:
    inputs = tuple(view.value(name) for name in ("Vector", "Sides", "Roundness"))
    output, kind = _TILING[view.output]
    return view.add(Op.RADIAL_TILING, inputs, 1 if view.node.normalize else 0, kind=kind, output=output)
