"""E1 to E5: scenes with little in them, broken data and odd cameras; all in the host's own process.

Broken data affects the broken object only.

Each picture is 160×120 at 8 samples, is there in under 10 s, and has no value that is not finite in any pass.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
from support import images, nodes, recording

NAN, INF = float("nan"), float("inf")
WORLD = 0.3
Render = Callable[..., images.Passes]


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a floor in a grey world, seen from above. Broken objects are in the left half."""
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    scene.gradus.samples, scene.gradus.denoiser = 8, "NONE"  # expected values are exact
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (WORLD, WORLD, WORLD)
    if scene.world.node_tree:  # from Blender 5.0 on there always is one
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (WORLD, WORLD, WORLD, 1.0)
    recording.add(recording.grid(4, size=1.5), "floor", (1.5, 0.0, 0.0))
    recording.add_camera().location = (0.0, 0.0, 6.0)
    layer = scene.view_layers[0]
    for name in (
        "z",
        "normal",
        "uv",
        "position",
        "vector",
        "diffuse_direct",
        "diffuse_indirect",
        "diffuse_color",
        "object_index",
    ):
        setattr(layer, f"use_pass_{name}", True)
    return scene


def picture(scene: bpy.types.Scene, render: Render) -> images.Passes:
    began = time.monotonic()
    passes = render(scene)
    assert time.monotonic() - began < 10.0
    for name, plane in passes.items():
        assert np.isfinite(plane).all(), name
    return passes


def right_half(passes: images.Passes) -> np.ndarray:
    return passes["Combined"][:, 90:, :3]


def empty(stage: bpy.types.Scene) -> None:
    for obj in list(bpy.data.objects):
        if obj.type != "CAMERA":
            bpy.data.objects.remove(obj)


def all_hidden(stage: bpy.types.Scene) -> None:
    for obj in bpy.data.objects:
        obj.hide_render = obj.type != "CAMERA"


@pytest.mark.parametrize("change", [empty, all_hidden])
def test_e1_scenes_without_surfaces_show_the_world(
    stage: bpy.types.Scene, render: Render, change: Callable[..., None]
) -> None:
    change(stage)
    assert np.allclose(picture(stage, render)["Combined"][:, :, :3], WORLD, atol=1e-3)
    stage.world = None
    assert picture(stage, render)["Combined"][:, :, :3].max() == 0.0


def test_e1_without_lights_only_an_emissive_mesh_emits_light(stage: bpy.types.Scene, render: Render) -> None:
    stage.world = None
    assert picture(stage, render)["Combined"][:, :, :3].max() == 0.0
    material = nodes.new_material()
    emission = material.node_tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 2.0
    nodes.show(material, emission.outputs[0])
    light = recording.grid(1, size=1.0)
    light.materials.append(material)
    recording.add(light, "light", (0.0, 0.0, 2.0)).rotation_euler = (0.0, 1.0, 0.0)
    passes = picture(stage, render)
    assert right_half(passes).max() > 0.01


@pytest.mark.parametrize("energy", [0.0, -10.0, 1e38])
@pytest.mark.parametrize("kind", ["POINT", "SUN", "SPOT", "AREA"])
def test_e4_extreme_energies(stage: bpy.types.Scene, render: Render, kind: str, energy: float) -> None:
    light = bpy.data.lights.new("light", kind)
    light.energy = energy
    recording.add(light, "light", (1.5, 0.0, 3.0))
    image = right_half(picture(stage, render))
    assert image.max() > 0.0
    if energy == 0.0:
        assert image.max() < 1.2 * WORLD


ODD_SURFACES = {
    "IOR 0": {"IOR": 0.0},
    "IOR 1": {"IOR": 1.0},
    "IOR 3": {"IOR": 3.0},
    "mirror": {"Metallic": 1.0, "Roughness": 0.0},
    "alpha 0": {"Alpha": 0.0},
}


