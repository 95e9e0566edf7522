"""The compositor of a scene, in any version of Blender."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import bpy

from support import images


def tree_of(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    """Returns the compositor's tree; since 5.0, it is a group that several scenes may share."""
    return getattr(scene, "compositing_node_group", None) or scene.node_tree


def new_tree(scene: bpy.types.Scene) -> tuple[bpy.types.NodeTree, bpy.types.Node, bpy.types.NodeSocket]:
    """Returns a tree with the scene's render and the input of its output, which are not linked yet."""
    if hasattr(scene, "compositing_node_group"):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    return tree, tree.nodes.new("CompositorNodeRLayers"), output.inputs[0]


def render_muted(
    sample: Path,
    folder: Path,
    muted: Iterable[str],
    *,
    percentage: int,
    change: Callable[[bpy.types.Scene], None] | None = None,
    **settings: Any,
) -> images.Passes:
    """Renders a sample with a compositor after `change`, with nodes muted; returns all passes and the composite."""
    bpy.ops.wm.open_mainfile(filepath=str(sample))
    scene = bpy.context.scene
    assert (scene.render.engine, scene.render.use_compositing) == ("GRADUS", True)
    scene.render.resolution_percentage = percentage
    for name in muted:
        tree_of(scene).nodes[name].mute = True
    if change is not None:
        change(scene)
    return images.render(scene, folder, noise_threshold=0.0, **settings)
