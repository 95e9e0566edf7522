"""The prediction of motion, by which the library keeps static objects from frame to frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import pytest
from support import recording

MAY_MOVE = 256


def _moving(scene: bpy.types.Scene, **arguments: Any) -> set[str]:
    recorded, _ = recording.export(scene, **arguments)
    pairs = zip(recorded.instances["names"], recorded.instances["visibility"], strict=True)
    return {name for name, bits in pairs if bits & MAY_MOVE}


def _keyed(obj: bpy.types.Object) -> None:
    for frame in (1, 2):
        obj.keyframe_insert("location", frame=frame)


def _driven(obj: bpy.types.Object) -> None:
    obj.driver_add("location", 0)


def _constrained(obj: bpy.types.Object) -> None:
    obj.constraints.new("COPY_LOCATION")


def _child(obj: bpy.types.Object) -> None:
    grandparent, parent = recording.add(None, "Grandparent"), recording.add(None, "Parent")
    _keyed(grandparent)
    parent.parent = grandparent
    obj.parent = parent


def _waving(obj: bpy.types.Object) -> None:
    obj.modifiers.new("Wave", "WAVE")


def _shaped(obj: bpy.types.Object) -> None:
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Other")
    for frame in (1, 2):
        obj.data.shape_keys.key_blocks["Other"].keyframe_insert("value", frame=frame)


def _on_a_bone(obj: bpy.types.Object) -> None:
    bpy.ops.object.armature_add()
    obj.parent, obj.parent_type, obj.parent_bone = bpy.context.object, "BONE", "Bone"


def _falling(obj: bpy.types.Object) -> None:
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.object_add()


def _lying(obj: bpy.types.Object) -> None:
    _falling(obj)
    obj.rigid_body.type = "PASSIVE"


def _node_group(*nodes: str) -> bpy.types.NodeTree:
    """Returns a group without effect that contains a group with the given nodes."""
    inner, outer = (bpy.data.node_groups.new(name, "GeometryNodeTree") for name in ("Inner", "Outer"))
    for node in nodes:
        inner.nodes.new(node)
    outer.nodes.new("GeometryNodeGroup").node_tree = inner
    if hasattr(outer, "interface"):
        for way in ("INPUT", "OUTPUT"):
            outer.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    else:
        for sockets in (outer.inputs, outer.outputs):
            sockets.new("NodeSocketGeometry", "Geometry")
    ends = [outer.nodes.new(name) for name in ("NodeGroupInput", "NodeGroupOutput")]
    outer.links.new(ends[0].outputs[0], ends[1].inputs[0])
    return outer


def _timed(obj: bpy.types.Object) -> None:
    obj.modifiers.new("Nodes", "NODES").node_group = _node_group(
        "GeometryNodeSetPosition", "GeometryNodeInputSceneTime"
    )


def _smooth(obj: bpy.types.Object) -> None:
    """Adds the node modifier with which Blender 4.1 replaces the auto smooth setting of older files."""
    obj.modifiers.new("Nodes", "NODES").node_group = _node_group(
        "GeometryNodeSetShadeSmooth", "GeometryNodeInputMeshEdgeAngle"
    )
    obj.modifiers.new("Empty", "NODES")


def _refined(obj: bpy.types.Object) -> None:
    obj.modifiers.new("Subdivision", "SUBSURF")
    obj.shape_key_add(name="Basis")


def _hung(obj: bpy.types.Object) -> None:
    obj.parent = recording.add(None, "Parent")


MOVING = [_keyed, _driven, _constrained, _child, _waving, _shaped, _on_a_bone, _falling, _timed]


@pytest.mark.parametrize("change", MOVING)
def test_causes_of_motion_are_predicted(scene: bpy.types.Scene, change: Callable[[bpy.types.Object], None]) -> None:
    recording.add_camera()
    recording.add(recording.grid(1), "Room")
    change(recording.add(recording.grid(2), "Ball"))
    assert _moving(scene) == {"Ball"}


@pytest.mark.parametrize("change", [_refined, _hung, _lying, _smooth])
def test_objects_without_causes_of_motion_are_predicted_as_static(
    scene: bpy.types.Scene, change: Callable[[bpy.types.Object], None]
) -> None:
    recording.add_camera()
    change(recording.add(recording.grid(1), "Room"))
    assert _moving(scene) == set()


def test_exports_with_motion_need_no_prediction(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    _keyed(recording.add(recording.grid(2), "Ball"))
    assert _moving(scene, vectors=True) == set()
    scene.render.use_motion_blur = True
    assert _moving(scene) == set()


def test_lights_have_no_prediction(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    _keyed(recording.add(bpy.data.lights.new("Light", "POINT"), "Light"))
    recorded, _ = recording.export(scene)
    assert [light.visibility & MAY_MOVE for light in recorded.lights] == [0]


def test_instances_move_with_their_instancer(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    source = bpy.data.collections.new("Source")
    source.objects.link(bpy.data.objects.new("Inner", recording.grid(1)))
    for name in ("Still", "Moving"):
        empty = recording.add(None, name)
        empty.instance_type = "COLLECTION"
        empty.instance_collection = source
    _keyed(bpy.data.objects["Moving"])
    recorded, _ = recording.export(scene)
    assert sorted(bits & MAY_MOVE for bits in recorded.instances["visibility"]) == [0, MAY_MOVE]


def test_the_prediction_is_the_same_in_every_frame(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    _keyed(recording.add(recording.grid(2), "Ball"))
    for frame in (1, 2, 50):
        scene.frame_set(frame)
        assert _moving(scene) == {"Ball"}
