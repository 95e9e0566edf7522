"""Predicts whether an object may move or deform in other frames, from its animation data, modifiers and parents.

The prediction is used for frames that are exported without their neighbours. The library keeps static objects from
frame to frame, and a wrong prediction only costs time. It depends on the file only and not on the rendered frames, so
that a frame is the same in all jobs.
"""

from __future__ import annotations

from typing import Any

_TIME_INVARIANT_MODIFIERS = frozenset((
    "ARRAY", "BEVEL", "BOOLEAN", "COLLISION", "CORRECTIVE_SMOOTH", "DATA_TRANSFER", "DECIMATE", "EDGE_SPLIT",
    "LAPLACIANSMOOTH", "MASK", "MIRROR", "MULTIRES", "NORMAL_EDIT", "REMESH", "SCREW", "SKIN", "SMOOTH", "SOLIDIFY",
    "SUBSURF", "TRIANGULATE", "UV_PROJECT", "UV_WARP", "WEIGHTED_NORMAL", "WELD", "WIREFRAME",
))  # fmt: skip
"""Their results change only with their own values, which the animation data of the object animates."""

_TIME_DEPENDENT_NODES = frozenset((
    "GeometryNodeBake", "GeometryNodeCameraInfo", "GeometryNodeCollectionInfo", "GeometryNodeDeformCurvesOnSurface",
    "GeometryNodeImageTexture", "GeometryNodeInputSceneTime", "GeometryNodeObjectInfo", "GeometryNodeSimulationOutput",
))  # fmt: skip
"""They read the frame number or other objects."""


class MayMove:
    """The predictions of one export. Shared parents and node groups are examined once."""

    def __init__(self) -> None:
        self._moved: dict[int, bool] = {}
        self._time_dependent: dict[int, bool] = {}

    def __call__(self, obj: Any, instancer: Any = None) -> bool:
        """Returns the prediction for an object, or for its instances by an instancer."""
        return self._moves(obj.original) or (instancer is not None and self._moves(instancer.original))

    def _moves(self, obj: Any) -> bool:
        return self._is_moved(obj) or self._is_deformed(obj)

    def _is_moved(self, obj: Any) -> bool:
        """Returns whether an object or one of its parents may move. Parents never form a cycle."""
        found = self._moved.get(obj.as_pointer())
        if found is None:
            found = self._moved[obj.as_pointer()] = _moves_itself(obj) or (
                obj.parent is not None and (obj.parent_type != "OBJECT" or self._is_moved(obj.parent))
            )
        return found

    def _is_deformed(self, obj: Any) -> bool:
        if any(self._is_time_dependent(modifier) for modifier in obj.modifiers):
            return True
        data = obj.data
        return data is not None and (_is_animated(data) or _is_animated(getattr(data, "shape_keys", None)))

    def _is_time_dependent(self, modifier: Any) -> bool:
        if modifier.type == "NODES":
            return modifier.node_group is not None and self._has_time_dependent_nodes(modifier.node_group)
        return modifier.type not in _TIME_INVARIANT_MODIFIERS

    def _has_time_dependent_nodes(self, group: Any) -> bool:
        """Returns whether a node group may change over time. Groups never contain themselves."""
        found = self._time_dependent.get(group.as_pointer())
        if found is None:
            found = _is_animated(group) or any(map(self._is_time_dependent_node, group.nodes))
            self._time_dependent[group.as_pointer()] = found
        return found

    def _is_time_dependent_node(self, node: Any) -> bool:
        if node.bl_idname in _TIME_DEPENDENT_NODES:
            return True
        return node.type == "GROUP" and node.node_tree is not None and self._has_time_dependent_nodes(node.node_tree)


def _moves_itself(obj: Any) -> bool:
    body = obj.rigid_body
    return _is_animated(obj) or len(obj.constraints) > 0 or (body is not None and body.type == "ACTIVE")


def _is_animated(owner: Any) -> bool:
    animation = getattr(owner, "animation_data", None)
    if animation is None:
        return False
    return animation.action is not None or len(animation.drivers) > 0 or len(animation.nla_tracks) > 0
