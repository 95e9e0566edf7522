"""Builds a room of rooms.py: a closed diffuse box with nine bumpy spheres under one area light."""

from __future__ import annotations

import bpy
import numpy as np
from rooms import Room

# Corners of the faces of a box, with normals outwards.
BOX_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def bumpy_sphere(cells: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns vertices and triangles of a sphere whose radius varies with the direction: rows of `cells` quads and a
    fan at each pole.
    """
    polar, azimuth = np.meshgrid(
        np.linspace(0, np.pi, cells + 2)[1:-1], np.arange(cells) * (2 * np.pi / cells), indexing="ij"
    )
    direction = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    ).reshape(-1, 3)
    direction = np.concatenate([direction, [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]])
    wave = np.random.default_rng(seed).normal(scale=4.0, size=(3, 4))
    radius = 0.7 * (1.0 + 0.08 * np.sin(direction @ wave + seed).sum(axis=1, keepdims=True))
    ring = np.arange(cells)
    following = (ring + 1) % cells
    rows = [(i * cells, (i + 1) * cells) for i in range(cells - 1)]
    top, bottom = len(direction) - 2, len(direction) - 1
    triangles = [np.stack([np.full(cells, top), ring, following], axis=1)]
    for a, b in rows:
        triangles += [
            np.stack([a + ring, b + ring, b + following], axis=1),
            np.stack([a + ring, b + following, a + following], axis=1),
        ]
    last = (cells - 1) * cells
    triangles.append(np.stack([last + ring, np.full(cells, bottom), last + following], axis=1))
    return direction * radius, np.concatenate(triangles)


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> list[tuple[float, float, float]]:
    """Returns the corners of a box in the order of BOX_FACES."""
    return [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]


def build(room: Room, width: int, height: int) -> int:
    """Replaces the open file by the room and returns its number of triangles."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.0, 0.0, 0.0)
    white = _material("White", "ShaderNodeBsdfDiffuse", (0.7, 0.7, 0.7, 1.0))
    triangles = 2 * len(BOX_FACES)
    _mesh("Box", box((-3.0, -3.0, 0.0), (3.0, 3.0, 3.0)), [face[::-1] for face in BOX_FACES], white)
    for i in range(9):
        vertices, faces = bumpy_sphere(room.cells, i)
        place = np.array((-2.0 + 2.0 * (i % 3), -1.2 + 1.8 * (i // 3), 0.8 + 0.1 * i))
        _mesh(f"Sphere {i}", (vertices + place).tolist(), faces.tolist(), white)
        triangles += len(faces)
    if room.pane:
        glass = _material("Glass", "ShaderNodeBsdfGlass", (1.0, 1.0, 1.0, 1.0), Roughness=0.0, IOR=1.5)
        _mesh("Pane", box((-3.1, -2.8, -0.1), (3.1, -2.75, 3.1)), BOX_FACES, glass)
        triangles += 2 * len(BOX_FACES)
    _add_light()
    _add_camera()
    return triangles


def _material(name: str, kind: str, color: tuple[float, float, float, float], **inputs: float) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    node.inputs["Color"].default_value = color
    for socket, value in inputs.items():
        node.inputs[socket].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _mesh(name: str, vertices: list, faces: list, material: bpy.types.Material) -> None:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    _link(name, mesh)


def _add_light() -> None:
    data = bpy.data.lights.new("Light", "AREA")
    data.shape, data.size, data.energy = "SQUARE", 1.0, 300.0
    _link("Light", data).location = (0.0, 0.0, 2.95)


def _add_camera() -> None:
    """Adds a level camera in the middle of one wall, so that every pixel shows the inside of the room."""
    data = bpy.data.cameras.new("Camera")
    data.lens = 24.0
    camera = _link("Camera", data)
    camera.location, camera.rotation_euler = (0.0, -2.9, 1.5), (0.5 * np.pi, 0.0, 0.0)
    bpy.context.scene.camera = camera


def _link(name: str, data: bpy.types.ID) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing
