"""What is linked to what in a node tree, found once: `socket.links` searches all links of the tree each time."""

from __future__ import annotations

from typing import Any


class Tree:
    """Valid links of a node tree, by the socket they lead to. Muted and invalid links are none."""

    def __init__(self, node_tree: Any) -> None:
        self.node_tree = node_tree
        self._sources: dict[int, tuple[Any, Any]] = {}
        for link in node_tree.links:
            if link.is_valid and not link.is_muted:
                self._sources[link.to_socket.as_pointer()] = (link.from_node, link.from_socket)

    def source(self, socket: Any) -> tuple[Any, Any] | None:
        """Node and output that feed an input."""
        return self._sources.get(socket.as_pointer())

    def group_output(self) -> Any:
        """The group output node that counts; None if there is none."""
        outputs = [node for node in self.node_tree.nodes if node.bl_idname == "NodeGroupOutput"]
        for node in outputs:
            if node.is_active_output:
                return node
        return outputs[0] if outputs else None


def find_socket(sockets: Any, *identifiers: str) -> Any:
    """The first of the given identifiers (aliases over Blender's versions) among a node's sockets; None if there is none."""
    for identifier in identifiers:
        for socket in sockets:
            if socket.identifier == identifier:
                return socket
    return None
