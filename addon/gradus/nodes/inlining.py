"""Trees with nodes that Blender evaluates for renderers: zones, closures, bundles, switches, muted nodes and others.

Among them are groups that pass on the value of a socket which shows none. Blender then decides whether what reads it
has coordinates or a normal of its own, or the value.
"""

from __future__ import annotations

from typing import Any

_WALKED = frozenset(("NodeFrame", "NodeGroupInput", "NodeGroupOutput", "NodeReroute"))
"""Nodes, apart from those of shaders and groups, that the walker follows itself."""


def is_needed(block: Any, tree: Any) -> bool:
    """Returns whether Blender must inline the tree of a material, world or light. It can do so from 5.0 on."""
    return hasattr(block, "inline_shader_nodes") and _has_such_nodes(tree, set())


def _has_such_nodes(tree: Any, seen: set[int]) -> bool:
    if tree is None or tree.as_pointer() in seen:
        return False
    seen.add(tree.as_pointer())
    return any(node.mute or _is_such(node, seen) for node in tree.nodes)


def _is_such(node: Any, seen: set[int]) -> bool:
    if node.type == "GROUP":
        return _has_hidden_values(node) or _has_such_nodes(node.node_tree, seen)
    if node.type == "GROUP_OUTPUT":
        return _has_hidden_values(node)
    return node.bl_idname not in _WALKED and not node.bl_idname.startswith("ShaderNode")


def _has_hidden_values(node: Any) -> bool:
    return any(
        socket.hide_value and not socket.is_linked and hasattr(socket, "default_value") for socket in node.inputs
    )


def has_loop(tree: Any) -> bool:
    """Returns whether links of a tree or of a group in it lead from a node back to it.

    From 5.0 on, Blender makes an empty tree of such a one, and may hang at the second one of a session.
    """
    return _has_loop(tree, set())


def _has_loop(tree: Any, seen: set[int]) -> bool:
    if tree is None or tree.as_pointer() in seen:
        return False
    seen.add(tree.as_pointer())
    targets: dict[int, list[int]] = {}
    waiting: dict[int, int] = {}  # number of links from nodes that are not yet passed
    for link in tree.links:
        source, target = link.from_node.as_pointer(), link.to_node.as_pointer()
        targets.setdefault(source, []).append(target)
        waiting[target] = waiting.get(target, 0) + 1
    ready = [node for node in targets if node not in waiting]
    while ready:
        for target in targets.get(ready.pop(), ()):
            waiting[target] -= 1
            if waiting[target] == 0:
                ready.append(target)
    groups = (node.node_tree for node in tree.nodes if node.type == "GROUP")
    return any(waiting.values()) or any(_has_loop(group, seen) for group in groups)
