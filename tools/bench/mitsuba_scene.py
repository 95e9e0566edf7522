"""Writes the open Blender scene as plain arrays for mitsuba_worker.py: meshes, materials, camera and world.

Only what both renderers define alike is written: Diffuse, Glass and Glossy BSDFs without roughness, Emission and a
world of one color. Anything else raises a ValueError that names it, so that pictures of different scenes are never
compared.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import bpy
import numpy as np

GAP = (
    1e-4  # meters between the two sides of an emitter, which emits on both sides in Blender and on one side in Mitsuba
)


def write(path: Path) -> None:
    scene = bpy.context.scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    arrays: dict[str, np.ndarray] = {}
    meshes = []
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type == "LIGHT":
            raise ValueError(f"light {thing.name}")
        if thing.type == "MESH":
            vertices, triangles = _triangles(thing, np.array(instance.matrix_world))
            material = _material(thing)
            for side, indices in enumerate(
                [triangles, triangles[:, ::-1]] if material["kind"] == "emission" else [triangles]
            ):
                moved = vertices + GAP * _normal(vertices, indices) if side else vertices
                arrays |= {
                    f"vertices{len(meshes)}": moved.astype(np.float32),
                    f"triangles{len(meshes)}": indices.astype(np.uint32),
                }
                meshes.append(material)
    facts = {
        "meshes": meshes,
        "camera": _camera(scene),
        "world": _world(scene),
        "max_bounces": scene.cycles.max_bounces,
    }
    np.savez(path, facts=np.array(json.dumps(facts)), **arrays)


def _triangles(thing: bpy.types.Object, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mesh = thing.to_mesh()
    if any(polygon.use_smooth for polygon in mesh.polygons):
        raise ValueError(f"smooth normals of {thing.name}")
    mesh.calc_loop_triangles()
    vertices = np.array([matrix[:3, :3] @ vertex.co + matrix[:3, 3] for vertex in mesh.vertices])
    triangles = np.array([triangle.vertices for triangle in mesh.loop_triangles])
    thing.to_mesh_clear()
    return vertices, triangles


def _normal(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Returns the unit normal of the first triangle; emitters are assumed to be flat."""
    a, b, c = vertices[triangles[0]]
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal)


def _material(thing: bpy.types.Object) -> dict[str, Any]:
    tree = thing.material_slots[0].material.node_tree
    node = tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    kinds = {"ShaderNodeBsdfDiffuse": "diffuse", "ShaderNodeBsdfGlass": "glass", "ShaderNodeBsdfAnisotropic": "mirror"}
    kinds["ShaderNodeEmission"] = "emission"
    linked = any(socket.is_linked for socket in node.inputs)
    rough = "Roughness" in node.inputs and node.inputs["Roughness"].default_value > 0.0
    if node.bl_idname not in kinds or linked or rough or len(thing.material_slots) != 1:
        raise ValueError(f"material {thing.material_slots[0].material.name}")
    color = list(node.inputs["Color"].default_value)[:3]
    if node.bl_idname == "ShaderNodeEmission":
        color = [c * node.inputs["Strength"].default_value for c in color]
    ior = node.inputs["IOR"].default_value if "IOR" in node.inputs else 1.0
    return {"kind": kinds[node.bl_idname], "color": color, "ior": ior}


def _camera(scene: bpy.types.Scene) -> dict[str, Any]:
    camera = scene.camera
    data = camera.data
    if data.type != "PERSP" or data.sensor_fit == "VERTICAL" or data.shift_x or data.shift_y or data.dof.use_dof:
        raise ValueError("camera with depth of field, shift, vertical sensor fit or another projection")
    matrix = np.array(camera.matrix_world)
    return {
        "matrix": matrix.tolist(),
        "angle_x": data.angle_x,
        "clip_start": data.clip_start,
        "clip_end": data.clip_end,
    }


def _world(scene: bpy.types.Scene) -> list[float]:
    node = scene.world.node_tree.nodes["Background"]
    if any(socket.is_linked for socket in node.inputs):
        raise ValueError("world with a texture")
    return [c * node.inputs["Strength"].default_value for c in list(node.inputs["Color"].default_value)[:3]]
