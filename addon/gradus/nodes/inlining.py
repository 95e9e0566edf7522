"""Trees with zones, closures, bundles, switches, muted nodes or other nodes that Blender evaluates for renderers."""

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
    return any(
        node.mute or _has_such_nodes(node.node_tree, seen)
        if node.type == "GROUP"
        else node.mute or node.bl_idname not in _WALKED and not node.bl_idname.startswith("ShaderNode")
        for node in tree.nodes
    )