@pytest.mark.parametrize("name", list(ODD_SURFACES))
@pytest.mark.parametrize("glass", [0.0, 1.0])
def test_e5_odd_surfaces(stage: bpy.types.Scene, render: Render, name: str, glass: float) -> None:
    """Tests an open sheet. Only the world emits light, so that nothing is brighter."""
    material = nodes.new_material()
    surface = material.node_tree.nodes.new("ShaderNodeBsdfPrincipled")
    for key, value in {**ODD_SURFACES[name], "Transmission": glass, "Transmission Weight": glass}.items():
        if key in surface.inputs:
            surface.inputs[key].default_value = value
    nodes.show(material, surface.outputs[0])
    bpy.data.objects["floor"].data.materials.append(material)
    image = picture(stage, render)["Combined"][:, :, :3]
    assert image.min() >= -1e-3 and image.max() < 1.2 * WORLD


def triangle(place: str, value: float) -> bpy.types.Mesh:
    """Adds two triangles, one of which has the value in its vertices, normals, UVs or colours."""
    mesh = bpy.data.meshes.new("broken")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [], [(0, 1, 2), (1, 3, 2)])
    if place == "vertices":
        mesh.vertices.foreach_set("co", [value] * 3 + [1, 0, 0, 0, 1, 0, 1, 1, 0])
    if place == "normals":
        if hasattr(mesh, "use_auto_smooth"):
            mesh.use_auto_smooth = True
        mesh.normals_split_custom_set([(value, value, value)] * 6)
    if place == "UVs":
        mesh.uv_layers.new().data.foreach_set("uv", [value] * 12)
    if place == "colours":
        mesh.color_attributes.new("Color", "FLOAT_COLOR", "POINT").data.foreach_set("color", [value] * 16)
    return mesh


def shows(place: str) -> bpy.types.Material:
    """Returns a material that uses the broken values."""
    material = nodes.new_material()
    tree = material.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    if place in ("UVs", "colours"):
        source = tree.nodes.new("ShaderNodeAttribute")
        source.attribute_name = "UVMap" if place == "UVs" else "Color"
        tree.links.new(source.outputs["Color"], diffuse.inputs["Color"])
    nodes.show(material, diffuse.outputs[0])
    return material


@pytest.mark.parametrize("value", [NAN, INF])
@pytest.mark.parametrize("place", ["vertices", "normals", "UVs", "colours"])
def test_e2_broken_meshes_affect_only_themselves(
    stage: bpy.types.Scene, render: Render, place: str, value: float
) -> None:
    whole = right_half(picture(stage, render))
    mesh = triangle(place, value)
    mesh.materials.append(shows(place))
    recording.add(mesh, "broken", (-2.0, 0.0, 0.0))
    assert np.abs(right_half(picture(stage, render)) - whole).max() < 0.05


MATRICES = {
    "nan": lambda obj: setattr(obj, "location", (NAN, 0, 0)),
    "inf": lambda obj: setattr(obj, "location", (INF, 0, 0)),
    "zero": lambda obj: setattr(obj, "scale", (0, 0, 0)),
    "flat": lambda obj: setattr(obj, "scale", (1, 1, 0)),
    "negative": lambda obj: setattr(obj, "scale", (-1, 1, 1)),
}


def parent_of_scale_zero(obj: bpy.types.Object) -> None:
    obj.parent = recording.add(None, "parent")
    obj.parent.scale = (0, 0, 0)


@pytest.mark.parametrize("name", [*MATRICES, "parent"])
def test_e2_broken_objects_affect_only_themselves(stage: bpy.types.Scene, render: Render, name: str) -> None:
    whole = right_half(picture(stage, render))
    obj = recording.add(recording.grid(1, size=1.0), "broken", (-2.0, 0.0, 0.0))
    MATRICES.get(name, parent_of_scale_zero)(obj)
    passes = picture(stage, render)
    assert np.abs(right_half(passes) - whole).max() < 0.05
    seen = np.ptp(passes["Combined"][:, :70, 0]) > 0.01
    assert seen == (name == "negative")


