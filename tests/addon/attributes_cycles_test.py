"""Attributes of meshes and instances, and nodes that look around, have the values of Cycles in the same Blender.

Values are rendered as emission, so that there is noise at edges only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images, recording
from support.cycles import pictures
from support.nodes import Graph, new_material, op_names, show, translate

VERSION = tuple(bpy.app.version)


def attribute_material(name: str, kind: str, output: str = "Color") -> bpy.types.Material:
    material = new_material(f"{kind} {name}")
    show(material, Graph(material)("Attribute", output, attribute_name=name, attribute_type=kind))
    return material


def expect_cycles(scene: bpy.types.Scene, folder: Path, tolerance: float = 0.02) -> None:
    """Compares with Cycles. Edges are sampled at other positions, so that a few blocks may differ."""
    expected, found = pictures(scene, folder)
    scale = np.abs(expected).mean()
    assert scale > 0.003, "the picture is black: nothing is compared"
    assert np.abs(expected - found).mean() < tolerance * scale
    assert np.quantile(np.abs(expected - found), 0.95) < 5.0 * tolerance * scale


# ------------------------------------------------------------------------------------------------- geometry nodes


class NodeTree:
    """A tree of geometry nodes that turns a geometry into another one."""

    def __init__(self, obj: bpy.types.Object) -> None:
        self.tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
        for kind in ("INPUT", "OUTPUT"):
            if hasattr(self.tree, "interface"):
                self.tree.interface.new_socket("Geometry", in_out=kind, socket_type="NodeSocketGeometry")
            else:
                sockets = self.tree.inputs if kind == "INPUT" else self.tree.outputs
                sockets.new("NodeSocketGeometry", "Geometry")
        self.start = self.tree.nodes.new("NodeGroupInput").outputs[0]
        self.end = self.tree.nodes.new("NodeGroupOutput").inputs[0]
        obj.modifiers.new("Nodes", "NODES").node_group = self.tree

    def add(self, kind: str, *links: bpy.types.NodeSocket | None, **properties: Any) -> bpy.types.Node:
        """Adds a node whose first inputs are linked; None leaves one out."""
        node = self.tree.nodes.new(kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for source, target in zip(links, node.inputs, strict=False):
            if source is not None:
                self.tree.links.new(source, target)
        return node

    def link(self, source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
        self.tree.links.new(source, target)

    def object(self, obj: bpy.types.Object, as_instance: bool = True) -> bpy.types.NodeSocket:
        node = self.add("GeometryNodeObjectInfo")
        node.inputs["Object"].default_value = obj
        node.inputs["As Instance"].default_value = as_instance
        return node.outputs["Geometry"]

    def on_points(self, points: bpy.types.NodeSocket, instance: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        node = self.add("GeometryNodeInstanceOnPoints", points)
        self.link(instance, node.inputs["Instance"])
        return node.outputs[0]

    def store(
        self, geometry: bpy.types.NodeSocket, domain: str, kind: str, name: str, scale: float = 0.25
    ) -> bpy.types.NodeSocket:
        """Stores an attribute that grows with the index."""
        node = self.add("GeometryNodeStoreNamedAttribute", geometry, domain=domain, data_type=kind)
        node.inputs["Name"].default_value = name
        ramp = self.add("ShaderNodeMath", self.add("GeometryNodeInputIndex").outputs[0], operation="MULTIPLY_ADD")
        ramp.inputs[1].default_value, ramp.inputs[2].default_value = scale, 0.2
        value = ramp.outputs[0]
        if kind in {"FLOAT_COLOR", "FLOAT_VECTOR", "FLOAT2", "BYTE_COLOR"}:
            combined = self.add("ShaderNodeCombineXYZ", value)
            combined.inputs[1].default_value = 0.3
            value = combined.outputs[0]
        target = next(item for item in node.inputs if item.enabled and item.name == "Value")
        self.link(value, target)
        return node.outputs[0]


def add_unit(material: bpy.types.Material | None, size: float = 0.4) -> bpy.types.Object:
    """Adds a plane that is not rendered itself."""
    bpy.ops.mesh.primitive_plane_add(size=size, location=(50.0, 50.0, 0.0))
    unit = bpy.context.object
    if material is not None:
        unit.data.materials.append(material)
    return unit


def add_points(location: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[bpy.types.Object, NodeTree]:
    """Adds a plane of 4 points without faces that are seen, and its nodes."""
    bpy.ops.mesh.primitive_plane_add(size=1.6, location=location)
    obj = bpy.context.object
    return obj, NodeTree(obj)


@pytest.fixture
def stage(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a camera above its middle, which sees 6.4 m: a pixel is 0.1 m."""
    recording.add_camera(type="ORTHO", ortho_scale=6.4).location = (0.0, 0.0, 5.0)
    return scene


