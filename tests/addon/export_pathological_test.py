"""Pathological scenes are exported without an exception. Their images are tested elsewhere."""

from __future__ import annotations

import bpy
import pytest
from gradus.export import ExportError
from support import recording


def test_e1_empty_scene_with_a_camera(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    scene.world = None
    recorded, report = recording.export(scene)
    assert recorded.instances["count"] == 0 and recorded.lights == [] and recorded.world.material == 0
    assert (report.width, report.height) == (64, 36)


def test_layer_without_sky_has_no_world(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    scene.world = bpy.data.worlds.new("World")
    scene.world.mist_settings.start = 3.0
    assert recording.export(scene)[0].world.material != 0
    scene.view_layers[0].use_sky = False
    world = recording.export(scene)[0].world
    assert world.material == 0 and world.mist_start == 3.0


def test_e1_all_hidden(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    recording.add(recording.grid(1))
    for obj in bpy.data.objects:
        obj.hide_viewport = obj.hide_render = obj.type == "MESH"
    assert recording.export(scene)[0].instances["count"] == 0


def test_e2_parent_of_scale_zero_and_broken_camera(scene: bpy.types.Scene) -> None:
    parent = recording.add(None, "Parent")
    parent.scale = (0, 0, 0)
    recording.add(recording.grid(1)).parent = parent
    camera = recording.add_camera()
    camera.parent = parent
    recorded, _ = recording.export(scene)
    assert recorded.instances["count"] == 1
    camera.parent = None
    camera.location.x = float("nan")
    with pytest.raises(ExportError, match="not finite"):
        recording.export(scene)


@pytest.mark.parametrize(
    "settings",
    [
        {"lens": 1.0},
        {"lens": 5000.0},
        {"type": "ORTHO", "ortho_scale": 1e-6},
        {"type": "ORTHO", "ortho_scale": 1e6},
        {"clip_start": 1e-6},
        {"clip_start": 100.0, "clip_end": 1.0},
        {"shift_x": 10.0, "shift_y": -10.0},
    ],
)
def test_e3_extreme_cameras(scene: bpy.types.Scene, settings: dict[str, object]) -> None:
    recording.add_camera(**settings)
    left, right, bottom, top = recording.export(scene)[0].camera.window
    assert right > left and top > bottom


@pytest.mark.parametrize("width, height", [(1, 1), (1, 4096), (16384, 16)])
def test_e3_aspects(scene: bpy.types.Scene, width: int, height: int) -> None:
    scene.render.resolution_x, scene.render.resolution_y = max(width, 4), max(height, 4)
    recording.add_camera()
    left, right, bottom, top = recording.export(scene)[0].camera.window
    assert (right - left) / (top - bottom) == pytest.approx(max(width, 4) / max(height, 4), rel=1e-4)


def test_e4_ten_thousand_lights(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    data = bpy.data.lights.new("Light", "POINT")
    for index in range(10000):
        recording.add(data, "Light", (index % 100, index // 100, 1))
    recorded, report = recording.export(scene)
    assert len(recorded.lights) == 10000
    assert report.seconds < 5


def _nested_groups(depth: int) -> bpy.types.NodeTree:
    inner = None
    for level in range(depth):
        tree = bpy.data.node_groups.new(f"Group {level}", "ShaderNodeTree")
        output = tree.nodes.new("NodeGroupOutput")
        if hasattr(tree, "interface"):
            tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        else:
            tree.outputs.new("NodeSocketShader", "Shader")
        if inner is None:
            node = tree.nodes.new("ShaderNodeBsdfDiffuse")
        else:
            node = tree.nodes.new("ShaderNodeGroup")
            node.node_tree = inner
        tree.links.new(node.outputs[0], output.inputs[0])
        inner = tree
    return inner


def test_e5_materials(scene: bpy.types.Scene) -> None:
    """Covers no material, an empty slot, eight nested groups, and many materials."""
    recording.add_camera()
    recording.add(recording.grid(1), "None")
    empty = recording.grid(2)
    empty.materials.append(None)
    recording.add(empty, "Empty slot")
    deep = bpy.data.materials.new("Deep")
    deep.use_nodes = True
    deep.node_tree.nodes.clear()
    group = deep.node_tree.nodes.new("ShaderNodeGroup")
    group.node_tree = _nested_groups(8)
    output = deep.node_tree.nodes.new("ShaderNodeOutputMaterial")
    deep.node_tree.links.new(group.outputs[0], output.inputs["Surface"])
    many = recording.grid(3)
    many.materials.append(deep)
    for index in range(100):
        many.materials.append(bpy.data.materials.new(f"Material {index}"))
    recording.add(many, "Many")
    recorded, _ = recording.export(scene)
    materials = dict(zip(recorded.instances["names"], recorded.instances["materials"], strict=True))
    if bpy.app.version < (5, 0, 0):
        assert materials["None"] == [] and materials["Empty slot"] == [0]
    else:
        assert [recorded.materials[key] for key in materials["None"] + materials["Empty slot"]] == [
            "default_surface"
        ] * 2
    assert len(materials["Many"]) == 101


def test_e7_names(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    names = ["ä" * 31, "🙂/\\:", " "]
    for name in names:
        recording.add(recording.grid(1, name=name), name)
    assert set(recording.export(scene)[0].instances["names"]) == set(names)


def test_objects_whose_export_failed_are_set_again(scene: bpy.types.Scene) -> None:
    from gradus.export import Exporter

    class Failing(recording.Recording):
        def scene_set_instances(self, scene_handle: int, reference: object) -> None:
            if self.calls.count("instances") == 0:
                self.calls.append("instances")
                raise RuntimeError("refused")
            super().scene_set_instances(scene_handle, reference)

    recording.add_camera()
    recording.add(recording.grid(1))
    recorded = Failing()
    exporter = Exporter(recorded, 1)
    with pytest.raises(RuntimeError, match="refused"):
        exporter.sync(bpy.context.evaluated_depsgraph_get())
    exporter.sync(bpy.context.evaluated_depsgraph_get())
    assert recorded.calls.count("mesh") == 2 and recorded.instances["count"] == 1


def test_k2_cancel_is_polled(scene: bpy.types.Scene) -> None:
    from gradus.export import Cancelled

    recording.add_camera()
    recording.add(recording.grid(1))
    with pytest.raises(Cancelled):
        recording.export(scene, cancelled=lambda: True)
