"""A library that only records copies of the C structs of an export, so that tests of the export need no render."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np


def values(pointer: Any, *shape: int) -> np.ndarray | None:
    """Returns a copy of the array at a typed pointer; None for NULL."""
    if not pointer or 0 in shape:
        return None
    return np.ctypeslib.as_array(pointer, shape=shape).copy()


@dataclass
class RecordedMesh:
    name: str
    positions: np.ndarray | None
    keys: int
    triangles: int
    faces: int
    normal_domain: int
    normals: np.ndarray | None
    face_materials: np.ndarray | None
    default_uv: str
    attributes: dict[str, tuple[int, bool, np.ndarray]]  # name: domain, is_uv, values
    generated: tuple[list[float], list[float]]
    shutter: np.ndarray | None  # positions by key, vertex


def _shutter_matrices(record: Any, count: int) -> list[np.ndarray | None]:
    """Returns the matrices of each instance while the shutter is open; None for static instances."""
    first, counts = values(record.shutter_first, count), values(record.shutter_count, count)
    if first is None:
        return [None] * count
    matrices = values(record.shutter_matrices, record.shutter_size, 4, 4)
    return [matrices[first[i] : first[i] + counts[i]] if counts[i] else None for i in range(count)]


@dataclass
class Recording:
    """Stands in for native.Library."""

    calls: list[str] = field(default_factory=list)
    meshes: dict[int, RecordedMesh] = field(default_factory=dict)
    images: dict[int, Any] = field(default_factory=dict)
    materials: dict[int, str] = field(default_factory=dict)
    instances: dict[str, Any] = field(default_factory=dict)
    lights: list[Any] = field(default_factory=list)
    camera: Any = None
    dicing_camera: Any = None
    shutter: dict[str, Any] = field(default_factory=dict)
    world: Any = None
    channels: list[tuple[int, str, int]] = field(default_factory=list)  # kind, name, levels

    def scene_set_mesh(self, _scene: int, key: int, reference: Any) -> None:
        mesh = reference._obj
        self.calls.append("mesh")
        attributes = {}
        elements = {0: mesh.vertex_count, 1: mesh.face_count, 2: mesh.corner_count}
        for index in range(mesh.attribute_count):
            record = mesh.attributes[index]
            data = values(record.data, elements[record.domain], record.channels)
            attributes[record.name.decode()] = (record.domain, bool(record.is_uv), data)
        self.meshes[key] = RecordedMesh(
            mesh.name.decode(),
            values(mesh.positions, mesh.key_count, mesh.vertex_count, 3),
            mesh.key_count,
            mesh.triangle_count,
            mesh.face_count,
            mesh.normal_domain,
            values(mesh.normals, elements[mesh.normal_domain], 3),
            values(mesh.face_materials, mesh.face_count),
            (mesh.default_uv or b"").decode(),
            attributes,
            (list(mesh.generated_location), list(mesh.generated_size)),
            values(mesh.shutter_positions, mesh.shutter_key_count, mesh.vertex_count, 3),
        )

    def scene_set_image(self, _scene: int, key: int, reference: Any) -> None:
        image = reference._obj
        self.calls.append("image")
        tiles = []
        for index in range(image.tile_count):
            tile = image.tiles[index]
            tiles.append(
                {
                    "number": tile.number,
                    "source": tile.source,
                    "path": tile.path.decode(),
                    "size": (tile.width, tile.height),
                    "bytes": tile.data_size,
                }
            )
        self.images[key] = {
            "name": image.name.decode(),
            "alpha": image.alpha_mode,
            "float": bool(image.is_float),
            "space": image.color_space.decode(),
            "tiles": tiles,
        }

    def scene_set_material(self, _scene: int, key: int, reference: Any) -> None:
        self.calls.append("material")
        self.materials[key] = (reference._obj.name or b"").decode()

    def scene_set_instances(self, _scene: int, reference: Any) -> None:
        record = reference._obj
        self.calls.append("instances")
        count = record.count
        first, counts, materials = (
            values(record.material_first, count),
            values(record.material_count, count),
            values(record.materials, record.materials_size),
        )
        self.instances = {
            "count": count,
            "meshes": values(record.meshes, count),
            "ids": values(record.ids, count),
            "matrices": values(record.matrices, count, 4, 4),
            "previous": values(record.matrices_previous, count, 4, 4),
            "next": values(record.matrices_next, count, 4, 4),
            "visibility": values(record.visibility, count),
            "random": values(record.random_ids, count),
            "pass_index": values(record.pass_indices, count),
            "colors": values(record.colors, count, 4),
            "generated": values(record.generated, count, 3),
            "uvs": values(record.uvs, count, 2),
            "shadow_terminator_offset": values(record.shadow_terminator_offsets, count),
            "shadow_terminator_shading_offset": values(record.shadow_terminator_shading_offsets, count),
            "receiver_set": values(record.receiver_sets, count),
            "receiver_mask": values(record.receiver_masks, count),
            "blocker_set": values(record.blocker_sets, count),
            "blocker_mask": values(record.blocker_masks, count),
            "materials": [list(materials[first[i] : first[i] + counts[i]]) if counts[i] else [] for i in range(count)],
            "shutter": _shutter_matrices(record, count),
            "light_groups": values(record.light_groups, count),
            "names": [record.names[record.name_index[i]].decode() for i in range(count)],
        }

    def scene_set_lights(self, _scene: int, records: Any, count: int) -> None:
        self.calls.append("lights")
        self.lights = [type(records[i]).from_buffer_copy(records[i]) for i in range(count)]

    def scene_set_camera(self, _scene: int, reference: Any) -> None:
        self.calls.append("camera")
        camera = reference._obj
        self.camera = type(camera).from_buffer_copy(camera)
        self.shutter = {
            "open": camera.shutter_open,
            "close": camera.shutter_close,
            "curve": values(camera.shutter_curve, camera.shutter_curve_count),
            "matrices": values(camera.shutter_matrices, camera.shutter_key_count, 4, 4),
            "windows": values(camera.shutter_windows, camera.shutter_key_count, 4),
        }

    def scene_set_dicing_camera(self, _scene: int, reference: Any) -> None:
        self.dicing_camera = None if reference is None else type(reference._obj).from_buffer_copy(reference._obj)

    def scene_set_world(self, _scene: int, reference: Any) -> None:
        self.calls.append("world")
        self.world = type(reference._obj).from_buffer_copy(reference._obj)

    def scene_set_channels(self, _scene: int, records: Any, count: int) -> None:
        self.calls.append("channels")
        self.channels = [(records[i].kind, records[i].name.decode(), records[i].levels) for i in range(count)]

    def scene_remove(self, _scene: int, kind: int, key: int) -> None:
        self.calls.append("remove")
        (self.meshes, self.images, self.materials)[kind].pop(key)


def export(scene: bpy.types.Scene, **arguments: Any) -> tuple[Recording, Any]:
    """Exports the scene as the viewport evaluates it. Returns the recording and the report."""
    from gradus.export import Exporter

    recording = Recording()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    return recording, Exporter(recording, 1).sync(depsgraph, **arguments)


def add(data: Any, name: str = "Object", location: tuple[float, float, float] = (0, 0, 0)) -> bpy.types.Object:
    """Adds an object of `data` to the current scene and returns it."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = location
    return obj


def add_camera(**settings: Any) -> bpy.types.Object:
    """Adds the scene's camera, 5 m above the origin, looking down."""
    data = bpy.data.cameras.new("Camera")
    for name, value in settings.items():
        setattr(data, name, value)
    camera = add(data, "Camera", (0, 0, 5))
    bpy.context.scene.camera = camera
    return camera


def grid(cells: int = 1, size: float = 2.0, name: str = "Grid") -> bpy.types.Mesh:
    """Returns a square in the XY plane of cells x cells faces with a UV map."""
    step = size / cells
    side = range(cells + 1)
    vertices = [(step * x - size / 2, step * y - size / 2, 0.0) for y in side for x in side]
    faces = [
        (y * (cells + 1) + x, y * (cells + 1) + x + 1, (y + 1) * (cells + 1) + x + 1, (y + 1) * (cells + 1) + x)
        for y in range(cells)
        for x in range(cells)
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    layer = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        x, y, _ = vertices[loop.vertex_index]
        layer.data[loop.index].uv = (x / size + 0.5, y / size + 0.5)
    return mesh
