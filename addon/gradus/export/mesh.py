"""Reads evaluated meshes into arrays, without a Python loop over vertices, faces or corners.

The accessors differ between Blender versions. The type code of each array is the one in which Blender stores the
property, because `foreach_get` otherwise reads item by item.
"""

from __future__ import annotations

import hashlib
from array import array
from dataclasses import dataclass, field
from typing import Any

from .. import native
from . import attributes
from .arrays import Reader, Values, read, view
from .dicing import NO_DICING, Dicing
from .edges import edge_vertices

POINT, FACE, CORNER = 0, 1, 2


@dataclass
class MeshArrays:
    """The data of a GradusMesh."""

    name: str
    positions: Values
    corner_vertices: Values
    triangle_corners: Values
    triangle_faces: Values
    face_count: int
    face_materials: Values | None = None
    normal_domain: int = FACE
    normals: Values | None = None
    attributes: list[attributes.AttributeArrays] = field(default_factory=list)
    default_uv: str = ""
    texture_space: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0, 1.0, 1.0)
    generated_points: array | None = None
    edge_vertices: array | None = None  # 2 vertices per edge
    dicing: Dicing = NO_DICING
    motion: tuple[array, array] | None = None  # positions one frame before and after
    blur: array | None = None  # positions while the shutter is open, key after key

    def content_hash(self) -> bytes:
        """Returns a hash that is equal for equal content.

        SHA-1 is fast because processors support it: 50 MB take 26 ms.
        """
        digest = hashlib.sha1(usedforsecurity=False)
        for values in (self.positions, self.corner_vertices, self.triangle_corners, self.triangle_faces):
            digest.update(values)
        rest = (self.face_count, self.normal_domain, self.default_uv, self.texture_space, self.dicing)
        digest.update(repr(rest).encode())
        optional = (
            ("m", self.face_materials),
            ("n", self.normals),
            ("g", self.generated_points),
            ("b", self.blur),
            ("e", self.edge_vertices),
            *zip("pf", self.motion or (), strict=False),
        )
        for mark, values in optional:
            if values is not None:
                digest.update(mark.encode())
                digest.update(values)
        for attribute in self.attributes:
            digest.update(repr((attribute.name, attribute.domain, attribute.channels, attribute.is_uv)).encode())
            digest.update(attribute.data)
        return digest.digest()


def read_positions(mesh: Any, get: Reader = read) -> Values:
    """Returns 3 floats per vertex."""
    position = mesh.attributes.get("position")
    if position is not None and position.data_type == "FLOAT_VECTOR":
        return get(position.data, "vector", "f", 3)
    return read(mesh.vertices, "co", "f", 3)


def corner_vertices(mesh: Any, get: Reader = read) -> Values:
    """Returns the vertex of each corner."""
    stored = mesh.attributes.get(".corner_vert")
    if stored is not None:
        return get(stored.data, "value", "i")
    values = read(mesh.loops, "vertex_index", "I")
    return array("i", values.tobytes())


def _triangle_faces(mesh: Any, get: Reader) -> Values:
    if hasattr(mesh, "loop_triangle_polygons"):
        return get(mesh.loop_triangle_polygons, "value", "i")
    values = read(mesh.loop_triangles, "polygon_index", "I")
    return array("i", values.tobytes())


def _normals(mesh: Any, get: Reader) -> tuple[int, Values | None]:
    """Returns domain and values of the shading normals."""
    if hasattr(mesh, "corner_normals"):
        if mesh.normals_domain == "FACE":
            return FACE, None
        if mesh.normals_domain == "POINT":
            return POINT, get(mesh.vertex_normals, "vector", "f", 3)
        return CORNER, get(mesh.corner_normals, "vector", "f", 3)
    return _normals_by_flags(mesh)


def _normals_by_flags(mesh: Any) -> tuple[int, array | None]:
    """Returns domain and values of the shading normals before 4.1, where the flags of faces define the domain."""
    if not mesh.use_auto_smooth and not mesh.has_custom_normals:
        smooth = sum(read(mesh.polygons, "use_smooth", "I"))
        if smooth == 0:
            return FACE, None
        if smooth == len(mesh.polygons):
            # The library computes them: Blender before 4.0 sums them in any order, so that their last bits differ
            # between evaluations.
            return POINT, None
    mesh.calc_normals_split()
    return CORNER, _without_vertex_normals(mesh, read(mesh.loops, "normal", "f", 3))


def _without_vertex_normals(mesh: Any, normals: array) -> array:
    """Returns the normals of corners, and 0 where a corner has the normal of its vertex.

    The library computes vertex normals, because those of Blender before 4.0 differ in their last bits from process to
    process, and with them the key of the scene would differ.
    """
    import numpy as np  # imported late, because few meshes have normals of corners and the import is slow

    def bits(values: array) -> Any:
        return np.frombuffer(values, dtype=np.int32).reshape(-1, 3)

    own = bits(read(mesh.vertices, "normal", "f", 3))[np.frombuffer(corner_vertices(mesh), dtype=np.int32)]
    kept = np.where((bits(normals) == own).all(axis=1, keepdims=True), 0, bits(normals))
    return array("f", kept.astype(np.int32).tobytes())


