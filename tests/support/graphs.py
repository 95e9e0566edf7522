"""A shorthand for building node trees in tests."""

from __future__ import annotations

from typing import Any

import bpy

from .nodes import socket


class Graph:
    """A shorthand for building node trees."""

    def __init__(self, material: bpy.types.Material) -> None:
        self.tree = material.node_tree

    def __call__(
        self, kind: str, output: str, inputs: dict[str, Any] | None = None, **properties: Any
    ) -> bpy.types.NodeSocket:
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            target = socket(node.inputs, name)
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, target)
            else:
                target.default_value = value
        return socket(node.outputs, output)

    def place(self) -> bpy.types.NodeSocket:
        return self("TexCoord", "Object")
