"""Walks a graph from its output backwards: links, groups, reroutes, muted nodes, loops."""

from __future__ import annotations

from typing import Any

from . import convert, fallback, registry
from .node import NodeView
from .program import SHADER, Program, Value
from .tree import Tree, find_socket

Path = tuple[Any, ...]
"""The group nodes that were entered, outermost first."""


class Walker:
    """Translates what an input needs. Each output of each node is translated once per way of groups that leads to it."""

    def __init__(self, program: Program, resources: Any, node_tree: Any, version: tuple[int, ...], kind: str) -> None:
        self.program = program
        self.resources = resources
        self.version = version
        self.kind = kind  # SURFACE, WORLD or LIGHT
        self._root = node_tree
        self._trees: dict[int, Tree] = {}
        self._done: dict[Any, Value | None] = {}
        self._active: set[Any] = set()

    def tree(self, path: Path) -> Tree:
        node_tree = path[-1].node_tree if path else self._root
        key = node_tree.as_pointer()
        if key not in self._trees:
            self._trees[key] = Tree(node_tree)
        return self._trees[key]

    def input(self, socket: Any, path: Path) -> Value:
        """Value of an input: what is linked, converted to the socket's kind, or its default."""
        linked = self.linked(socket, path)
        kind = convert.kind_of(socket)
        if linked is not None:
            converted = convert.convert(self.program, linked, kind)
            if converted is not None:
                return converted
        return convert.default_value(socket)

    def linked(self, socket: Any, path: Path) -> Value | None:
        """Value of what feeds an input; None where nothing does."""
        source = self.tree(path).source(socket)
        return self.output(source[0], source[1], path) if source else None

    def output(self, node: Any, socket: Any, path: Path) -> Value | None:
        """Value of an output. A loop counts as nothing linked."""
        key = (tuple(group.as_pointer() for group in path), node.as_pointer(), socket.identifier)
        if key in self._done:
            return self._done[key]
        if key in self._active:
            return None
        self._active.add(key)
        try:
            value = self._translate(node, socket, path)
        finally:
            self._active.discard(key)
        self._done[key] = value
        return value

    def _translate(self, node: Any, socket: Any, path: Path) -> Value | None:
        if node.mute:
            return self._pass_through(node, socket, path)
        name = node.bl_idname
        if name == "NodeReroute":
            return self.linked(node.inputs[0], path)
        if name == "NodeGroupInput":
            return self._group_input(socket, path)
        if name == "ShaderNodeGroup" or node.type == "GROUP":
            return self._group(node, socket, path)
        view = NodeView(self, node, socket, path)
        translate = registry.find(name)
        return translate(view) if translate else fallback.replace(view)

    def _pass_through(self, node: Any, socket: Any, path: Path) -> Value | None:
        """A muted node hands on the inputs that Blender connects inside."""
        for link in node.internal_links:
            if link.to_socket.identifier == socket.identifier:
                return self.linked_or_default(link.from_socket, socket, path)
        return None

    def linked_or_default(self, socket: Any, output: Any, path: Path) -> Value | None:
        """An input's value as an output would carry it."""
        kind = convert.kind_of(output)
        value = self.input(socket, path)
        if kind == SHADER and value.is_constant:
            return None
        return convert.convert(self.program, value, kind)

    def _group_input(self, socket: Any, path: Path) -> Value | None:
        if not path:
            return None
        outer = find_socket(path[-1].inputs, socket.identifier)
        return self.input(outer, path[:-1]) if outer is not None else None

    def _group(self, node: Any, socket: Any, path: Path) -> Value | None:
        if node.node_tree is None or any(group.node_tree == node.node_tree for group in path):
            return None
        inner = (*path, node)
        output = self.tree(inner).group_output()
        if output is None:
            return None
        end = find_socket(output.inputs, socket.identifier)
        return self.input(end, inner) if end is not None else None
