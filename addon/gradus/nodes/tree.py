"""The links of a node tree by socket. `socket.links` would search all links of the tree in each call."""

from __future__ import annotations

from typing import Any


class Tree:
    """The links of a node tree by their input socket, without muted and invalid links."""

    def __init__(self, node_tree: Any) -> None:
        self.node_tree = node_tree
        self._sources: dict[int, tuple[Any, Any]] = {}
        for link in node_tree.links:
            if link.is_valid and not link.is_muted:
                self._sources[link.to_socket.as_pointer()] = (link.from_node, link.from_socket)

    def source(self, socket: Any) -> tuple[Any, Any] | None:
        """Returns the node and the output that are linked to an input, or None."""
        return self._sources.get(socket.as_pointer())

    def group_output(self) -> Any:
        """Returns the active group output node, or None."""
        outputs = [node for node in self.node_tree.nodes if node.bl_idname == "NodeGroupOutput"]
        for node in outputs:
            if node.is_active_output:
                return node
        return outputs[0] if outputs else None


def find_socket(sockets: Any, *identifiers: str) -> Any:
    """Returns the socket with the first identifier that exists, or None.

    Identifiers differ between versions of Blender.
    """
    for identifier in identifiers:
        for socket in sockets:
            if socket.identifier == identifier:
                return socket
    return None