@pytest.mark.parametrize("name", [*MATRICES, "parent"])
def test_e2_broken_cameras_give_a_picture_or_a_message(stage: bpy.types.Scene, render: Render, name: str) -> None:
    """A camera whose position is not finite is an error with a message; the scale of a camera does not matter."""
    MATRICES.get(name, parent_of_scale_zero)(stage.camera)
    bpy.context.view_layer.update()
    if not np.isfinite(np.array(stage.camera.matrix_world)).all():  # Blender 5.0 does not let infinity through
        with pytest.raises(RuntimeError, match="matrix is not finite"):
            picture(stage, render)
        return
    assert picture(stage, render)["Combined"].max() > 0.0


CAMERAS: dict[str, dict[str, Any]] = {
    "1 mm": {"lens": 1.0},
    "5000 mm": {"lens": 5000.0},
    "tiny": {"type": "ORTHO", "ortho_scale": 1e-6},
    "huge": {"type": "ORTHO", "ortho_scale": 1e6},
    "clip start 0": {"clip_start": 0.0},
    "clip beyond end": {"clip_start": 100.0, "clip_end": 1.0},
    "shifted": {"shift_x": 10.0, "shift_y": -10.0},
    "horizontal": {"sensor_fit": "HORIZONTAL"},
    "vertical": {"sensor_fit": "VERTICAL"},
    "auto": {"sensor_fit": "AUTO"},
}


@pytest.mark.parametrize("name", list(CAMERAS))
def test_e3_odd_cameras_see_the_world(stage: bpy.types.Scene, render: Render, name: str) -> None:
    """Under a world of one colour, every pixel shows that colour, or a floor that it lights."""
    for key, value in CAMERAS[name].items():
        setattr(stage.camera.data, key, value)
    image = picture(stage, render)["Combined"][:, :, :3]
    assert image.min() > 0.0 and image.max() < 1.2 * WORLD


def test_e3_a_panoramic_camera_sees_the_world(stage: bpy.types.Scene, render: Render) -> None:
    stage.camera.data.type = "PANO"
    image = picture(stage, render)["Combined"][:, :, :3]
    assert image.max() > 0.1 and image.max() < 1.2 * WORLD


def test_e3_a_custom_camera_is_named(stage: bpy.types.Scene, render: Render) -> None:
    if "CUSTOM" not in stage.camera.data.bl_rna.properties["type"].enum_items:
        pytest.skip("this Blender has no camera shaders")
    stage.camera.data.type = "CUSTOM"
    with pytest.raises(RuntimeError, match="camera shaders"):
        picture(stage, render)


def test_e3_a_camera_inside_a_mesh_sees_its_inside(stage: bpy.types.Scene, render: Render) -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=stage.camera.location)
    material = nodes.new_material()
    emission = material.node_tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (0.7, 0.7, 0.7, 1.0)
    nodes.show(material, emission.outputs[0])
    bpy.context.object.data.materials.append(material)
    assert np.allclose(picture(stage, render)["Combined"][:, :, :3], 0.7, atol=1e-3)


@pytest.mark.parametrize("size", [(4, 4000), (4000, 4)])
def test_e3_aspect_of_a_thousand(stage: bpy.types.Scene, render: Render, size: tuple[int, int]) -> None:
    stage.render.resolution_x, stage.render.resolution_y = size
    image = picture(stage, render)["Combined"]
    assert image.shape[:2] == size[::-1] and image[:, :, :3].min() > 0.0


def test_e3_a_border_of_one_pixel(stage: bpy.types.Scene, render: Render) -> None:
    whole = picture(stage, render)["Combined"]
    stage.render.use_border = stage.render.use_crop_to_border = True
    stage.render.border_min_x, stage.render.border_max_x = 100.01 / 160.0, 101.01 / 160.0
    stage.render.border_min_y, stage.render.border_max_y = 60.01 / 120.0, 61.01 / 120.0
    one = picture(stage, render)["Combined"]
    assert one.shape[:2] == (1, 1)
    assert one[0, 0, :3] == pytest.approx(whole[60, 100, :3], rel=2e-3)
