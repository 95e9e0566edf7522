"""Rows of objects: kinds of objects, visibility by kinds of rays, transformations, collections and instances."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from typing import Any

import bpy

from .. import rna, stages
from ..row import EXACT, NOISY, Family, Row

SKIPPED = (
    "show_[!i]*",
    "show_in_front",
    "display_*",
    "lock_*",
    "empty_*",
    "hide_select",
    "hide_viewport",
    "matrix_*",
    "active_*",
    "bound_box",
    "parent_*",
    "use_grease_pencil*",
    "use_dynamic_topology*",
    "use_mesh_mirror*",
    "use_simulation_cache",
    "up_axis",
    "track_axis",
    "use_camera_lock_parent",
    "add_rest_position_attribute",
    "lightgroup",
    "instance_type",
    "rotation_mode",
    "select*",
)
"""Properties of the viewport and of editing."""


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    obj = stages.mesh("SPHERE")
    family = Family("Objects", "Object", stage, NOISY)
    yield from family.rows(rna.changes(obj, SKIPPED))
    yield from family.rows(rna.of_part("cycles", rna.changes(obj.cycles)))
    modes = Family("Objects", "Object", stage_of_rotation)
    yield from modes.rows((f".rotation_mode={value}", partial(_set, "rotation_mode", value)) for value in ROTATIONS)
    layer = Family("Objects", "Layer collection", stage_of_collection, NOISY)
    collection = bpy.context.view_layer.layer_collection
    yield from layer.rows(rna.changes(collection, ("select*",)))
    yield from layer.rows(rna.of_part("collection", rna.changes(collection.collection, ("color_tag", "lineart*"))))
    held_out = Family("Objects", "Held out layer collection", stage_of_held_out_collection, NOISY)
    yield from held_out.rows(rna.changes(collection, ("[!i]*",)))
    yield from rows_of_instances()
    yield from rows_of_types()
    yield from rows_of_links()


def stage() -> Any:
    """Shows the object directly, in a mirror, behind glass, by its shadow and by its light on a floor."""
    ball = stages.room()
    back = stages.material("BsdfGlossy", (0.9, 0.9, 0.9), Roughness=0.0)
    stages.mesh("PLANE", back, "Mirror", location=(-1.0, 1.4, 1.0), rotation_euler=(1.5708, 0.0, 0.4))
    ball.color = (0.2, 0.4, 0.6, 0.8)
    return ball


ROTATIONS = ("QUATERNION", "AXIS_ANGLE", "XZY", "YXZ", "YZX", "ZXY", "ZYX")


def stage_of_rotation() -> Any:
    material = stages.checks(1.3)
    stages.mesh("PLANE", material, scale=(5.0, 5.0, 1.0), location=(0.0, 0.0, -1.5))
    cube = stages.mesh("CUBE", material, rotation_euler=(0.4, 0.7, 1.1))
    cube.rotation_axis_angle = (0.8, 0.3, 0.9, 0.2)
    cube.rotation_quaternion = (0.7, 0.3, 0.5, 0.2)
    stages.camera((0.5, -5.0, 4.0))
    return cube


def _set(name: str, value: Any, owner: Any) -> None:
    setattr(owner, name, value)


def stage_of_collection() -> Any:
    ball = stage()
    collection = bpy.data.collections.new("Group")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(ball)
    bpy.context.scene.collection.objects.unlink(ball)
    return bpy.context.view_layer.layer_collection.children["Group"]


def stage_of_held_out_collection() -> Any:
    collection = stage_of_collection()
    collection.holdout = True
    return collection


def rows_of_instances() -> Iterator[Row]:
    probe = bpy.data.objects["Mesh"]
    instances = Family("Objects", "Object", stage_of_instances)
    for value in rna.enum_values(probe, "instance_type"):
        if value != "NONE":
            yield instances.row(f".instance_type={value}", partial(instance, value))
    particles = Family("Objects", "Particles", stage_of_instances)
    for kind in ("EMITTER", "HAIR"):
        for shown in ("OBJECT", "COLLECTION", "PATH" if kind == "HAIR" else "HALO"):
            yield particles.row(f" {kind} {shown}", partial(add_particles, kind, shown))


def stage_of_instances() -> Any:
    stages.mesh("PLANE", stages.checks(1.3), "Ground", scale=(6.0, 6.0, 1.0), location=(0.03, 0.02, -1.0))
    small = stages.mesh("SPHERE", stages.checks(4.0), "Small", scale=(0.3, 0.2, 0.25))
    parent = stages.mesh("PLANE", stages.checks(2.0), "Parent", scale=(1.5, 1.2, 1.0), rotation_euler=(0.2, 0.1, 0.3))
    small.parent = parent
    stages.black_world()
    stages.camera((0.4, -5.0, 3.5))
    return parent


def instance(kind: str, parent: Any) -> None:
    if kind == "COLLECTION":
        collection = bpy.data.collections.new("Group")
        collection.objects.link(bpy.data.objects["Small"])
        parent = stages.add(None, "Instancer", location=(0.7, 0.4, 0.6), rotation_euler=(0.4, 0.3, 0.2))
        parent.instance_collection = collection
    parent.instance_type = kind


def add_particles(kind: str, shown: str, parent: Any) -> None:
    settings = parent.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count = kind, 30
    settings.frame_start = settings.frame_end = 1.0
    settings.render_type, settings.particle_size, settings.hair_length = shown, 0.4, 0.6
    if shown == "COLLECTION":
        settings.instance_collection = bpy.data.collections.new("Group")
        settings.instance_collection.objects.link(bpy.data.objects["Small"])
    elif shown == "OBJECT":
        settings.instance_object = bpy.data.objects["Small"]
    bpy.context.scene.frame_set(2)


def rows_of_types() -> Iterator[Row]:
    types = Family("Objects", "Object type", stage_of_types, EXACT)
    for value in rna.enum_values(bpy.data.objects["Mesh"], "type"):
        if value in MAKERS:
            yield types.row(f" {value}", partial(add_type, value))
        elif value in {"CURVES", "POINTCLOUD"}:
            yield types.row(f" {value}", add_hair if value == "CURVES" else add_points)
        elif value not in {"MESH", "CAMERA", "LIGHT"}:
            yield types.row(f" {value}", partial(add_by_operator, value))


def stage_of_types() -> Any:
    stages.mesh("PLANE", stages.checks(1.3), "Ground", scale=(6.0, 6.0, 1.0), location=(0.03, 0.02, -1.0))
    stages.black_world()
    stages.camera((0.4, -5.0, 3.5))


def _curve() -> Any:
    data = bpy.data.curves.new("Curve", "CURVE")
    data.dimensions, data.bevel_depth, data.extrude = "3D", 0.15, 0.1
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(2)
    for index, point in enumerate(spline.bezier_points):
        point.co = (index - 1.0, 0.5 * (index % 2), 0.3 * index)
        point.handle_left_type = point.handle_right_type = "AUTO"
    return data


def _text() -> Any:
    data = bpy.data.curves.new("Text", "FONT")
    data.body, data.extrude, data.align_x = "Gr", 0.1, "CENTER"
    return data


def _surface() -> Any:
    data = bpy.data.curves.new("Surface", "SURFACE")
    data.dimensions = "3D"
    spline = data.splines.new("NURBS")
    spline.points.add(3)
    for index, point in enumerate(spline.points):
        point.co = (index - 1.5, 0.4 * (index % 2), 0.2 * index, 1.0)
    spline.use_endpoint_u = True
    return data


def _meta() -> Any:
    data = bpy.data.metaballs.new("Meta")
    data.render_resolution = data.resolution = 0.2
    data.elements.new()
    data.elements.new().co = (0.9, 0.2, 0.1)
    return data


MAKERS = {"CURVE": _curve, "FONT": _text, "SURFACE": _surface, "META": _meta}
"""Functions that make the data of an object of a type."""


def add_type(kind: str, _subject: Any) -> None:
    data = MAKERS[kind]()
    data.materials.append(stages.checks(2.0))
    stages.add(data, kind.title())


def add_hair(_subject: Any) -> None:
    """Adds a curve of hair made by nodes, because scripts cannot make its points in Blender 3.4."""
    line, thick = add_by_nodes(bpy.data.hair_curves.new("Hair"), "CurvePrimitiveLine", "SetCurveRadius")
    line.inputs["Start"].default_value, line.inputs["End"].default_value = (-1.0, 0.2, 0.1), (1.0, -0.3, 0.9)
    thick.inputs["Radius"].default_value = 0.2


def add_points(_subject: Any) -> None:
    """Adds points made by nodes, because scripts cannot make them before Blender 5.2."""
    points, place = add_by_nodes(bpy.data.pointclouds.new("Points"), "Points", "SetPosition")
    points.inputs["Count"].default_value, points.inputs["Radius"].default_value = 1, 0.6
    place.inputs["Offset"].default_value = (0.4, 0.2, 0.1)


def add_by_nodes(data: Any, maker: str, changer: str) -> tuple[Any, Any]:
    """Adds an object whose geometry a node makes, another one changes and a third one gives a material.

    Returns the first two nodes.
    """
    tree = bpy.data.node_groups.new("Maker", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    made, changed, shaded = (tree.nodes.new(f"GeometryNode{kind}") for kind in (maker, changer, "SetMaterial"))
    shaded.inputs["Material"].default_value = stages.checks(2.0)
    chain = (made, changed, shaded, tree.nodes.new("NodeGroupOutput"))
    for source, target in pairwise(chain):
        tree.links.new(source.outputs[0], target.inputs[0])
    stages.add(data, data.name).modifiers.new("Nodes", "NODES").node_group = tree
    return made, changed


def add_by_operator(kind: str, _subject: Any) -> None:
    """Adds an object of another type as Blender's menu does."""
    operators = {
        "LATTICE": ("object.add", {"type": "LATTICE"}),
        "ARMATURE": ("object.armature_add", {}),
        "EMPTY": ("object.empty_add", {}),
        "SPEAKER": ("object.speaker_add", {}),
        "VOLUME": ("object.volume_add", {}),
        "LIGHT_PROBE": ("object.lightprobe_add", {}),
        "GPENCIL": ("object.gpencil_add", {"type": "STROKE"}),
        "GREASEPENCIL": ("object.grease_pencil_add", {"type": "STROKE"}),
    }
    name, arguments = operators[kind]
    group, _, function = name.partition(".")
    getattr(getattr(bpy.ops, group), function)(**arguments)


def rows_of_links() -> Iterator[Row]:
    """Yields rows of links from an object to lights, which exist from 4.0 on."""
    linking = getattr(bpy.data.objects["Mesh"], "light_linking", None)
    if linking is not None:
        family = Family("Objects", "Object", stage, NOISY)
        for name in ("receiver_collection", "blocker_collection"):
            yield family.row(f".light_linking.{name}", partial(link_light, name))


def link_light(name: str, ball: Any) -> None:
    collection = bpy.data.collections.new("Linked")
    collection.objects.link(ball)
    setattr(bpy.data.objects["Light"].light_linking, name, collection)
