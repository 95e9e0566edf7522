"""Node programs: values, nodes and constants, and their conversion to native structs."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from .ops import Op

FLOAT, VECTOR, COLOR, SHADER = "float", "vector", "color", "shader"
_IMAGE_OPS = frozenset({Op.IMAGE, Op.ENVIRONMENT})
"""Operations whose resource is the key of an image."""


@dataclass(frozen=True)
class Value:
    """A constant (node -1), or an output of a node of a program."""

    kind: str
    constant: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    node: int = -1
    output: int = 0
    is_default: bool = field(default=False, compare=False)
    """Whether it is the value of an input without a link, also where groups and muted nodes pass it on."""

    @property
    def is_constant(self) -> bool:
        return self.node < 0

    def is_zero(self) -> bool:
        return self.node < 0 and not any(self.constant[:3])


def constant_float(x: float) -> Value:
    return Value(FLOAT, (float(x),) * 4)


def constant_vector(v: Any) -> Value:
    return Value(VECTOR, (float(v[0]), float(v[1]), float(v[2]), 1.0))


def constant_color(v: Any) -> Value:
    return Value(COLOR, (float(v[0]), float(v[1]), float(v[2]), 1.0))


NO_NORMAL = Value(VECTOR)
"""Stands for the normal of the surface, or for its default tangent."""
BLACK_CLOSURE = Value(SHADER)


@dataclass
class Program:
    """The program of a material, world or light. Equal nodes are stored once."""

    name: str = ""
    surface: int = -1
    aovs: int = 0
    """Index + 1 of the node of the outputs to AOVs."""
    displacement: Value | None = None
    """The displacement in world space, which is no constant."""
    displacement_method: int = 0
    bump_filter_width: float = 1.0
    """Step of the finite differences of a bump by displacement, in pixels."""
    shading_normals: int = 0
    """How shading normals that disagree with the surface are corrected."""
    pass_index: int = 0
    sample_as_light: bool = True
    transparent_shadow: bool = True
    uses_fallback: bool = False
    warnings: list[str] = field(default_factory=list)
    attribute_names: set[str] = field(default_factory=set)
    """Attributes and UV maps that meshes must have; "" is the colour attribute that is active for renders."""
    instance_attribute_names: set[str] = field(default_factory=set)
    """Attributes that instances must have, with the prefixes of attribute_names.py."""
    reads_edges: bool = False
    """Whether meshes must have edges, for pointiness and islands."""
    nodes: list[tuple[int, int, int, int, int, int, int]] = field(default_factory=list)
    inputs: list[tuple[int, int, tuple[float, float, float, float]]] = field(default_factory=list)
    floats: array = field(default_factory=lambda: array("f"))
    names: list[str] = field(default_factory=list)
    _known: dict[Any, int] = field(default_factory=dict)

    def add(
        self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0, floats: tuple[float, ...] = (), resource: int = 0
    ) -> int:
        """Adds a node and returns its index. gradus_nodes.h lists the inputs and floats of `op` in order."""
        key = (op, inputs, mode, floats, resource)
        index = self._known.get(key)
        if index is None:
            first_input, first_float = len(self.inputs), len(self.floats)
            self.inputs.extend((value.node, value.output, value.constant) for value in inputs)
            self.floats.extend(floats)
            self.nodes.append((int(op), mode, first_input, len(inputs), first_float, len(floats), resource))
            index = self._known[key] = len(self.nodes) - 1
        return index

    def name_index(self, name: str) -> int:
        """Returns the resource number of an attribute or UV map, and requests it from meshes."""
        self.attribute_names.add(name)
        return self._name_index(name)

    def instance_name_index(self, name: str) -> int:
        """Returns the resource number of an attribute of instances, and requests it."""
        self.instance_attribute_names.add(name)
        return self._name_index(name)

    def _name_index(self, name: str) -> int:
        if name not in self.names:
            self.names.append(name)
        return self.names.index(name) + 1

    def warn(self, text: str) -> None:
        if text not in self.warnings:
            self.warnings.append(text)

    def content(self, image: Callable[[int], Any] = int) -> tuple[Any, ...]:
        """Returns a value that is equal for equal programs. image: returns what stands for the key of an image."""
        nodes = ((*node[:-1], image(node[-1])) if node[0] in _IMAGE_OPS else node for node in self.nodes)
        return (
            self.name,
            self.surface,
            self.aovs,
            self.displacement,
            self.displacement_method,
            self.bump_filter_width,
            self.shading_normals,
            self.pass_index,
            self.sample_as_light,
            self.transparent_shadow,
            self.uses_fallback,
            tuple(nodes),
            tuple(self.inputs),
            self.floats.tobytes(),
            tuple(self.names),
        )

    def to_native(self, native: Any) -> tuple[Any, list[Any]]:
        """Returns a native Material, and the objects that must stay alive until the library has copied it."""
        nodes = (native.Node * max(len(self.nodes), 1))()
        for record, values in zip(nodes, self.nodes, strict=False):
            record.op, record.mode, record.first_input, record.input_count = values[:4]
            record.first_float, record.float_count, record.resource = values[4:]
        inputs = (native.Input * max(len(self.inputs), 1))()
        for record, (node, output, constant) in zip(inputs, self.inputs, strict=False):
            record.node = node
            record.output = output
            record.value[:] = constant
        floats = (ctypes.c_float * max(len(self.floats), 1)).from_buffer_copy(self.floats or array("f", [0.0]))
        names = native.name_array(self.names)
        material = native.Material()
        material.node_count = len(self.nodes)
        material.nodes = ctypes.cast(nodes, ctypes.POINTER(native.Node))
        material.inputs = ctypes.cast(inputs, ctypes.POINTER(native.Input))
        material.input_count = len(self.inputs)
        material.floats = ctypes.cast(floats, ctypes.POINTER(ctypes.c_float))
        material.float_count = len(self.floats)
        material.names = names
        material.name_count = len(self.names)
        material.surface = self.surface
        material.aovs = self.aovs
        if self.displacement is not None:
            material.displacement = self.displacement.node + 1
            material.displacement_output = self.displacement.output
            material.displacement_method = self.displacement_method
            material.bump_filter_width = self.bump_filter_width
        material.shading_normals = self.shading_normals
        material.pass_index = self.pass_index
        material.sample_as_light = self.sample_as_light
        material.transparent_shadow = self.transparent_shadow
        material.uses_fallback = self.uses_fallback
        material.name = native.name(self.name)
        return material, [nodes, inputs, floats, names]
