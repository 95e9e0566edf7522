"""Motion blur: the export while the shutter is open, and images that equal those of Cycles in the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus.export.shutter import position_owner
from support import animation, images, recording
from support.animation import key
from support.nodes import new_material, show

EXACT = {"integrator": "PATH", "reconstruction": "NONE", "max_bounces": 0}


def moving_key_shape(obj: bpy.types.Object, by: tuple[float, float, float], frames: dict[int, float]) -> None:
    obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Moved")
    for point in shape.data:
        point.co += type(point.co)(by)
    key(shape, "value", frames)


@pytest.fixture
def blurred(scene: bpy.types.Scene) -> bpy.types.Scene:
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.5
    return scene


def export(scene: bpy.types.Scene, frame: int = 5) -> recording.Recording:
    scene.frame_set(frame)
    recorded, report = recording.export(scene)
    assert scene.frame_current == frame, "the frame is the user's again"
    recorded.warnings = report.warnings
    return recorded


# -------------------------------------------------------------------------------- what the export reads


@pytest.mark.parametrize(("position", "start"), [("START", 0.0), ("CENTER", -0.25), ("END", -0.5)])
def test_the_exposure_begins_ends_or_is_centred_at_the_frame(
    blurred: bpy.types.Scene, position: str, start: float
) -> None:
    owner = position_owner(blurred)
    if owner is None:
        pytest.skip("Cycles, which has the setting, is not in this Blender")
    owner.motion_blur_position = position
    obj = recording.add(recording.grid(1), "Moving")
    key(obj, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    recorded = export(blurred)
    assert (recorded.shutter["open"], recorded.shutter["close"]) == (start, start + 0.5)
    (matrices,) = recorded.instances["shutter"]
    assert np.allclose(matrices[:, 3, 0], 5.0 + start + np.array([0.0, 0.25, 0.5]), atol=1e-5)
    assert recorded.instances["matrices"][0][3][0] == pytest.approx(5.0, abs=1e-5)


def test_only_moving_objects_have_keys(blurred: bpy.types.Scene) -> None:
    recording.add(recording.grid(1), "Still")
    key(recording.add(recording.grid(1, name="Other"), "Moving"), "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    recorded = export(blurred)
    by_name = dict(zip(recorded.instances["names"], recorded.instances["shutter"], strict=True))
    assert by_name["Still"] is None
    assert len(by_name["Moving"]) == 3
    assert recorded.shutter["matrices"] is None
    assert all(mesh.shutter is None for mesh in recorded.meshes.values())


def test_the_camera_moves_and_zooms(blurred: bpy.types.Scene) -> None:
    recording.add(recording.grid(1))
    key(blurred.camera, "location", {0: (0, 0, 5), 10: (0, 0, 15)})
    key(blurred.camera.data, "ortho_scale", {0: 4.0, 10: 8.0})
    recorded = export(blurred)
    assert np.allclose(recorded.shutter["matrices"][:, 3, 2], [9.75, 10.0, 10.25], atol=1e-4)
    assert np.allclose(recorded.shutter["windows"][:, 1], [0.5 * (4.0 + 0.4 * t) for t in (4.75, 5.0, 5.25)], atol=1e-4)


def bind_another_camera(scene: bpy.types.Scene, frame: int) -> None:
    """Adds markers that switch to another camera at a frame."""
    first, second = scene.camera, recording.add_camera(type="PERSP", lens=60.0)
    first.location, first.rotation_euler = (3.0, 0.0, 5.0), (0.0, 0.5, 0.0)
    for start, camera in ((1, first), (frame, second)):
        scene.timeline_markers.new(f"cut {start}", frame=start).camera = camera
    scene.frame_set(frame)


def test_a_shot_change_by_markers_does_not_mix_two_cameras(blurred: bpy.types.Scene) -> None:
    """Regression: the first frame after a shot change was blurred between both cameras."""
    recording.add(recording.grid(1))
    bind_another_camera(blurred, 5)
    blurred.view_layers[0].use_pass_vector = True
    recorded = export(blurred, 5)
    assert recorded.shutter["matrices"] is None, "each camera is static"
    assert np.isnan(recorded.camera.matrix_previous).all(), "across the shot change the camera has no position"
    assert list(recorded.camera.matrix_next) == list(recorded.camera.matrix)
    for name in ("previous", "next"):
        assert list(getattr(recorded.camera, f"window_{name}")) == list(recorded.camera.window)


def test_a_deforming_mesh_has_positions(blurred: bpy.types.Scene) -> None:
    obj = recording.add(recording.grid(1), "Deforming")
    moving_key_shape(obj, (0, 0, 1), {0: 0.0, 10: 1.0})
    (mesh,) = export(blurred).meshes.values()
    assert np.allclose(mesh.shutter[:, 0, 2], [0.475, 0.5, 0.525], atol=1e-5)
    assert mesh.keys == 1, "without pass Vector the frames around are not read"


def test_a_mesh_that_its_parent_deforms_is_blurred(blurred: bpy.types.Scene) -> None:
    """Regression: such a mesh has no modifier and was exported as rigid, for motion blur and pass Vector."""
    bpy.ops.object.armature_add()
    armature, obj = bpy.context.object, recording.add(recording.grid(1))
    obj.parent, obj.parent_type = armature, "ARMATURE"
    bone = armature.pose.bones[0]
    obj.vertex_groups.new(name=bone.name).add(range(4), 1.0, "REPLACE")
    key(bone, "location", {0: (0, 0, 0), 10: (0, 1, 0)})  # along the upright bone
    blurred.view_layers[0].use_pass_vector = True
    (mesh,) = export(blurred).meshes.values()
    assert np.allclose(mesh.shutter[:, 0, 2], [0.475, 0.5, 0.525], atol=1e-4)
    assert np.allclose(mesh.positions[:, 0, 2], [0.4, 0.5, 0.6], atol=1e-4)


def instances_of(collection: bpy.types.Collection, count: int) -> list[bpy.types.Object]:
    copies = [recording.add(None, f"Copy {index}", (3.0 * index, 0, 0)) for index in range(count)]
    for copy in copies:
        copy.instance_type, copy.instance_collection = "COLLECTION", collection
    return copies


@pytest.fixture
def deforming_part() -> bpy.types.Collection:
    """Returns a collection outside the scene with an object whose mesh deforms."""
    collection, part = bpy.data.collections.new("Parts"), bpy.data.objects.new("Part", recording.grid(1))
    collection.objects.link(part)
    moving_key_shape(part, (0, 0, 1), {0: 0.0, 10: 1.0})
    return collection


def test_instances_are_blurred_though_the_first_is_not_there_all_the_time(
    blurred: bpy.types.Scene, deforming_part: bpy.types.Collection
) -> None:
    """Regression: all instances were sharp if the first one did not exist at one of the times of the shutter."""
    copy = instances_of(deforming_part, 3)[0]
    animation.step(copy, "hide_render", {1: True, 5: False})
    animation.step(copy, "hide_viewport", {1: True, 5: False})
    recorded = export(blurred)
    (mesh,) = recorded.meshes.values()
    assert recorded.instances["count"] == 3
    assert np.allclose(mesh.shutter[:, 0, 2], [0.475, 0.5, 0.525], atol=1e-5)
    assert of_topology(recorded.warnings) == []


def test_a_sharp_instance_leaves_the_others_their_blur(
    blurred: bpy.types.Scene, deforming_part: bpy.types.Collection
) -> None:
    sharp, more, *_ = instances_of(deforming_part, 4)
    if not hasattr(sharp, "cycles"):
        pytest.skip("Cycles, which has the settings, is not in this Blender")
    sharp.cycles.use_motion_blur, more.cycles.motion_steps = False, 3
    recorded = export(blurred)
    found = [recorded.meshes[key].shutter for key in recorded.instances["meshes"]]
    assert [None if keys is None else len(keys) for keys in found] == [None, 9, 3, 3]
    assert len(recorded.meshes) == 3, "those alike share a mesh"


def test_vectors_and_blur_are_read_together(blurred: bpy.types.Scene) -> None:
    obj = recording.add(recording.grid(1), "Deforming")
    moving_key_shape(obj, (0, 0, 1), {0: 0.0, 10: 1.0})
    key(obj, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    key(blurred.camera, "location", {0: (0, 0, 5), 10: (0, 0, 15)})
    blurred.view_layers[0].use_pass_vector = True
    recorded = export(blurred)
    (mesh,) = recorded.meshes.values()
    assert np.allclose(mesh.positions[:, 0, 2], [0.4, 0.5, 0.6], atol=1e-5)
    assert np.allclose(mesh.shutter[:, 0, 2], [0.475, 0.5, 0.525], atol=1e-5)
    assert np.allclose([recorded.instances[name][0][3][0] for name in ("previous", "next")], [4.0, 6.0], atol=1e-5)
    assert np.allclose([recorded.camera.matrix_previous[14], recorded.camera.matrix_next[14]], [9.0, 11.0], atol=1e-4)


def add_growing(name: str, counts: dict[int, int]) -> bpy.types.Object:
    """Adds a mesh that has as many squares as the number of the frame."""
    obj = recording.add(recording.grid(2, name=name), name)
    modifier = obj.modifiers.new("Array", "ARRAY")
    animation.step(obj, f'modifiers["{modifier.name}"].count', counts)
    return obj


def of_topology(warnings: list[str]) -> list[str]:
    return [text for text in warnings if "topology" in text.lower()]


def test_meshes_that_change_their_topology_are_static_with_a_warning_each(blurred: bpy.types.Scene) -> None:
    for name in ("First", "Second"):
        add_growing(name, {1: 1, 5: 4})
    recorded = export(blurred)
    assert all(mesh.shutter is None for mesh in recorded.meshes.values())
    assert [name in text for text, name in zip(of_topology(recorded.warnings), ("First", "Second"), strict=True)] == [
        True,
        True,
    ]


def test_a_warning_of_topology_is_the_same_in_all_frames(blurred: bpy.types.Scene) -> None:
    """Regression: the warning counted objects, so that an animation had many different warnings."""
    add_growing("First", {1: 1, 5: 4, 6: 9})
    add_growing("Second", {1: 1, 6: 2})
    first, second = (of_topology(export(blurred, frame).warnings) for frame in (5, 6))
    assert len(first) == 1 and first[0] in second


def test_topology_outside_the_exposure_gives_no_warning(blurred: bpy.types.Scene) -> None:
    """A mesh that is static during the exposure gives no warning.

    Regression: it did if pass Vector read the next frame, whose topology differs.
    """
    add_growing("Growing", {1: 1, 6: 4})
    blurred.view_layers[0].use_pass_vector = True
    assert of_topology(export(blurred, 5).warnings) == []


def test_velocities_blur_meshes_whose_topology_changes(blurred: bpy.types.Scene) -> None:
    mesh = recording.grid(1)
    velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    for item in velocity.data:
        item.vector = (24.0, 0.0, 0.0)  # metres per second, at 24 frames per second
    recording.add(mesh)
    (found,) = export(blurred).meshes.values()
    assert np.allclose(found.shutter[:, :, 0] - found.positions[0][:, 0], [[-0.25] * 4, [0.25] * 4], atol=1e-6)


def test_the_curve_of_the_shutter_is_exported(blurred: bpy.types.Scene) -> None:
    recording.add(recording.grid(1))
    assert export(blurred).shutter["curve"] is None, "open all the time"
    mapping = blurred.render.motion_blur_shutter_curve
    points = mapping.curves[0].points
    points[0].location, points[1].location = (0.0, 0.0), (1.0, 1.0)
    points[0].handle_type = points[1].handle_type = "VECTOR"
    mapping.update()
    found = export(blurred).shutter["curve"]
    assert np.allclose(found, np.linspace(0.0, 1.0, len(found)), atol=0.01)


def test_the_view_layer_may_disable_motion_blur(blurred: bpy.types.Scene) -> None:
    key(recording.add(recording.grid(1)), "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    blurred.view_layers[0].use_motion_blur = False
    recorded = export(blurred)
    assert recorded.instances["shutter"] == [None]
    assert recorded.shutter["close"] <= recorded.shutter["open"]


def test_objects_have_steps_and_switches_of_their_own(blurred: bpy.types.Scene) -> None:
    objects = [
        recording.add(recording.grid(cells, name=name), name)
        for cells, name in enumerate(("Sharp", "Smooth", "Rigid"), 1)
    ]
    if not hasattr(objects[0], "cycles"):
        pytest.skip("Cycles, which has the settings, is not in this Blender")
    for obj in objects:
        key(obj, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
        moving_key_shape(obj, (0, 0, 1), {0: 0.0, 10: 1.0})
    objects[0].cycles.use_motion_blur = False
    objects[1].cycles.motion_steps = 3
    objects[2].cycles.use_deform_motion = False
    recorded = export(blurred)
    found = dict(zip(recorded.instances["names"], recorded.instances["shutter"], strict=True))
    meshes = {mesh.name: mesh.shutter for mesh in recorded.meshes.values()}
    assert found["Sharp"] is None and meshes["Sharp"] is None
    assert len(found["Smooth"]) == 9 and len(meshes["Smooth"]) == 9
    assert len(found["Rigid"]) == 3 and meshes["Rigid"] is None


# -------------------------------------------------------------------------------- pictures


def glowing(obj: bpy.types.Object) -> None:
    material = new_material()
    rgb = material.node_tree.nodes.new("ShaderNodeRGB")
    rgb.outputs[0].default_value = (1.0, 1.0, 1.0, 1.0)
    show(material, rgb.outputs[0])
    obj.data.materials.append(material)


def test_a_moving_square_has_the_coverage_of_a_tent_function(
    blurred: bpy.types.Scene, render: Callable[..., Any]
) -> None:
    """The square is 2 m wide and moves 2 m while the shutter is open, so that its coverage is a tent function."""
    obj = recording.add(recording.grid(1))
    glowing(obj)
    key(obj, "location", {0: (-20, 0, 0), 10: (20, 0, 0)})
    found = render(blurred, frame=5, samples=256, pixel_filter="BOX", **EXACT)["Combined"][18, :, 0]
    centres = (np.arange(64) + 0.5) / 16.0 - 2.0
    expected = np.clip(1.0 - np.abs(centres) / 2.0, 0.0, 1.0)
    assert np.abs(found - expected).max() < 0.05
    assert np.abs(found - expected).mean() < 0.01


@pytest.mark.parametrize("frame", [4, 5])
def test_pictures_beside_a_shot_change_by_markers_show_one_camera(
    frame: int, blurred: bpy.types.Scene, render: Callable[..., Any]
) -> None:
    glowing(recording.add(recording.grid(1)))
    bind_another_camera(blurred, 5)
    blurred.view_layers[0].use_pass_vector = True
    found = render(blurred, frame=frame, samples=16, vector_with_motion_blur=True, **EXACT)
    blurred.render.use_motion_blur = False
    still = render(blurred, frame=frame, samples=16, **EXACT)
    assert 0.05 < still["Combined"].mean() < 0.95, "there is an edge that could be smeared"
    assert np.abs(found["Combined"] - still["Combined"]).mean() < 0.01
    assert not found["Vector"].any() and not still["Vector"].any()


def test_vectors_are_0_under_blur_unless_requested(blurred: bpy.types.Scene, render: Callable[..., Any]) -> None:
    obj = recording.add(recording.grid(1, 6.0))
    key(obj, "location", {0: (0, 0, 0), 10: (1, 0, 0)})
    blurred.view_layers[0].use_pass_vector = True
    assert not render(blurred, frame=5, samples=4, **EXACT)["Vector"].any()
    found = render(blurred, frame=5, samples=4, vector_with_motion_blur=True, **EXACT)["Vector"]
    assert np.allclose(found, (-1.6, 0.0, -1.6, 0.0), atol=0.01)


def _turning(scene: bpy.types.Scene) -> None:
    obj = recording.add(recording.grid(1, 2.5))
    obj.scale = (1.0, 0.3, 1.0)
    glowing(obj)
    key(obj, "rotation_euler", {0: (0, 0, 0), 10: (0, 0, 25.0)})


def _deforming(scene: bpy.types.Scene) -> None:
    obj = recording.add(recording.grid(3, 2.0))
    glowing(obj)
    moving_key_shape(obj, (1.0, 0.5, 0.0), {0: -5.0, 10: 5.0})


def _orbit(scene: bpy.types.Scene) -> None:
    glowing(recording.add(recording.grid(1, 1.0), "Left", (-1, 0, 0)))
    scene.camera.data.type = "PERSP"
    key(scene.camera, "rotation_euler", {0: (0, 0, -5.0), 10: (0, 0, 5.0)})
    key(scene.camera.data, "lens", {0: 20.0, 10: 120.0})


def _shift(scene: bpy.types.Scene) -> None:
    glowing(recording.add(recording.grid(1, 1.0), "Left", (-1, 0, 0)))
    scene.camera.data.type = "PERSP"
    for name in ("shift_x", "shift_y"):
        key(scene.camera.data, name, {0: -0.5, 10: 0.5})


def _instances(scene: bpy.types.Scene) -> None:
    collection = bpy.data.collections.new("Parts")
    part = bpy.data.objects.new("Part", recording.grid(1, 0.5))
    collection.objects.link(part)
    glowing(part)
    for index in range(3):
        empty = recording.add(None, f"Copy {index}", (0, index - 1.0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        key(empty, "location", {0: (-10.0 * index, index - 1.0, 0), 10: (10.0 * index, index - 1.0, 0)})


def _velocities(scene: bpy.types.Scene) -> None:
    mesh = recording.grid(1, 1.0)
    velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    for index, item in enumerate(velocity.data):
        item.vector = (48.0 if index % 2 else 12.0, 10.0, 0.0)
    glowing(recording.add(mesh))


SCENES = {
    "turning": _turning,
    "deforming": _deforming,
    "orbit": _orbit,
    "shift": _shift,
    "instances": _instances,
    "velocities": _velocities,
}


@pytest.mark.parametrize("position", ["CENTER", "START"])
@pytest.mark.parametrize("name", SCENES)
def test_a9_blur_is_that_of_cycles(name: str, position: str, blurred: bpy.types.Scene, tmp_path: Path) -> None:
    if position_owner(blurred) is None:
        pytest.skip("there is no Cycles in this Blender")
    if name == "velocities" and (position == "START" or bpy.app.version < (4, 0, 0)):
        pytest.skip("Cycles centres velocities at the frame whatever the position says, and in 3.4 it has another unit")
    position_owner(blurred).motion_blur_position = position
    SCENES[name](blurred)
    for obj in blurred.objects:
        obj.cycles.motion_steps = 3
    blurred.cycles.samples, blurred.cycles.use_adaptive_sampling, blurred.cycles.use_denoising = 512, False, False
    blurred.cycles.pixel_filter_type = "BOX"
    pictures = {}
    for engine in ("CYCLES", "GRADUS"):
        blurred.render.engine = engine
        pictures[engine] = images.render(blurred, tmp_path, frame=5, samples=512, pixel_filter="BOX", **EXACT)[
            "Combined"
        ][:, :, :3]
    difference = np.abs(pictures["CYCLES"] - pictures["GRADUS"])
    assert pictures["CYCLES"].mean() > 0.01
    assert difference.mean() < 0.01 * pictures["CYCLES"].mean() + 1e-3
    assert np.quantile(difference, 0.99) < 0.05