needs_geometry_in_python = pytest.mark.skipif(VERSION < (4, 5, 0), reason="Python has no geometry of instances")


@needs_geometry_in_python
@pytest.mark.parametrize("output", ["Color", "Vector", "Fac", "Alpha"])
@pytest.mark.parametrize("kind", ["FLOAT_COLOR", "BYTE_COLOR", "FLOAT", "FLOAT_VECTOR", "FLOAT2", "INT", "BOOLEAN"])
def test_a9_attributes_of_instances(kind: str, output: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    unit = add_unit(attribute_material("tint", "INSTANCER", output))
    _, nodes = add_points()
    instances = nodes.on_points(nodes.start, nodes.object(unit))
    nodes.link(nodes.store(instances, "INSTANCE", kind, "tint", 1.0 if kind in {"INT", "BOOLEAN"} else 0.25), nodes.end)
    expect_cycles(stage, tmp_path)


@needs_geometry_in_python
@pytest.mark.parametrize("with_mesh", [False, True])
@pytest.mark.parametrize("stored_on", ["inner", "outer", "both"])
def test_a9_attributes_of_nested_instances(
    stored_on: str, with_mesh: bool, stage: bpy.types.Scene, tmp_path: Path
) -> None:
    """The innermost instances that have an attribute give it. Meshes beside instances shift their numbers."""
    material = attribute_material("tint", "INSTANCER")
    unit = add_unit(material, 0.2)
    _, nodes = add_points()
    grid = nodes.add("GeometryNodeMeshGrid")
    grid.inputs["Vertices X"].default_value = grid.inputs["Vertices Y"].default_value = 2
    grid.inputs["Size X"].default_value = grid.inputs["Size Y"].default_value = 0.6
    inner = nodes.on_points(grid.outputs[0], nodes.object(unit))
    if stored_on in {"inner", "both"}:
        inner = nodes.store(inner, "INSTANCE", "FLOAT_COLOR", "tint", 0.15)
    if with_mesh:
        cube = nodes.add("GeometryNodeMeshCube")
        cube.inputs["Size"].default_value = (0.2, 0.2, 0.2)
        painted = nodes.add("GeometryNodeSetMaterial", cube.outputs[0])
        painted.inputs["Material"].default_value = material
        joined = nodes.add("GeometryNodeJoinGeometry", inner)
        nodes.link(painted.outputs[0], joined.inputs[0])
        inner = joined.outputs[0]
    outer = nodes.on_points(nodes.start, inner)
    if stored_on in {"outer", "both"}:
        outer = nodes.store(outer, "INSTANCE", "FLOAT_COLOR", "tint", 0.3)
    nodes.link(outer, nodes.end)
    expect_cycles(stage, tmp_path)


@needs_geometry_in_python
def test_a9_attributes_of_instances_with_ids_of_their_own(stage: bpy.types.Scene, tmp_path: Path) -> None:
    """The attribute "id" becomes the persistent id of an instance."""
    unit = add_unit(attribute_material("tint", "INSTANCER"))
    _, nodes = add_points()
    instances = nodes.on_points(nodes.start, nodes.object(unit))
    set_id = nodes.add("GeometryNodeSetID", instances)
    number = nodes.add("ShaderNodeMath", nodes.add("GeometryNodeInputIndex").outputs[0], operation="MULTIPLY_ADD")
    number.inputs[1].default_value, number.inputs[2].default_value = -7.0, 100.0
    nodes.link(number.outputs[0], set_id.inputs["ID"])
    nodes.link(nodes.store(set_id.outputs[0], "INSTANCE", "FLOAT_COLOR", "tint"), nodes.end)
    expect_cycles(stage, tmp_path)


@needs_geometry_in_python
def test_a9_an_attribute_of_instances_goes_before_properties(stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Of two objects, one has no such attribute, and all have a property of that name."""
    for x, has_attribute in ((-1.2, False), (1.2, True)):
        unit = add_unit(attribute_material("tint", "INSTANCER"))
        unit["tint"] = [0.9, 0.1, 0.1]
        obj, nodes = add_points((x, 0.0, 0.0))
        obj["tint"] = [0.1, 0.1, 0.9]
        instances = nodes.on_points(nodes.start, nodes.object(unit))
        if has_attribute:
            instances = nodes.store(instances, "INSTANCE", "FLOAT_COLOR", "tint")
        nodes.link(instances, nodes.end)
    expect_cycles(stage, tmp_path)


@needs_geometry_in_python
def test_a9_nothing_is_said_of_attributes_that_no_instance_has(stage: bpy.types.Scene) -> None:
    """Neither of objects nor of meshes that geometry nodes instance."""
    material = attribute_material("tint", "INSTANCER")
    _, nodes = add_points()
    nodes.link(nodes.on_points(nodes.start, nodes.object(add_unit(material))), nodes.end)
    _, nodes = add_points()
    painted = nodes.add("GeometryNodeSetMaterial", nodes.add("GeometryNodeMeshCube").outputs[0])
    painted.inputs["Material"].default_value = material
    nodes.link(nodes.on_points(nodes.start, painted.outputs[0]), nodes.end)
    assert recording.export(stage)[1].warnings == []


def test_a9_attributes_of_instances_are_no_attributes_of_meshes(stage: bpy.types.Scene, tmp_path: Path) -> None:
    """What is seen beside it is a grey plane."""
    unit = add_unit(attribute_material("tint", "GEOMETRY"))
    _, nodes = add_points((-1.0, 0.0, 0.0))
    instances = nodes.on_points(nodes.start, nodes.object(unit))
    nodes.link(nodes.store(instances, "INSTANCE", "FLOAT_COLOR", "tint"), nodes.end)
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(1.5, 0.0, 0.0))
    material = new_material()
    show(material, Graph(material)("RGB", "Color"))
    bpy.context.object.data.materials.append(material)
    expect_cycles(stage, tmp_path)


@pytest.mark.skipif(VERSION >= (4, 5, 0), reason="Python has the geometry of instances")
def test_a9_attributes_of_instances_that_cannot_be_read_are_named(stage: bpy.types.Scene) -> None:
    unit = add_unit(attribute_material("tint", "INSTANCER"))
    obj, nodes = add_points()
    nodes.link(
        nodes.store(nodes.on_points(nodes.start, nodes.object(unit)), "INSTANCE", "FLOAT_COLOR", "tint"), nodes.end
    )
    warnings = recording.export(stage)[1].warnings
    assert any(obj.name in text and "'tint'" in text and "4.5" in text for text in warnings), warnings


def add_tinted_points(unit: bpy.types.Object) -> bpy.types.Object:
    """Adds a plane with instances of `unit` that have an attribute."""
    points, nodes = add_points()
    nodes.link(
        nodes.store(nodes.on_points(nodes.start, nodes.object(unit)), "INSTANCE", "FLOAT_COLOR", "tint"), nodes.end
    )
    return points


def collection_of(*objects: bpy.types.Object) -> bpy.types.Collection:
    """Moves objects to a collection that is not in the scene."""
    collection = bpy.data.collections.new("Inner")
    for obj in objects:
        for user in obj.users_collection:
            user.objects.unlink(obj)
        collection.objects.link(obj)
    return collection


def add_instancer(collection: bpy.types.Collection, x: float = 0.0) -> bpy.types.Object:
    instancer = recording.add(None, location=(x, 0.0, 0.0))
    instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
    return instancer


def add_hidden() -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=0.1, location=(0.0, 0.0, -9.0))
    bpy.context.object.hide_render = True
    return bpy.context.object


@needs_geometry_in_python
@pytest.mark.parametrize("place", ["once", "twice", "beside others", "of nodes", "of nodes, nested"])
def test_a9_attributes_of_instances_in_collections(place: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: they were black, and without a warning where collections are nested."""
    inner = add_tinted_points(add_unit(attribute_material("tint", "INSTANCER")))
    if place == "beside others":
        collection = collection_of(add_hidden(), inner)
        collection.children.link(collection_of(add_tinted_points(add_unit(attribute_material("tint", "INSTANCER")))))
    else:
        collection = collection_of(add_hidden(), inner)
    if place in {"twice", "of nodes, nested"}:
        collection = collection_of(add_hidden(), add_instancer(collection))
    if place.startswith("of nodes"):
        _, nodes = add_points()
        info = nodes.add("GeometryNodeCollectionInfo")
        info.inputs["Collection"].default_value = collection
        nodes.link(nodes.on_points(nodes.start, info.outputs[0]), nodes.end)
    else:
        for x in (-1.2, 1.2):
            add_instancer(collection, x)
    assert recording.export(stage)[1].warnings == []
    expect_cycles(stage, tmp_path)


@needs_geometry_in_python
@pytest.mark.parametrize("children", [1, 2])
def test_a9_attributes_of_instances_on_vertices(children: int, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: what the second child instances had the attributes of the first one."""
    shown = [add_tinted_points(add_unit(attribute_material("tint", "INSTANCER"))) for _ in range(children)]
    bpy.ops.mesh.primitive_plane_add(size=3.0)
    outer = bpy.context.object
    outer.instance_type = "VERTS"
    outer.show_instancer_for_render = False
    for child in shown:
        child.parent = outer
    warnings = recording.export(stage)[1].warnings
    if children == 1:
        assert warnings == []
        expect_cycles(stage, tmp_path)
    else:
        assert any(outer.name in text and "one id" in text for text in warnings), warnings


@pytest.mark.parametrize("kind", ["FLOAT_VECTOR", "FLOAT2"])
@pytest.mark.parametrize("domain", ["CORNER", "POINT"])
def test_a9_uv_maps_that_nodes_store(domain: str, kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    if kind == "FLOAT2" and VERSION < (3, 5, 0):
        pytest.skip("nodes store no 2D vectors")
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, size=3.0)
    obj = bpy.context.object
    material = new_material()
    show(material, Graph(material)("UVMap", "UV", uv_map="made"))
    nodes = NodeTree(obj)
    stored = nodes.store(nodes.start, domain, kind, "made", 0.03)
    painted = nodes.add("GeometryNodeSetMaterial", stored)
    painted.inputs["Material"].default_value = material
    nodes.link(painted.outputs[0], nodes.end)
    expect_cycles(stage, tmp_path)


def data_types() -> list[str]:
    """Returns all data types that attributes of meshes have in this Blender."""
    return [item.identifier for item in bpy.types.Attribute.bl_rna.properties["data_type"].enum_items]


def set_values(attribute: bpy.types.Attribute) -> None:
    """Gives each item of an attribute another value."""
    for index, item in enumerate(attribute.data):
        value = 0.3 + 0.7 * index % 1.3
        values = (value, 0.5, 1.0 - 0.5 * value, 0.7)
        if hasattr(item, "color"):
            item.color = values
        elif hasattr(item, "vector"):
            item.vector = values[: len(item.vector)]
        elif isinstance(item.value, (bool, int, float, str, bytes)):
            item.value = type(item.value)(b"text" if isinstance(item.value, bytes) else index % 3 or value)
        elif attribute.data_type == "FLOAT4X4":
            item.value = [values] * 4
        else:
            item.value = [type(part)(index % 3 or number) for part, number in zip(item.value, values, strict=False)]


@pytest.mark.parametrize("kind", data_types())
@pytest.mark.parametrize("domain", ["POINT", "EDGE", "FACE", "CORNER"])
def test_a9_attributes_of_all_domains(domain: str, kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: attributes of edges were black, and so were quaternions. Factors are not always means.

    Each of four grids shows one output, and a fifth one keeps the picture from being black.
    """
    if (domain, kind) == ("EDGE", "QUATERNION"):
        pytest.skip("Blender turns rotations of edges into rotations of vertices, and Gradus takes means of numbers")
    for place, output in enumerate(["Color", "Vector", "Fac", "Alpha", "Generated"]):
        bpy.ops.mesh.primitive_grid_add(
            x_subdivisions=2, y_subdivisions=2, size=1.2, location=(1.25 * place - 2.5, 0, 0)
        )
        mesh = bpy.context.object.data
        if output == "Generated":
            material = new_material()
            show(material, Graph(material)("TexCoord", output))
        else:
            set_values(mesh.attributes.new("made", kind, domain))
            material = attribute_material("made", "GEOMETRY", output)
        mesh.materials.append(material)
    expect_cycles(stage, tmp_path)


# ------------------------------------------------------------------------------------------------- properties


def add_planes(material: bpy.types.Material) -> Iterator[bpy.types.Object]:
    """Adds a row of planes."""
    for column in range(3):
        bpy.ops.mesh.primitive_plane_add(size=1.2, location=(1.5 * column - 1.5, 0.0, 0.0))
        bpy.context.object.data.materials.append(material)
        yield bpy.context.object


OBJECT_PROPERTIES = ["number", "count", "vector", "whole", "of data", "color", "pass_index", "location", "missing"]
OBJECT_PROPERTIES += ["scale[0]", "data.auto_texspace", "name", "show_wire", "matrix_world", "words", "flag"]


@pytest.mark.parametrize("output", ["Color", "Fac", "Alpha"])
@pytest.mark.parametrize("name", OBJECT_PROPERTIES)
@pytest.mark.parametrize("kind", ["OBJECT", "INSTANCER"])
def test_a9_properties_of_objects(kind: str, name: str, output: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    material = new_material()
    graph = Graph(material)
    found = graph("Attribute", output, attribute_name=name, attribute_type=kind)
    shown = graph("VectorMath", "Vector", {"Vector": found}, operation="MULTIPLY_ADD")
    shown.node.inputs[1].default_value, shown.node.inputs[2].default_value = (0.2,) * 3, (0.4,) * 3
    show(material, shown)
    for index, obj in enumerate(add_planes(material)):
        obj["number"], obj["count"], obj["vector"] = 0.5 + 0.2 * index, index, [0.1, 0.2 * index, 0.7]
        obj["whole"], obj["words"], obj["flag"] = [index, 2], "text", index == 1
        obj.data["of data"] = 0.3 * index + 0.1
        obj.color, obj.pass_index = (0.2, 0.4 * index, 0.6, 0.5), index
        obj.data.materials[0] = material
    expect_cycles(stage, tmp_path)


@pytest.mark.parametrize("name", ["of instancer", "of object", "of both", "missing", "color"])
@pytest.mark.parametrize("kind", ["OBJECT", "INSTANCER"])
def test_a9_properties_of_instancers(kind: str, name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Instances on the vertices of a mesh. What is seen beside them is a grey plane."""
    material = attribute_material(name, kind)
    unit = add_unit(material, 0.4)
    bpy.ops.mesh.primitive_plane_add(size=1.6, location=(-1.0, 0.0, 0.0))
    instancer = bpy.context.object
    unit.parent, unit.location = instancer, (0.0, 0.0, 0.0)
    instancer.instance_type = "VERTS"
    instancer.show_instancer_for_render = False
    unit["of object"], unit["of both"], unit.color = 0.6, [0.7, 0.2, 0.1], (0.2, 0.4, 0.6, 1.0)
    instancer["of instancer"], instancer["of both"], instancer.color = 0.4, [0.1, 0.2, 0.7], (0.7, 0.4, 0.1, 1.0)
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(1.5, 0.0, 0.0))
    grey = new_material()
    show(grey, Graph(grey)("RGB", "Color"))
    bpy.context.object.data.materials.append(grey)
    expect_cycles(stage, tmp_path)


@pytest.mark.parametrize(("node", "output"), [("Attribute", "Color"), ("ObjectInfo", "Color"), ("ObjectInfo", "Alpha")])
def test_a9_instances_have_the_color_of_their_instancer(
    node: str, output: str, stage: bpy.types.Scene, tmp_path: Path
) -> None:
    """Regression: instances of one object by several instancers had its own colour or that of the first one."""
    material = new_material()
    named = {"attribute_name": "color", "attribute_type": "OBJECT"} if node == "Attribute" else {}
    show(material, Graph(material)(node, output, **named))
    unit = add_unit(material)
    unit.color = (0.9, 0.9, 0.9, 0.9)
    for x, color in ((-1.5, (0.8, 0.2, 0.1, 0.4)), (1.5, (0.1, 0.3, 0.8, 0.7))):
        obj, nodes = add_points((x, 0.0, 0.0))
        obj.color = color
        nodes.link(nodes.on_points(nodes.start, nodes.object(unit)), nodes.end)
    expect_cycles(stage, tmp_path)


@pytest.mark.parametrize("kind", ["VERTS", "FACES"])
def test_a9_generated_coordinates_of_instancers(kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: they were twice as large, and 0 in collections."""
    material = new_material()
    graph = Graph(material)
    place = graph("TexCoord", "Generated", from_instancer=True)
    shifted = graph("VectorMath", "Vector", {"Vector": place, "Vector_001": (0.7, 0.8, 0.9)}, operation="ADD")
    show(material, shifted)
    unit = add_unit(material)
    bpy.ops.mesh.primitive_plane_add(size=2.4, location=(-1.0, 0.0, 0.0))
    instancer = bpy.context.object
    unit.parent, unit.location = instancer, (0.0, 0.0, 0.0)
    instancer.instance_type, instancer.show_instancer_for_render = kind, False
    collection = bpy.data.collections.new("Instanced")
    collection.objects.link(add_unit(material, 0.8))
    empty = bpy.data.objects.new("Empty", None)
    empty.location, empty.instance_type, empty.instance_collection = (-48.0, -50.0, 0.0), "COLLECTION", collection
    stage.collection.objects.link(empty)
    expect_cycles(stage, tmp_path)


def test_a9_a_missing_colour_attribute_is_transparent(stage: bpy.types.Scene, tmp_path: Path) -> None:
    material = new_material()
    graph = Graph(material)
    alpha = graph("VertexColor", "Alpha", layer_name="missing")
    show(material, graph("Math", "Value", {"Value": alpha, "Value_001": 0.5}, operation="ADD"))
    bpy.ops.mesh.primitive_plane_add(size=3.0)
    bpy.context.object.data.materials.append(material)
    expect_cycles(stage, tmp_path)


VIEW_LAYER_PROPERTIES = ["of layer", "of scene", "of world", "of all", "missing", "samples", "frame_current"]
VIEW_LAYER_PROPERTIES += ["render.resolution_x", "light_settings.distance"]


@pytest.mark.parametrize("output", ["Color", "Vector", "Fac", "Alpha"])
@pytest.mark.parametrize("name", VIEW_LAYER_PROPERTIES)
def test_a9_properties_of_the_view_layer(name: str, output: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    stage.world = bpy.data.worlds.new("World")
    layer = stage.view_layers[0]
    stage.frame_set(3)
    layer["of layer"], stage["of scene"], stage.world["of world"] = 0.3, [0.1, 0.2, 0.6], [0.2, 0.5, 0.1, 0.7]
    layer["of all"], stage["of all"], stage.world["of all"] = [0.7, 0.1], 0.2, 0.1
    material = new_material()
    graph = Graph(material)
    found = graph("Attribute", output, attribute_name=name, attribute_type="VIEW_LAYER")
    shown = graph("VectorMath", "Vector", {"Vector": found}, operation="MULTIPLY_ADD")
    shown.node.inputs[1].default_value, shown.node.inputs[2].default_value = (0.2,) * 3, (0.4,) * 3
    show(material, shown)
    list(add_planes(material))
    expect_cycles(stage, tmp_path)


# ------------------------------------------------------------------------------------------------- particles


PARTICLE_OUTPUTS = ["Index", "Random", "Age", "Lifetime", "Location", "Size", "Velocity", "Angular Velocity"]


def add_particles(material: bpy.types.Material) -> None:
    """Adds a plane that emits particles upwards, which are rendered as spheres, and a plane beside it."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, radius=2.0, location=(50.0, 50.0, 0.0))
    unit = bpy.context.object
    unit.data.materials.append(material)
    bpy.ops.mesh.primitive_plane_add(size=2.0, location=(-0.5, 0.0, 0.0))
    emitter = bpy.context.object
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    emitter.show_instancer_for_render = False
    settings = emitter.particle_systems[0].settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 12, 1, 8, 30
    settings.lifetime_random, settings.size_random, settings.particle_size = 0.5, 0.4, 0.1
    settings.render_type, settings.instance_object = "OBJECT", unit
    settings.use_rotations, settings.angular_velocity_mode, settings.angular_velocity_factor = True, "GLOBAL_Z", 2.0
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(2.2, 0.0, 0.0))
    bpy.context.object.data.materials.append(material)


@pytest.mark.parametrize("output", PARTICLE_OUTPUTS)
def test_a9_particle_info(output: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    material = new_material()
    graph = Graph(material)
    found = graph("ParticleInfo", output)
    scale = 0.03 if output in {"Index", "Age", "Lifetime"} else 0.3
    shown = graph("VectorMath", "Vector", {"Vector": found}, operation="MULTIPLY_ADD")
    shown.node.inputs[1].default_value, shown.node.inputs[2].default_value = (scale,) * 3, (0.4,) * 3
    show(material, shown)
    add_particles(material)
    for frame in range(1, 11):
        stage.frame_set(frame)
    expect_cycles(stage, tmp_path, 0.06)  # spheres have many edges


def test_a9_properties_of_particle_settings(stage: bpy.types.Scene, tmp_path: Path) -> None:
    material = attribute_material("tint", "INSTANCER")
    add_particles(material)
    bpy.data.particles[0]["tint"] = [0.2, 0.5, 0.7]
    for frame in range(1, 11):
        stage.frame_set(frame)
    expect_cycles(stage, tmp_path, 0.06)  # spheres have many edges


# ------------------------------------------------------------------------------------------------- nodes


NODES: dict[str, Callable[[Graph], bpy.types.NodeSocket]] = {
    "pointiness": lambda g: g("NewGeometry", "Pointiness"),
    "island": lambda g: g("NewGeometry", "Random Per Island"),
    "parametric": lambda g: g("NewGeometry", "Parametric"),
    "backfacing": lambda g: g("NewGeometry", "Backfacing"),
    "random": lambda g: g("ObjectInfo", "Random"),
    "alpha": lambda g: g("ObjectInfo", "Alpha"),
    "material index": lambda g: g("ObjectInfo", "Material Index"),
    "hair strand": lambda g: g("HairInfo", "Is Strand"),
    "hair tangent": lambda g: g("HairInfo", "Tangent Normal"),
    "hair random": lambda g: g("HairInfo", "Random"),
    "hair length": lambda g: g("HairInfo", "Length"),
    "hair intercept": lambda g: g("HairInfo", "Intercept"),
    "hair thickness": lambda g: g("HairInfo", "Thickness"),
    "point position": lambda g: g("PointInfo", "Position"),
    "point radius": lambda g: g("PointInfo", "Radius"),
    "point random": lambda g: g("PointInfo", "Random"),
    "wireframe": lambda g: g("Wireframe", "Fac", {"Size": 0.08}),
    "wireframe of pixels": lambda g: g("Wireframe", "Fac", {"Size": 3.0}, use_pixel_size=True),
    "occlusion": lambda g: g("AmbientOcclusion", "AO", {"Distance": 1.0}),
    "occlusion of the world": lambda g: g("AmbientOcclusion", "Color", {"Distance": 0.0, "Color": (0.9, 0.5, 0.2, 1)}),
    "occlusion inside": lambda g: g("AmbientOcclusion", "AO", {"Distance": 0.7}, inside=True),
    "local occlusion": lambda g: g("AmbientOcclusion", "AO", {"Distance": 1.0}, only_local=True),
    "occlusion by a normal": lambda g: g(
        "AmbientOcclusion", "AO", {"Distance": 2.0, "Normal": g("RGB", "Color")}, samples=4
    ),
    "bevel": lambda g: g("Bevel", "Normal", {"Radius": 0.2}),
    "bevel of a normal": lambda g: g("Bevel", "Normal", {"Radius": 0.3, "Normal": g("NewGeometry", "Normal")}),
}


@pytest.fixture(scope="module")
def shapes() -> bpy.types.Scene:
    """Returns a scene with a monkey of several parts, one of which is split, and a turned cube on a plane."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    bpy.ops.mesh.primitive_monkey_add(location=(-1.2, 0.0, 0.2), rotation=(0.2, 0.1, 0.3))
    bpy.ops.mesh.primitive_cube_add(size=1.4, location=(1.3, 0.2, 0.0), rotation=(0.3, 0.2, 0.5))
    cube = bpy.context.object
    cube.scale, cube.color = (1.2, 1.0, 0.7), (0.3, 0.4, 0.5, 0.6)
    cube.modifiers.new("Split", "EDGE_SPLIT")
    bpy.ops.mesh.primitive_plane_add(size=8.0, location=(0.0, 0.0, -1.0))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.5, -6.0, 1.5), (1.33, 0.0, 0.08)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.light_settings.distance = 0.8
    return scene


def show_on_all(scene: bpy.types.Scene, make: Callable[[Graph], bpy.types.NodeSocket]) -> None:
    """Lets all meshes emit a value."""
    material = new_material()
    material.pass_index = 2
    graph = Graph(material)
    shown = graph("VectorMath", "Vector", {"Vector": make(graph)}, operation="MULTIPLY_ADD")
    shown.node.inputs[1].default_value, shown.node.inputs[2].default_value = (0.4,) * 3, (0.5,) * 3
    show(material, shown)
    for item in scene.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(material)


@pytest.mark.parametrize("name", NODES)
def test_a9_node(name: str, shapes: bpy.types.Scene, tmp_path: Path) -> None:
    show_on_all(shapes, NODES[name])
    # Lines are thinner than blocks, and 16 samples of a block of pixels leave noise in the share of rays.
    expect_cycles(shapes, tmp_path, 0.02)


def expect_same_mean_with_gradients(scene: bpy.types.Scene, folder: Path, name: str, make: Any) -> None:
    """Compares plain paths with gradients, for a diffuse surface in the colour of a node."""
    material = new_material(name)
    graph = Graph(material)
    show(material, graph("BsdfDiffuse", "BSDF", {"Color": make(graph)}))
    for item in scene.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(material)
    plain = images.render(scene, folder, samples=64, integrator="PATH", reconstruction="NONE")["Combined"]
    gradients = images.render(scene, folder, samples=64, integrator="GRADIENT", reconstruction="L2")["Combined"]
    assert plain[..., :3].mean() > 0.001
    assert gradients[..., :3].mean() == pytest.approx(plain[..., :3].mean(), rel=0.01)


def test_a9_occlusion_with_gradients_has_the_same_mean(shapes: bpy.types.Scene, tmp_path: Path) -> None:
    """A shifted path draws the random numbers of its base path."""
    expect_same_mean_with_gradients(shapes, tmp_path, "Occlusion", NODES["occlusion"])


# ------------------------------------------------------------------------------------------------- raycast


def raycast(graph: Graph, output: str, inputs: dict[str, Any] | None = None, only_local: bool = False) -> Any:
    return graph("Raycast", output, {"Length": 3.0} | (inputs or {}), only_local=only_local)


def raycast_attribute(graph: Graph, kind: str, name: str, output: int) -> bpy.types.NodeSocket:
    """Returns one of the outputs that an attribute adds to a node, counted from the first one."""
    node = graph("Raycast", "Is Hit", {"Length": 9.0, "Direction": graph("RGB", "Color")}).node
    node.sample_attribute_items.new(kind, "Item")
    node.inputs["Item"].default_value = name
    return node.outputs[5 + output]


RAYCASTS: dict[str, Callable[[Graph], bpy.types.NodeSocket]] = {
    "hit": lambda g: raycast(g, "Is Hit"),
    "hit of a short ray": lambda g: raycast(g, "Is Hit", {"Length": 0.4}),
    "hit of a ray of no length": lambda g: raycast(g, "Is Hit", {"Length": 0.0}),
    "self hit": lambda g: raycast(g, "Self Hit"),
    "distance": lambda g: raycast(g, "Hit Distance"),
    "distance by a long direction": lambda g: raycast(g, "Hit Distance", {"Direction": g("RGB", "Color")}),
    "position": lambda g: raycast(g, "Hit Position"),
    "normal": lambda g: raycast(g, "Hit Normal", {"Direction": g("NewGeometry", "Incoming")}),
    "normal of the back": lambda g: raycast(
        g,
        "Hit Normal",
        {
            "Direction": g(
                "VectorMath", "Vector", {"Vector": g("NewGeometry", "Normal"), "Scale": -1}, operation="SCALE"
            )
        },
    ),
    "other instances left out": lambda g: raycast(g, "Hit Distance", only_local=True),
    "from another point": lambda g: raycast(
        g,
        "Hit Distance",
        {
            "Position": g("VectorMath", "Vector", {"Vector": g("NewGeometry", "Position")}, operation="SNAP"),
            "Length": 9,
        },
    ),
    "from the point itself": lambda g: raycast(g, "Is Hit", {"Position": g("NewGeometry", "Position")}),
    "colour": lambda g: raycast_attribute(g, "RGBA", "Col", 0),
    "alpha of a colour": lambda g: raycast_attribute(g, "RGBA", "Col", 1),
    "vector": lambda g: raycast_attribute(g, "VECTOR", "UVMap", 0),
    "number": lambda g: raycast_attribute(g, "FLOAT", "Col", 0),
    "missing attribute": lambda g: raycast_attribute(g, "RGBA", "nothing", 1),
}


HIDDEN = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")
"""Kinds of rays to which objects can be hidden."""


@pytest.fixture(scope="module")
def crowd(shapes: bpy.types.Scene) -> bpy.types.Scene:
    """Returns shapes with a colour attribute. Of those that the camera does not see, Cycles shows the node one.

    It sees what any other ray can see, and ignores the switch that objects have for it.
    """
    for item in [item for item in shapes.objects if item.type == "MESH"]:
        colors = item.data.color_attributes.new("Col", "FLOAT_COLOR", "CORNER")
        place = np.array([item.data.vertices[loop.vertex_index].co for loop in item.data.loops], np.float32)
        values = np.concatenate([0.4 + 0.3 * place, np.full((len(place), 1), 0.6, np.float32)], axis=1)
        colors.data.foreach_set("color", values.astype(np.float32).ravel())
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(0.4, -0.6, 1.0))
    bpy.context.object.visible_raycast = False
    for place, hidden in (((-1.0, 0.0, 1.6), HIDDEN[:-1]), ((0.0, 1.0, 1.8), HIDDEN)):
        bpy.ops.mesh.primitive_plane_add(size=2.0, location=place)
        for name in hidden:
            setattr(bpy.context.object, f"visible_{name}", False)
    return shapes


@pytest.mark.skipif(VERSION < (5, 2, 0), reason="came with Blender 5.2")
@pytest.mark.parametrize("name", RAYCASTS)
def test_a9_raycast(name: str, crowd: bpy.types.Scene, tmp_path: Path) -> None:
    show_on_all(crowd, RAYCASTS[name])
    expect_cycles(crowd, tmp_path, 0.02)


@pytest.mark.skipif(VERSION < (5, 2, 0), reason="came with Blender 5.2")
def test_a9_raycast_traces_one_ray_for_all_its_outputs() -> None:
    """Regression: each attribute traced a ray of its own."""
    material = new_material()
    graph = Graph(material)
    node = raycast_attribute(graph, "RGBA", "Col", 0).node
    outputs = [output for output in node.outputs if output.type != "CUSTOM"]  # without the socket for new items
    total = outputs[0]
    for output in outputs[1:]:
        total = graph("VectorMath", "Vector", {"Vector": total, "Vector_001": output})
    show(material, total)
    names = op_names(translate(material))
    assert len(outputs) == 7
    assert names.count("RAYCAST") == names.count("RAYCAST_ATTRIBUTE") == 1


@pytest.mark.skipif(VERSION < (5, 2, 0), reason="came with Blender 5.2")
def test_a9_raycast_bends_normals(crowd: bpy.types.Scene, tmp_path: Path) -> None:
    """The points to the sides, of which a bump map is made, cast rays as well."""
    show_on_all(crowd, lambda g: g("Bump", "Normal", {"Height": raycast(g, "Hit Distance", {"Length": 2.0})}))
    expect_cycles(crowd, tmp_path, 0.04)


@pytest.mark.skipif(VERSION < (5, 2, 0), reason="came with Blender 5.2")
def test_a9_raycast_with_gradients_has_the_same_mean(crowd: bpy.types.Scene, tmp_path: Path) -> None:
    expect_same_mean_with_gradients(crowd, tmp_path, "Raycast", RAYCASTS["distance"])
