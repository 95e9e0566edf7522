"""Nodes of lights read what they read in Cycles of the same Blender: the light's object, its instancer, and its spaces.

The lights have no extent, so that their pictures have no noise.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix
from support import recording
from support.cycles import pictures

VERSION = tuple(bpy.app.version)
OFFSET = 2.0
"""Is added to all values, so that negative ones show."""

IES = "\n".join(
    (
        "IESNA:LM-63-1995",
        "TILT=NONE",
        "1 -1 1 5 5 1 2 0 0 0",
        "1 1 0",
        "0 30 60 90 180",
        "0 90 180 270 360",
        "900 700 300 100 50",
        "900 200 900 400 60",
        "900 800 200 600 90",
        "900 100 500 200 80",
        "900 700 300 100 50",
    )
)
"""A profile that differs in all directions, but not along its axis."""

SHEAR = Matrix(((1.0, 0.4, 0.0, 0.0), (0.0, 1.5, -0.3, 0.0), (0.2, 0.0, 0.8, 0.0), (0.0, 0.0, 0.0, 1.0)))
"""Scale and shear, as a scaled parent of a rotated light has it."""


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a floor of 6.4 m, seen from above by a turned camera, without a world."""
    camera = recording.add_camera(type="ORTHO", ortho_scale=6.4)
    camera.location, camera.rotation_euler = (0.0, 0.0, 4.0), (0.0, 0.0, 0.4)
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    scene.world = None
    return scene


def add_light(kind: str = "POINT", matrix: Matrix | None = None, **properties: Any) -> bpy.types.Object:
    """Returns a light whose object has all properties, without linking it to the scene."""
    data = bpy.data.lights.new("Light", kind)
    data.energy, data.use_nodes = (1.0 if kind == "SUN" else 100.0), True
    if kind in {"POINT", "SPOT"}:
        data.shadow_soft_size = 0.0
    for name, value in properties.items():
        setattr(data, name, value)
    light = bpy.data.objects.new("Light Object", data)
    light.color, light.pass_index = (0.2, 0.4, 0.6, 0.5), 3
    light["own"], data["of data"] = 0.7, 0.3
    light.matrix_world = (
        Matrix.Translation((0.4, -0.3, 2.0))
        @ Euler((0.3, 0.2, 0.5)).to_matrix().to_4x4()
        @ (Matrix.Diagonal((-1.0, 1.6, 0.7, 1.0)) if matrix is None else matrix)
    )
    return light


