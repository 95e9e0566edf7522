"""Walks a graph backwards from its output, through links, groups, reroutes and muted nodes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from . import convert, fallback
from .node import NodeView, find_translator
from .program import SHADER, Program, Value
from .tree import Tree, find_socket

Path = tuple[Any, ...]
"""The group nodes around a node, outermost first."""

_LOOP = Value("loop")
"""What a link that closes a loop passes on. Cycles cuts such a loop at the input of the node that computes with it, not
at the groups and reroutes on the way."""


class Walker:
    """Translates the nodes that an input needs. Each output of a node is translated once per path of groups."""

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
        """Returns the value of an input: the linked value, converted to the kind of the socket, or its default."""
        value = self._value(socket, path)
        return replace(convert.default_value(socket), is_default=True) if value is _LOOP else value

    def _value(self, socket: Any, path: Path) -> Value:
        """Returns the value of an input, or _LOOP."""
        linked = self._passed_on(socket, path)
        kind = convert.kind_of(socket)
        if linked is _LOOP:
            _node, output = self.tree(path).source(socket)
            # A conversion is a node that computes.
            return _LOOP if convert.kind_of(output) == kind else Value(kind)
        if linked is not None:
            converted = convert.convert(self.program, linked, kind)
            if converted is not None:
                return converted
        return replace(convert.default_value(socket), is_default=True)

    def linked(self, socket: Any, path: Path) -> Value | None:
        """Returns the value that is linked to an input, or None.

        Before Blender 5.0, Cycles removes links to values that no node computes: to inputs of groups without a link,
        for example. Where an input stands for coordinates or a normal without a link, it then does so, too. From 5.0
        on, Blender inlines such groups (inlining.py).
        """
        value = self._passed_on(socket, path)
        is_cut = value is not None and value.is_default and self.version < (5, 0, 0)
        return None if is_cut or value is _LOOP else value

    def _passed_on(self, socket: Any, path: Path) -> Value | None:
        """Returns the value that a link passes on to an input, or None if it has no link, or _LOOP."""
        source = self.tree(path).source(socket)
        return self._output(source[0], source[1], path) if source else None

    def output(self, node: Any, socket: Any, path: Path) -> Value | None:
        """Returns the value of an output, or None if it has none or is part of a loop."""
        value = self._output(node, socket, path)
        return None if value is _LOOP else value

    def _output(self, node: Any, socket: Any, path: Path) -> Value | None:
        key = (tuple(group.as_pointer() for group in path), node.as_pointer(), socket.identifier)
        if key in self._done:
            return self._done[key]
        if key in self._active:
            return _LOOP
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
            return self._reroute(node, path)
        if name == "NodeGroupInput":
            return self._group_input(socket, path)
        if name == "ShaderNodeGroup" or node.type == "GROUP":
            return self._group(node, socket, path)
        view = NodeView(self, node, socket, path)
        translate = find_translator(name)
        return translate(view) if translate else fallback.replace(view)

    def _reroute(self, node: Any, path: Path) -> Value | None:
        """Returns the value that a reroute passes on. Without a link it is 0 before Blender 5.0, as in Cycles."""
        value = self._passed_on(node.inputs[0], path)
        if value is not None or self.version >= (5, 0, 0):
            return value
        kind = convert.kind_of(node.outputs[0])
        return None if kind == SHADER else Value(kind, is_default=True)

    def _pass_through(self, node: Any, socket: Any, path: Path) -> Value | None:
        """Returns the value that a muted node passes through, by its internal links.

        As in Cycles, it is 0 where the input has no link.
        """
        kind = convert.kind_of(socket)
        for link in node.internal_links:
            if link.to_socket.identifier == socket.identifier:
                value = self._passed_on(link.from_socket, path)
                if value is not None:
                    return value if value is _LOOP else convert.convert(self.program, value, kind)
                return None if kind == SHADER else Value(kind, is_default=True)
        return None

    def linked_or_default(self, socket: Any, output: Any, path: Path) -> Value | None:
        """Returns the value of an input, converted to the kind of an output."""
        kind = convert.kind_of(output)
        value = self.input(socket, path)
        if kind == SHADER and value.is_constant:
            return None
        return convert.convert(self.program, value, kind)

    def _group_input(self, socket: Any, path: Path) -> Value | None:
        if not path:
            return None
        outer = find_socket(path[-1].inputs, socket.identifier)
        return self._value(outer, path[:-1]) if outer is not None else None

    def _group(self, node: Any, socket: Any, path: Path) -> Value | None:
        if node.node_tree is None or any(group.node_tree == node.node_tree for group in path):
            return None
        inner = (*path, node)
        output = self.tree(inner).group_output()
        if output is None:
            return None
        end = find_socket(output.inputs, socket.identifier)
        return self._value(end, inner) if end is not None else None
