"""Keyframes of animated properties, in every Blender version."""

from __future__ import annotations

from typing import Any

import bpy
from gradus import compat


def key(owner: Any, path: str, frames: dict[int, Any]) -> None:
    """Inserts keyframes with linear interpolation; `value` by frame."""
    preferences = bpy.context.preferences.edit
    before = preferences.keyframe_new_interpolation_type
    preferences.keyframe_new_interpolation_type = "LINEAR"
    for frame, value in frames.items():
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    preferences.keyframe_new_interpolation_type = before
    make_linear(owner.id_data)


def step(block: bpy.types.ID, path: str, frames: dict[int, Any]) -> None:
    """Inserts keyframes with constant interpolation; the path may lead into a property group of the datablock."""
    group, _, name = path.rpartition(".")
    for frame, value in frames.items():
        setattr(block.path_resolve(group) if group else block, name, value)
        block.keyframe_insert(path, frame=frame)
    _interpolate(block, "CONSTANT", path)


def make_linear(block: bpy.types.ID) -> None:
    """Makes all keyframes of a datablock's action linear, including those of other users of the action."""
    _interpolate(block, "LINEAR")


def _interpolate(block: bpy.types.ID, interpolation: str, path: str = "") -> None:
    for curve in compat.action_curves(block.animation_data.action):
        if path in ("", curve.data_path):
            for point in curve.keyframe_points:
                point.interpolation = interpolation
    block.animation_data.action.update_tag()