def add_instance(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    """Adds an instance of a collection with the light."""
    collection = bpy.data.collections.new("Instanced")
    collection.objects.link(light)
    empty = bpy.data.objects.new("Instancer", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    empty.color, empty.pass_index, empty["of instancer"] = (0.9, 0.8, 0.7, 0.6), 5, 0.4
    empty.location, empty.scale = (0.1, 0.2, 0.1), (1.0, 1.3, 0.9)
    scene.collection.objects.link(empty)


def add_node(light: bpy.types.Object, kind: str, **properties: Any) -> bpy.types.Node:
    node = light.data.node_tree.nodes.new(f"ShaderNode{kind}")
    for name, value in properties.items():
        setattr(node, name, value)
    return node


def show(light: bpy.types.Object, socket: bpy.types.NodeSocket) -> None:
    tree = light.data.node_tree
    add = add_node(light, "VectorMath")
    add.inputs[1].default_value = (OFFSET,) * 3
    tree.links.new(socket, add.inputs[0])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(add.outputs[0], emission.inputs["Color"])


def expect_cycles(scene: bpy.types.Scene, folder: Path, tolerance: float = 0.01) -> None:
    """Compares with Cycles. Its samples have other positions in a pixel, so that single blocks differ a little."""
    expected, found = pictures(scene, folder)
    scale = np.abs(expected).mean()
    assert scale > 0.05, "the picture is black: nothing is compared"
    assert np.abs(expected - found).mean() < tolerance * scale
    assert np.abs(expected - found).max() < 10.0 * tolerance * expected.max()


def sockets() -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yields node, output and properties."""
    for output in ("Location", "Color", "Object Index", "Random", "Alpha"):
        yield "ObjectInfo", output, {}
    for kind in ("OBJECT", "INSTANCER"):
        for name in ("own", "of data", "of instancer", "color", "pass_index", "location", "missing"):
            for output in ("Color", "Alpha", "Fac")[: 3 if name in {"color", "missing"} else 1]:
                yield "Attribute", output, {"attribute_type": kind, "attribute_name": name}
    yield "Attribute", "Color", {"attribute_type": "VIEW_LAYER", "attribute_name": "pass_index"}
    yield "Attribute", "Color", {"attribute_type": "VIEW_LAYER", "attribute_name": "cycles.seed"}
    for output in ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"):
        yield "TexCoord", output, {}
    for output in ("Generated", "UV"):
        yield "TexCoord", output, {"from_instancer": True}
    for output in ("Position", "Normal", "True Normal", "Incoming", "Parametric", "Backfacing", "Random Per Island"):
        yield "NewGeometry", output, {}
    for output in ("View Vector", "View Z Depth", "View Distance"):
        yield "CameraData", output, {}
    yield "UVMap", "UV", {}
    for output in ("Index", "Random", "Age", "Location"):
        yield "ParticleInfo", output, {}
    for output in ("Color", "Alpha"):
        yield "VertexColor", output, {"layer_name": "missing"}
    for kind in ("POINT", "VECTOR", "NORMAL"):
        for start, end in (("WORLD", "OBJECT"), ("OBJECT", "WORLD"), ("CAMERA", "OBJECT"), ("OBJECT", "CAMERA")):
            yield "VectorTransform", "Vector", {"vector_type": kind, "convert_from": start, "convert_to": end}


def name_of(case: tuple[str, str, dict[str, Any]]) -> str:
    return " ".join((case[0], case[1], *map(str, case[2].values())))


@pytest.mark.parametrize("case", sockets(), ids=name_of)
def test_a9_nodes_of_an_instanced_light(
    case: tuple[str, str, dict[str, Any]], stage: bpy.types.Scene, tmp_path: Path
) -> None:
    kind, output, properties = case
    light = add_light()
    add_instance(stage, light)
    node = add_node(light, kind, **properties)
    if kind == "VectorTransform":
        node.inputs[0].default_value = (0.3, 0.5, -0.8)
    show(light, next(socket for socket in node.outputs if output in {socket.name, socket.identifier}))
    expect_cycles(stage, tmp_path)


KINDS = ("POINT", "SPOT", "SUN", "AREA")
COORDINATES = [("TexCoord", name) for name in ("Normal", "UV", "Object", "Camera", "Window", "Generated")]
COORDINATES += [("NewGeometry", name) for name in ("Normal", "Position", "Parametric", "Incoming")]


@pytest.mark.parametrize("matrix", [None, SHEAR], ids=["scaled", "sheared"])
@pytest.mark.parametrize(("node", "output"), COORDINATES)
@pytest.mark.parametrize("kind", KINDS)
def test_a9_coordinates_of_lights(
    kind: str, node: str, output: str, matrix: Matrix | None, stage: bpy.types.Scene, tmp_path: Path
) -> None:
    if kind == "SUN" and output == "Parametric" and VERSION < (4, 0, 0):
        pytest.skip("Cycles does not set it")
    stage.camera.data.type = "PERSP"
    light = add_light(kind, matrix, **({"size": 0.01} if kind == "AREA" else {}))
    stage.collection.objects.link(light)
    show(light, add_node(light, node).outputs[output])
    expect_cycles(stage, tmp_path)


@pytest.mark.parametrize("kind", KINDS)
def test_a9_coordinates_of_another_object(kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    light = add_light(kind, **({"size": 0.01} if kind == "AREA" else {}))
    stage.collection.objects.link(light)
    other = bpy.data.objects.new("Other", None)
    other.location, other.rotation_euler, other.scale = (0.3, 0.2, 0.5), (0.3, 0.2, 0.1), (1.0, 2.0, -1.5)
    stage.collection.objects.link(other)
    show(light, add_node(light, "TexCoord", object=other).outputs["Object"])
    expect_cycles(stage, tmp_path)


@pytest.mark.parametrize("matrix", [None, SHEAR], ids=["scaled", "sheared"])
@pytest.mark.parametrize(
    ("kind", "vector"), [("POINT", None), ("POINT", "Normal"), ("SPOT", None), ("SPOT", "Normal"), ("AREA", None)]
)
def test_a9_a_luminaire_of_an_uneven_scale(
    kind: str, matrix: Matrix | None, vector: str | None, stage: bpy.types.Scene, tmp_path: Path
) -> None:
    if kind == "AREA" and matrix is not None and VERSION < (4, 0, 0):
        pytest.skip("since 2026-11-28: a sheared area light with a profile differs in 3.4, for a reason not yet known")
    light = add_light(kind, matrix, **({"size": 0.01} if kind == "AREA" else {}))
    stage.collection.objects.link(light)
    text = bpy.data.texts.new("Profile")
    text.write(IES)
    node = add_node(light, "TexIES", ies=text)
    node.inputs["Strength"].default_value = 2.0
    tree = light.data.node_tree
    if vector is not None:
        tree.links.new(add_node(light, "TexCoord").outputs[vector], node.inputs["Vector"])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(node.outputs[0], emission.inputs["Strength"])
    expect_cycles(stage, tmp_path)


def add_particles(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    scene.collection.objects.link(light)
    bpy.ops.mesh.primitive_plane_add(size=2.0, location=(0.0, 0.0, 2.0))
    emitter = bpy.context.object
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 3, 1.0, 1.0, 90.0
    settings.physics_type, settings.render_type, settings.instance_object = "NO", "OBJECT", light
    settings.particle_size, settings.size_random = 0.7, 0.5
    emitter.show_instancer_for_render = False
    scene.frame_set(3)


def add_node_instances(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    scene.collection.objects.link(light)
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    line = tree.nodes.new("GeometryNodeMeshLine")
    line.inputs["Count"].default_value = 3
    line.inputs["Offset"].default_value = (0.9, 0.0, 0.3)
    info, points = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeInstanceOnPoints")
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = light, True
    tree.links.new(line.outputs[0], points.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], points.inputs["Instance"])
    tree.links.new(points.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    instancer = bpy.data.objects.new("Instancer", bpy.data.meshes.new("Empty"))
    instancer.location = (-0.8, 0.0, 1.5)
    scene.collection.objects.link(instancer)
    instancer.modifiers.new("Nodes", "NODES").node_group = tree


VARYING = ["ObjectInfo Random", "ObjectInfo Location", "ParticleInfo Index", "ParticleInfo Size"]


@pytest.mark.parametrize("output", VARYING)
@pytest.mark.parametrize("instance", [add_particles, add_node_instances], ids=["particles", "geometry nodes"])
def test_a9_each_instance_of_a_light_has_values_of_its_own(
    instance: Any, output: str, stage: bpy.types.Scene, tmp_path: Path
) -> None:
    light = add_light()
    instance(stage, light)
    kind, name = output.split()
    show(light, next(socket for socket in add_node(light, kind).outputs if socket.name == name))
    expect_cycles(stage, tmp_path, 0.05)  # lights are chosen at random
