"""Gives the inputs of nodes values other than their defaults: constants, and patterns that vary over the surface."""

from __future__ import annotations

from typing import Any

import bpy

NORMALS = ("normal", "tangent")
"""Parts of the names of inputs that take directions of the surface, and no colours or places."""

PLAIN = ("Value", "A", "B", "X", "Y", "Z", "W")
"""Names of inputs that take any number."""

ITEM = "Tint"
"""Name of the colour in bundles, and of the one that closures return."""

_COLORS = ((0.8, 0.3, 0.2, 1.0), (0.2, 0.5, 0.7, 1.0), (0.4, 0.7, 0.3, 1.0), (0.6, 0.4, 0.8, 1.0))
_VECTORS = ((0.3, 0.5, 0.7), (0.6, -0.2, 0.4), (-0.4, 0.3, 0.5), (0.2, 0.7, -0.3))


def is_direction(socket: bpy.types.NodeSocket) -> bool:
    return socket.type == "VECTOR" and any(part in socket.name.lower() for part in NORMALS)


def is_implicit(socket: bpy.types.NodeSocket) -> bool:
    """Returns whether an input without a link takes a value of the surface, such as its coordinates."""
    return socket.hide_value and socket.type == "VECTOR"


def span(socket: bpy.types.NodeSocket) -> tuple[float, float]:
    """Returns a range of moderate values around the default of a number.

    Blender does not tell scripts the limits of inputs. Factors and what is positive by default stay positive, but plain
    numbers do not.
    """
    if socket.bl_idname == "NodeSocketFloatFactor":
        return 0.1, 0.9
    default = float(socket.default_value)
    if socket.name in PLAIN:
        return default - 1.2, default + 1.2
    return 0.6 * default, 1.4 * default + (0.5 if default == 0.0 else 0.0)


def set_constant(socket: bpy.types.NodeSocket, index: int) -> None:
    """Sets a moderate value that differs from the default and from those of the neighbours."""
    if socket.type in {"VALUE", "INT"}:
        low, high = span(socket)
        value = low + (0.35, 0.6, 0.45, 0.7)[index % 4] * (high - low)
        socket.default_value = round(value) if socket.type == "INT" else value
    elif socket.type == "RGBA":
        socket.default_value = _COLORS[index % 4]
    elif socket.type == "VECTOR" and not socket.hide_value:
        count = len(socket.default_value)
        socket.default_value = (*_VECTORS[index % 4], 0.5)[:count]


def set_value(socket: bpy.types.NodeSocket, value: Any) -> None:
    """Sets a value. Of one with more channels than the input has in this Blender, the first ones count."""
    is_one = isinstance(value, (int, float, str))
    socket.default_value = value if is_one else value[: len(socket.default_value)]


class Patterns:
    """Makes nodes in a tree whose outputs vary smoothly over the surface."""

    def __init__(self, tree: Any) -> None:
        self._tree = tree

    def drive(self, socket: bpy.types.NodeSocket, turned: bool = False) -> None:
        """Links an input to a pattern of its kind. `turned` chooses one that runs in another direction.

        An input that nothing can vary gets another value.
        """
        if socket.type == "STRING":
            socket.default_value = "Col"
            return
        if socket.type == "MENU":
            socket.default_value = socket.node.enum_items[-1].name
            return
        source = self._source(socket, turned)
        if source is None:
            raise ValueError(f"no pattern for sockets of type {socket.type}")
        self._tree.links.new(source, socket)

    def _source(self, socket: bpy.types.NodeSocket, turned: bool) -> Any:
        if socket.type in {"VALUE", "INT", "BOOLEAN"}:
            low, high = span(socket) if socket.type != "BOOLEAN" else (0.0, 1.0)
            return self.number(low, high, turned)
        if socket.type == "RGBA":
            return self.vector((0.35, 0.35, 0.35), (0.5, 0.45, 0.55), turned)
        if socket.type in {"VECTOR", "ROTATION"}:
            return (
                self.direction()
                if is_direction(socket)
                else self.vector((0.97, 0.93, 0.89), (0.01, 0.02, 0.03), turned)
            )
        if socket.type == "SHADER":
            if socket.name == "Volume":
                return self.shader("VolumeAbsorption")
            return self.shader("BsdfTransparent" if turned else "Emission")
        if socket.type == "BUNDLE":
            return self.bundle(turned)
        if socket.type == "CLOSURE":
            return self.closure(turned)
        return None

    def bundle(self, turned: bool) -> Any:
        """Returns a bundle of one colour, which varies over the surface."""
        node = self._tree.nodes.new("NodeCombineBundle")
        node.bundle_items.new("RGBA", ITEM)
        self.drive(node.inputs[ITEM], turned)
        return node.outputs["Bundle"]

    def closure(self, turned: bool) -> Any:
        """Returns a function that returns a colour, which varies over the surface."""
        first, last = (self._tree.nodes.new(f"NodeClosure{end}") for end in ("Input", "Output"))
        first.pair_with_output(last)
        last.output_items.new("RGBA", ITEM)
        self.drive(last.inputs[ITEM], turned)
        return last.outputs["Closure"]

    def _node(self, kind: str, **settings: Any) -> Any:
        node = self._tree.nodes.new(f"ShaderNode{kind}")
        for name, value in settings.items():
            setattr(node, name, value)
        return node

    def place(self, turned: bool) -> Any:
        """Returns object coordinates, in another order if `turned`."""
        source = self._node("TexCoord").outputs["Object"]
        if not turned:
            return source
        apart, together = self._node("SeparateXYZ"), self._node("CombineXYZ")
        self._tree.links.new(source, apart.inputs[0])
        for index in range(3):
            self._tree.links.new(apart.outputs[(index + 1) % 3], together.inputs[index])
        return together.outputs[0]

    def vector(self, scale: tuple[float, ...], offset: tuple[float, ...], turned: bool) -> Any:
        node = self._node("VectorMath", operation="MULTIPLY_ADD")
        self._tree.links.new(self.place(turned), node.inputs[0])
        node.inputs[1].default_value, node.inputs[2].default_value = scale, offset
        return node.outputs["Vector"]

    def number(self, low: float, high: float, turned: bool) -> Any:
        """Returns a number that runs from `low` to `high` over the object and is constant on none of its faces."""
        product, node = self._node("VectorMath", operation="DOT_PRODUCT"), self._node("Math", operation="MULTIPLY_ADD")
        self._tree.links.new(self.place(turned), product.inputs[0])
        product.inputs[1].default_value = (0.6, 0.25, 0.15)
        self._tree.links.new(product.outputs["Value"], node.inputs[0])
        node.inputs[1].default_value, node.inputs[2].default_value = 0.5 * (high - low), 0.5 * (high + low)
        return node.outputs[0]

    def direction(self) -> Any:
        """Returns the normal, turned by a pattern."""
        node, unit = self._node("VectorMath", operation="MULTIPLY_ADD"), self._node("VectorMath", operation="NORMALIZE")
        self._tree.links.new(self.place(True), node.inputs[0])
        node.inputs[1].default_value = (0.35, 0.3, 0.25)
        self._tree.links.new(self._node("NewGeometry").outputs["Normal"], node.inputs[2])
        self._tree.links.new(node.outputs["Vector"], unit.inputs[0])
        return unit.outputs["Vector"]

    def shader(self, kind: str) -> Any:
        node = self._node(kind)
        node.inputs[0].default_value = (0.7, 0.5, 0.3, 1.0)
        return node.outputs[0]
