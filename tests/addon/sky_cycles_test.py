"""Sky Texture against Cycles of the same Blender: radiance by direction, the mean, and the irradiance of the sun."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images
from support.nodes import new_material, output_of, show

KINDS = tuple(item.identifier for item in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items)
ATMOSPHERES = tuple(kind for kind in KINDS if kind not in {"PREETHAM", "HOSEK_WILKIE"})
AEROSOLS = "aerosol_density" if bpy.app.version >= (5, 0, 0) else "dust_density"
SIZE = 64


@pytest.fixture
def stage() -> bpy.types.Scene:
    """Returns a scene with a camera in a world with nodes.

    Pixels are sampled at their centres, so that engines can be compared pixel by pixel.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = False, False
    scene.cycles.pixel_filter_type = "GAUSSIAN"
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    return scene


def new_sky(tree: bpy.types.NodeTree, kind: str, elevation: float, **properties: Any) -> bpy.types.Node:
    """Adds a Sky Texture, by default without a sun disc, 25 degrees from +y."""
    node = tree.nodes.new("ShaderNodeTexSky")
    node.sky_type = kind
    e, r = math.radians(elevation), math.radians(25.0)
    node.sun_elevation, node.sun_rotation = e, r
    node.sun_direction = (math.cos(e) * math.sin(r), math.cos(e) * math.cos(r), math.sin(e))
    node.sun_disc = False
    for name, value in properties.items():
        setattr(node, name, value)
    return node


def light_world(scene: bpy.types.Scene, node: bpy.types.Node) -> None:
    tree = scene.world.node_tree
    background = next(item for item in tree.nodes if item.bl_idname == "ShaderNodeBackground")
    tree.links.new(node.outputs["Color"], background.inputs["Color"])


def picture(scene: bpy.types.Scene, folder: Path, engine: str, samples: int = 1, width: float = 0.01) -> np.ndarray:
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.filter_width = samples, width
    settings = {
        "samples": samples,
        "integrator": "PATH",
        "reconstruction": "NONE",
        "pixel_filter": "GAUSSIAN",
        "filter_width": width,
    }
    return images.render(scene, folder, **settings)["Combined"][..., :3].astype(np.float64)


def pictures(scene: bpy.types.Scene, folder: Path, **options: Any) -> tuple[np.ndarray, np.ndarray]:
    """Returns the images of Cycles and of Gradus."""
    expected, found = (picture(scene, folder, engine, **options) for engine in ("CYCLES", "GRADUS"))
    assert expected.max() > 0.0
    return expected, found


def calculate(tree: bpy.types.NodeTree, operation: str, *values: Any) -> bpy.types.NodeSocket:
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, value in zip(node.inputs, values, strict=False):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
    return node.outputs[0]


def all_directions(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """Maps UV to directions: azimuth to the right, elevation upwards."""
    coordinates, separate, join = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "SeparateXYZ", "CombineXYZ")
    )
    tree.links.new(coordinates.outputs["UV"], separate.inputs[0])
    azimuth = calculate(tree, "MULTIPLY", separate.outputs[0], 2 * math.pi)
    elevation = calculate(tree, "MULTIPLY_ADD", separate.outputs[1], math.pi, -math.pi / 2)
    for index, function in enumerate(("COSINE", "SINE")):
        flat = calculate(tree, "MULTIPLY", calculate(tree, function, azimuth), calculate(tree, "COSINE", elevation))
        tree.links.new(flat, join.inputs[index])
    tree.links.new(calculate(tree, "SINE", elevation), join.inputs[2])
    return join.outputs[0]


