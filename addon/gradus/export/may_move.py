"""Whether other frames may show an object elsewhere or in another shape, by what it has that could move it.

A hint for frames that are read on their own: what does not move is kept from frame to frame, and what is taken for the other costs
time, nothing else. It is of the file and not of the frames that were rendered, so that a frame is the same in whatever job it is.
"""

from __future__ import annotations

from typing import Any

_STEADY_MODIFIERS = frozenset((
    "ARRAY", "BEVEL", "BOOLEAN", "COLLISION", "CORRECTIVE_SMOOTH", "DATA_TRANSFER", "DECIMATE", "EDGE_SPLIT", "LAPLACIANSMOOTH", "MASK",
    "MIRROR", "MULTIRES", "NORMAL_EDIT", "REMESH", "SCREW", "SKIN", "SMOOTH", "SOLIDIFY", "SUBSURF", "TRIANGULATE", "UV_PROJECT",
    "UV_WARP", "WEIGHTED_NORMAL", "WELD", "WIREFRAME",
))  # fmt: skip
"""What they make changes with their own values alone, which are animated by the object's animation data."""

_RESTLESS_NODES = frozenset((
    "GeometryNodeBake", "GeometryNodeCameraInfo", "GeometryNodeCollectionInfo", "GeometryNodeDeformCurvesOnSurface",
    "GeometryNodeImageTexture", "GeometryNodeInputSceneTime", "GeometryNodeObjectInfo", "GeometryNodeSimulationOutput",
))  # fmt: skip
"""They read the frame, or what other objects show in it."""


class MayMove:
    """The hints of one export, in which parents and groups of nodes are looked at once for all that share them."""

    def __init__(self) -> None:
        self._carried: dict[int, bool] = {}
        self._restless: dict[int, bool] = {}

    def __call__(self, obj: Any, instancer: Any = None) -> bool:
        """Of an object, or of its instances that an instancer makes."""
        return self._moves(obj.original) or (instancer is not None and self._moves(instancer.original))

    def _moves(self, obj: Any) -> bool:
        return self._is_carried(obj) or self._is_deformed(obj)

    def _is_carried(self, obj: Any) -> bool:
        """By itself, or by what it hangs on. Parents form no ring."""
        found = self._carried.get(obj.as_pointer())
        if found is None:
            found = self._carried[obj.as_pointer()] = _moves_itself(obj) or (
                obj.parent is not None and (obj.parent_type != "OBJECT" or self._is_carried(obj.parent))
            )
        return found

    def _is_deformed(self, obj: Any) -> bool:
        if any(self._is_restless(modifier) for modifier in obj.modifiers):
            return True
        data = obj.data
        return data is not None and (_is_animated(data) or _is_animated(getattr(data, "shape_keys", None)))

    def _is_restless(self, modifier: Any) -> bool:
        if modifier.type == "NODES":
            return modifier.node_group is not None and self._has_restless_nodes(modifier.node_group)
        return modifier.type not in _STEADY_MODIFIERS

    def _has_restless_nodes(self, group: Any) -> bool:
        """Groups hold no ring of groups."""
        found = self._restless.get(group.as_pointer())
        if found is None:
            found = self._restless[group.as_pointer()] = _is_animated(group) or any(
                node.bl_idname in _RESTLESS_NODES or (node.type == "GROUP" and node.node_tree and self._has_restless_nodes(node.node_tree))
                for node in group.nodes
            )
        return found


def _moves_itself(obj: Any) -> bool:
    body = obj.rigid_body
    return _is_animated(obj) or len(obj.constraints) > 0 or (body is not None and body.type == "ACTIVE")


def _is_animated(owner: Any) -> bool:
    animation = getattr(owner, "animation_data", None)
    if animation is None:
        return False
    return animation.action is not None or len(animation.drivers) > 0 or len(animation.nla_tracks) > 0
