"""Small scenes, each with one simulation that is not baked, and the positions of their objects."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy

from .animation import key

Places = dict[str, tuple[float, ...]]


def _new(name: str, mesh: bpy.types.Mesh, at: tuple[float, float, float]) -> bpy.types.Object:
    obj = bpy.data.objects.new(name, mesh)
    obj.location = at
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    return obj


def _grid(cuts: int) -> bpy.types.Mesh:
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=2.0)
    obj = bpy.context.object
    mesh = obj.data
    bpy.data.objects.remove(obj)
    return mesh


def _ball(radius: float) -> bpy.types.Mesh:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=radius)
    obj = bpy.context.object
    mesh = obj.data
    bpy.data.objects.remove(obj)
    return mesh


def rigid_body() -> None:
    _new("Falling", _grid(1), (0.0, 0.0, 5.0))
    bpy.ops.rigidbody.object_add()


def cloth() -> None:
    obj = _new("Cloth", _grid(6), (0.0, 0.0, 5.0))
    obj.vertex_groups.new(name="Pinned").add([0, 1], 1.0, "ADD")
    obj.modifiers.new("Cloth", "CLOTH").settings.vertex_group_mass = "Pinned"


def soft_body() -> None:
    _new("Soft", _grid(4), (0.0, 0.0, 5.0)).modifiers.new("Softbody", "SOFT_BODY").settings.use_goal = False


def particles() -> None:
    emitter = _new("Emitter", _grid(1), (0.0, 0.0, 2.0))
    settings = emitter.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 4, 1.0, 1.0, 100.0
    settings.render_type, settings.particle_size = "OBJECT", 0.2
    settings.instance_object = _new("Particle", _grid(1), (50.0, 0.0, 0.0))


def stream() -> None:
    """Adds particles that are emitted and die."""
    particles()
    settings = bpy.data.particles[0]
    settings.count, settings.frame_end, settings.lifetime = 16, 6.0, 20.0


def simulation_zone() -> None:
    group = bpy.data.node_groups.new("Rising", "GeometryNodeTree")
    for kind in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=kind, socket_type="NodeSocketGeometry")
    names = (
        "NodeGroupInput",
        "GeometryNodeSimulationInput",
        "GeometryNodeSetPosition",
        "GeometryNodeSimulationOutput",
        "NodeGroupOutput",
    )
    nodes = [group.nodes.new(name) for name in names]
    nodes[1].pair_with_output(nodes[3])
    nodes[2].inputs["Offset"].default_value = (0.0, 0.0, 0.1)
    for first, second in zip(nodes, nodes[1:], strict=False):
        group.links.new(first.outputs["Geometry"], second.inputs["Geometry"])
    _new("Rising", _grid(1), (0.0, 0.0, 0.0)).modifiers.new("Nodes", "NODES").node_group = group


def dynamic_paint() -> None:
    """Adds a simulation with a cache on disk, next to the file: it has none until the file is saved."""
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(tempfile.mkdtemp(dir=bpy.app.tempdir)) / "paint.blend"))
    canvas = _new("Canvas", _grid(8), (0.0, 0.0, 0.0)).modifiers.new("Dynamic Paint", "DYNAMIC_PAINT")
    bpy.ops.dpaint.type_toggle(type="CANVAS")
    canvas.canvas_settings.canvas_surfaces[0].surface_type = "DISPLACE"
    brush = _new("Brush", _ball(0.4), (0.0, 0.0, 0.0))
    brush.modifiers.new("Dynamic Paint", "DYNAMIC_PAINT").ui_type = "BRUSH"
    bpy.ops.dpaint.type_toggle(type="BRUSH")
    key(brush, "location", {1: (-1.0, 0.0, 0.0), 9: (1.0, 0.0, 0.0)})


def liquid() -> None:
    """Adds one drop of fluid that is computed during playback."""
    domain = _new("Domain", _ball(2.0), (0.0, 0.0, 0.0)).modifiers.new("Fluid", "FLUID")
    domain.fluid_type = "DOMAIN"
    settings = domain.domain_settings
    settings.domain_type, settings.resolution_max, settings.use_mesh, settings.cache_type = "LIQUID", 16, True, "REPLAY"
    settings.cache_directory = tempfile.mkdtemp(dir=bpy.app.tempdir)
    settings.cache_frame_start, settings.cache_frame_end = 1, 50
    drop = _new("Drop", _ball(0.4), (0.0, 0.0, 0.4))
    flow = drop.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "LIQUID", "GEOMETRY"


KINDS: dict[str, Callable[[], None]] = {
    "rigid body": rigid_body,
    "cloth": cloth,
    "soft body": soft_body,
    "particles": particles,
    "stream of particles": stream,
    "simulation zone": simulation_zone,
    "dynamic paint": dynamic_paint,
    "liquid": liquid,
}


def exists(kind: str) -> bool:
    return kind != "simulation zone" or bpy.app.version >= (
        4,
        1,
        0,
    )  # the interface of node groups, which the simulation zone needs


def places(depsgraph: Any) -> Places:
    """Returns the position of every instance, and the mean position of its vertices."""
    found = {}
    for item in depsgraph.object_instances:
        if item.object.type == "MESH":
            vertices = item.object.data.vertices
            middle = [sum(vertex.co[axis] for vertex in vertices) / len(vertices) for axis in range(3)]
            found[f"{item.object.name} {list(item.persistent_id)[:1]}"] = (*item.matrix_world.translation, *middle)
    return found


def in_order(scene: bpy.types.Scene, first: int, last: int) -> dict[int, Places]:
    """Returns the positions in the frames when the scene is stepped through all of them."""
    found = {}
    for frame in range(first, last + 1):
        scene.frame_set(frame)
        found[frame] = places(bpy.context.evaluated_depsgraph_get())
    return found