@pytest.fixture
def chart(stage: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene whose plane fills the image and emits the radiance of the sky in all directions."""
    bpy.ops.mesh.primitive_plane_add(size=1.0)
    stage.camera.data.type, stage.camera.data.ortho_scale = "ORTHO", 1.0
    stage.camera.location = (0.0, 0.0, 1.0)
    material = new_material()
    bpy.context.object.data.materials.append(material)
    return stage


def show_sky(scene: bpy.types.Scene, kind: str, elevation: float, **properties: Any) -> bpy.types.Node:
    material = next(item for item in scene.objects if item.type == "MESH").data.materials[0]
    tree = material.node_tree
    node = new_sky(tree, kind, elevation, **properties)
    tree.links.new(all_directions(tree), node.inputs[0])
    show(material, node.outputs[0])
    return node


def expect_equal_charts(scene: bpy.types.Scene, folder: Path) -> None:
    expected, found = pictures(scene, folder)
    weight = np.cos((np.arange(SIZE) + 0.5) / SIZE * math.pi - math.pi / 2)[:, None, None]
    mean = (expected * weight).mean(axis=(0, 1))
    assert np.abs((found * weight).mean(axis=(0, 1)) - mean).max() < 0.005 * mean.max()
    difference = np.abs(found - expected) / (np.abs(expected) + 0.03 * mean.max())
    assert np.quantile(difference, 0.99) < 0.01
    assert difference.max() < 0.1


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("elevation", [50.0, 0.0, -3.0])
def test_a9_sky_by_direction(kind: str, elevation: float, chart: bpy.types.Scene, tmp_path: Path) -> None:
    show_sky(chart, kind, elevation, turbidity=3.3)
    expect_equal_charts(chart, tmp_path)


@pytest.mark.parametrize(("turbidity", "albedo"), [(1.0, 0.0), (10.0, 1.0)])
def test_a9_hosek_wilkie_at_its_ends(turbidity: float, albedo: float, chart: bpy.types.Scene, tmp_path: Path) -> None:
    show_sky(chart, "HOSEK_WILKIE", 40.0, turbidity=turbidity, ground_albedo=albedo)
    expect_equal_charts(chart, tmp_path)


@pytest.mark.parametrize("kind", ATMOSPHERES)
@pytest.mark.parametrize(
    "atmosphere",
    [
        {"altitude": 30000.0},
        {"air_density": 4.0, AEROSOLS: 0.0},
        {AEROSOLS: 10.0, "ozone_density": 0.0},
        {"air_density": 0.0, "ozone_density": 8.0, "sun_elevation": math.radians(4.0)},
    ],
    ids=("high", "clean", "dusty", "airless"),
)
def test_a9_sky_of_other_atmospheres(
    kind: str, atmosphere: dict[str, float], chart: bpy.types.Scene, tmp_path: Path
) -> None:
    show_sky(chart, kind, 20.0, **atmosphere)
    expect_equal_charts(chart, tmp_path)


@pytest.mark.parametrize("kind", KINDS)
def test_a9_sky_on_generated_coordinates(kind: str, chart: bpy.types.Scene, tmp_path: Path) -> None:
    """Without a link, the coordinates are generated ones, which are not directions."""
    node = show_sky(chart, kind, 20.0)
    tree = node.id_data
    tree.links.remove(node.inputs[0].links[0])
    expect_equal_charts(chart, tmp_path)


@pytest.mark.parametrize("kind", KINDS)
def test_a9_world_of_a_turned_sky(kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    tree = stage.world.node_tree
    node = new_sky(tree, kind, 30.0)
    light_world(stage, node)
    mapping, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value = (0.3, -0.2, 1.1)
    tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    stage.camera.data.angle = math.pi / 2
    stage.camera.rotation_euler = (math.pi / 2, 0.0, 0.5)
    expected, found = pictures(stage, tmp_path)
    assert np.quantile(np.abs(found - expected), 0.99) < 0.01 * expected.mean()


@pytest.mark.parametrize("kind", ATMOSPHERES)
@pytest.mark.parametrize("elevation", [70.0, 12.0, 0.1, -0.6])
def test_a9_sun_disc(kind: str, elevation: float, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Compares irradiance, limb darkening and the horizon through a telephoto lens."""
    light_world(
        stage,
        new_sky(stage.world.node_tree, kind, elevation, sun_disc=True, sun_size=math.radians(2.0), sun_intensity=0.7),
    )
    stage.camera.data.angle = math.radians(3.0)
    stage.camera.rotation_euler = (math.pi / 2 + math.radians(elevation), 0.0, -math.radians(25.0))
    expected, found = pictures(stage, tmp_path)
    assert np.abs(found.mean(axis=(0, 1)) - expected.mean(axis=(0, 1))).max() < 0.01 * expected.mean()
    assert np.quantile(np.abs(found - expected), 0.98) < 0.01 * expected.max()


@pytest.mark.parametrize("kind", ATMOSPHERES)
def test_a9_sun_lights_a_plane(kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """A sun of real size lights a plane as in Cycles. Only light sampling finds such a small sun."""
    light_world(stage, new_sky(stage.world.node_tree, kind, 35.0, sun_disc=True))
    bpy.ops.mesh.primitive_plane_add(size=10.0)
    stage.camera.location = (0.0, 0.0, 2.0)
    material = new_material()  # the default surface of 5.0 is not diffuse
    surface = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    material.node_tree.links.new(surface.outputs[0], output_of(material).inputs["Surface"])
    bpy.context.object.data.materials.append(material)
    expected, found = pictures(stage, tmp_path, samples=64)
    assert expected.mean() > 5.0
    assert found.std(axis=(0, 1)).max() < 0.01 * found.mean()
    assert np.abs(found.mean(axis=(0, 1)) / expected.mean(axis=(0, 1)) - 1.0).max() < 0.01