def _face_materials(mesh: Any, get: Reader) -> Values | None:
    """Returns the material slot of each face, or None if all faces use slot 0."""
    stored = mesh.attributes.get("material_index")
    if stored is None or stored.domain != "FACE" or stored.data_type != "INT":
        return None
    return get(stored.data, "value", "i")


def read_mesh(
    mesh: Any, wanted: frozenset[str] | None, original: Any = None, with_edges: bool = False, is_kept: bool = True
) -> MeshArrays:
    """Reads an evaluated mesh.

    wanted: names of the attributes that materials use, None for all; the UV map that is active for renders is always
    read. original: the mesh before its modifiers, if they may have deformed it. with_edges: whether the library needs
    edges. is_kept: whether the arrays are used after Blender may have changed or freed the mesh, which takes copies.
    """
    get = read if is_kept else view
    mesh.calc_loop_triangles()
    domain, normals = _normals(mesh, get)
    arrays = MeshArrays(
        name=mesh.name,
        positions=read_positions(mesh, get),
        corner_vertices=corner_vertices(mesh, get),
        triangle_corners=get(mesh.loop_triangles, "loops", "I", 3),
        triangle_faces=_triangle_faces(mesh, get),
        face_count=len(mesh.polygons),
        face_materials=_face_materials(mesh, get),
        normal_domain=domain,
        normals=normals,
        default_uv=attributes.default_uv(mesh),
        texture_space=(*mesh.texspace_location, *mesh.texspace_size),
    )
    arrays.attributes = attributes.read_attributes(mesh, wanted, arrays.default_uv, get)
    if with_edges:
        arrays.edge_vertices = edge_vertices(mesh)
    if original is not None:
        arrays.generated_points = _generated_points(mesh, arrays.positions, original)
    return arrays


def _generated_points(mesh: Any, positions: Values, original: Any) -> array | None:
    """Returns the positions that generated coordinates are made of, or None if they are those of the mesh."""
    # For final renders, Blender carries them along through all modifiers, those that add vertices, too.
    carried = read(mesh.vertices, "undeformed_co", "f", 3)
    if carried.tobytes() != positions.tobytes():
        return carried
    if original.is_editmode or len(original.vertices) != len(mesh.vertices):
        return None
    undeformed = read_positions(original)
    return undeformed if undeformed.tobytes() != positions.tobytes() else None


def fill_mesh(arrays: MeshArrays) -> tuple[native.Mesh, list[Any]]:
    """Returns a native Mesh, and the objects that must stay alive until the library has copied it."""
    struct = native.Mesh()
    positions, times = arrays.positions, None
    struct.key_count = 1
    if arrays.motion is not None:
        positions = array("f", b"".join((arrays.motion[0], arrays.positions, arrays.motion[1])))
        times = array("f", [-1.0, 0.0, 1.0])
        struct.key_count = 3
    struct.key_times = native.pointer(times)
    struct.vertex_count = len(arrays.positions) // 3
    struct.positions = native.pointer(positions)
    struct.corner_count = len(arrays.corner_vertices)
    struct.corner_vertices = native.pointer(arrays.corner_vertices)
    struct.triangle_count = len(arrays.triangle_corners) // 3
    struct.triangle_corners = native.pointer(arrays.triangle_corners)
    struct.triangle_faces = native.pointer(arrays.triangle_faces)
    struct.face_count = arrays.face_count
    struct.face_materials = native.pointer(arrays.face_materials)
    struct.normal_domain = arrays.normal_domain
    struct.normals = native.pointer(arrays.normals)
    records = attributes.fill_attributes(arrays.attributes)
    struct.attribute_count = len(arrays.attributes)
    struct.attributes = records
    struct.default_uv = native.name(arrays.default_uv) if arrays.default_uv else None
    struct.generated_location[:] = arrays.texture_space[:3]
    struct.generated_size[:] = arrays.texture_space[3:]
    struct.generated_points = native.pointer(arrays.generated_points)
    struct.shutter_positions = native.pointer(arrays.blur)
    struct.shutter_key_count = len(arrays.blur) // len(arrays.positions) if arrays.blur else 0
    struct.edge_vertices = native.pointer(arrays.edge_vertices)
    struct.edge_count = len(arrays.edge_vertices) // 2 if arrays.edge_vertices else 0
    struct.dicing_levels = arrays.dicing.levels
    struct.dicing_rate = arrays.dicing.rate
    struct.dicing_length = arrays.dicing.length
    struct.offscreen_dicing_scale = arrays.dicing.offscreen_scale
    struct.dicing_tolerance = arrays.dicing.tolerance
    struct.name = native.name(arrays.name)
    return struct, [positions, times, records, arrays]
