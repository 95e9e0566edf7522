"""Passes that the compositor of a scene reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any


def linked_passes(scene: Any, layer: str, names: Iterable[str]) -> list[str]:
    """Returns those passes of a view layer that the compositor reads. A socket whose pass is missing would be 1."""
    wanted = set(names)
    sockets = (socket for node in _render_layers(scene, layer) for socket in node.outputs)
    return sorted({socket.name for socket in sockets if socket.is_linked} & wanted)


def _render_layers(scene: Any, layer: str) -> Iterator[Any]:
    tree = getattr(scene, "compositing_node_group", None)  # from 5.0 on
    if tree is None and scene.use_nodes:
        tree = getattr(scene, "node_tree", None)
    if tree is None or not scene.render.use_compositing:
        return
    for node in tree.nodes:
        is_of_scene = node.type == "R_LAYERS" and node.scene is not None and node.scene.name == scene.name
        if is_of_scene and node.layer == layer and not node.mute:
            yield node
