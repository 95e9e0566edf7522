"""Trees with zones, closures, bundles, switches or other nodes that Blender evaluates before a renderer sees them."""

from __future__ import annotations

from typing import Any

_WALKED = frozenset(("NodeFrame", "NodeGroupInput", "NodeGroupOutput", "NodeReroute"))
"""Nodes, apart from those of shaders and groups, that the walker follows itself."""


def is_needed(block: Any, tree: Any) -> bool:
    """Returns whether Blender must inline the tree of a material, world or light. It can do so from 5.0 on."""
    return hasattr(block, "inline_shader_nodes") and _has_other_nodes(tree, set())


def _has_other_nodes(tree: Any, seen: set[int]) -> bool:
    if tree is None or tree.as_pointer() in seen:
        return False
    seen.add(tree.as_pointer())
    return any(
        _has_other_nodes(node.node_tree, seen)
        if node.type == "GROUP"
        else node.bl_idname not in _WALKED and not node.bl_idname.startswith("ShaderNode")
        for node in tree.nodes
    )
