"""Meshes: attributes of all domains, normals, face materials, sharing, motion, and objects that become meshes."""

from __future__ import annotations

import sys
from typing import Any

import bpy
import numpy as np
import pytest
from gradus.export.mesh import read_mesh
from support import animation, recording

POINT, FACE, CORNER = 0, 1, 2


def _only_mesh(recorded: recording.Recording) -> recording.RecordedMesh:
    (mesh,) = recorded.meshes.values()
    return mesh


def _attribute(mesh: bpy.types.Mesh, kind: str, domain: str, key: str, values: list) -> None:
    layer = mesh.attributes.new("Wanted", kind, domain)
    for item, value in zip(layer.data, values, strict=True):
        setattr(item, key, value)


@pytest.mark.parametrize("domain, code, count", [("POINT", POINT, 9), ("FACE", FACE, 4), ("CORNER", CORNER, 16)])
@pytest.mark.parametrize(
    "kind, key, make",
    [
        ("FLOAT", "value", lambda i: i * 0.5),
        ("INT", "value", lambda i: i - 3),
        ("BOOLEAN", "value", lambda i: i % 2 == 0),
        ("FLOAT_VECTOR", "vector", lambda i: (i, -i, 0.25)),
        ("FLOAT2", "vector", lambda i: (i, -i)),
        ("FLOAT_COLOR", "color", lambda i: (i, 0.5, 0.25, 1.0)),
    ],
)
def test_attribute_domains_and_types(
    scene: bpy.types.Scene, domain: str, code: int, count: int, kind: str, key: str, make: object
) -> None:
    mesh = recording.grid(2)
    values = [make(i) for i in range(count)]
    _attribute(mesh, kind, domain, key, values)
    arrays = read_mesh(mesh, frozenset({"Wanted"}))
    (found,) = [attribute for attribute in arrays.attributes if attribute.name == "Wanted"]
    assert found.domain == code
    assert np.allclose(np.array(found.data).reshape(count, -1), np.array(values, float).reshape(count, -1))


@pytest.mark.parametrize("domain, count", [("POINT", 9), ("CORNER", 16)])
def test_byte_colours_are_linear(scene: bpy.types.Scene, domain: str, count: int) -> None:
    mesh = recording.grid(2)
    layer = mesh.color_attributes.new("Wanted", "BYTE_COLOR", domain)
    for item in layer.data:
        item.color_srgb = (0.5, 1.0, 0.0, 1.0)
    arrays = read_mesh(mesh, frozenset({"Wanted"}))
    (found,) = [attribute for attribute in arrays.attributes if attribute.name == "Wanted"]
    linear = ((0.5 + 0.055) / 1.055) ** 2.4
    assert np.allclose(np.array(found.data).reshape(count, 4), (linear, 1.0, 0.0, 1.0), atol=5e-3)


@pytest.mark.parametrize("kind, key", [("FLOAT", "value"), ("FLOAT_COLOR", "color"), ("BYTE_COLOR", "color")])
def test_arrays_without_copies_are_equal(scene: bpy.types.Scene, kind: str, key: str) -> None:
    mesh = recording.grid(3)
    layer = mesh.attributes.new("Wanted", kind, "CORNER")
    for i, item in enumerate(layer.data):
        setattr(item, key, i / 64 if key == "value" else (i / 64, 0.5, 0.25, 1.0))
    for i, polygon in enumerate(mesh.polygons):
        polygon.use_smooth, polygon.material_index = i % 2 == 0, i % 3
    copied, viewed = (read_mesh(mesh, frozenset({"Wanted"}), is_kept=is_kept) for is_kept in (True, False))
    if bpy.app.version >= (4, 1):  # earlier ones store flags beside the values
        assert isinstance(viewed.positions, memoryview)
        assert isinstance(viewed.normals, memoryview)
    assert viewed.content_hash() == copied.content_hash()


def test_only_requested_attributes_are_read(scene: bpy.types.Scene) -> None:
    mesh = recording.grid(2)
    mesh.uv_layers.new(name="Second")
    mesh.attributes.new("Other", "FLOAT", "POINT")
    mesh.uv_layers["UVMap"].active_render = True
    assert [attribute.name for attribute in read_mesh(mesh, frozenset()).attributes] == ["UVMap"]
    assert {attribute.name for attribute in read_mesh(mesh, frozenset({"Other", "Second"})).attributes} == {
        "UVMap",
        "Second",
        "Other",
    }
    mesh.uv_layers["Second"].active_render = True
    assert read_mesh(mesh, frozenset()).default_uv == "Second"


def test_uv_follows_corners(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    recording.add(recording.grid(2))
    mesh = _only_mesh(recording.export(scene)[0])
    domain, is_uv, uv = mesh.attributes["UVMap"]
    assert (domain, is_uv, mesh.default_uv) == (CORNER, True, "UVMap")
    assert np.allclose(uv[0], (0, 0)) and np.allclose(uv[2], (0.5, 0.5))


def test_normal_domains(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    mesh = recording.grid(2)
    recording.add(mesh)
    assert _only_mesh(recording.export(scene)[0]).normal_domain == FACE
    mesh.polygons.foreach_set("use_smooth", [True] * 4)
    mesh.update()
    smooth = _only_mesh(recording.export(scene)[0])
    assert smooth.normal_domain == POINT and (smooth.normals is None or np.allclose(smooth.normals, (0, 0, 1)))
    mesh.polygons[0].use_smooth = False
    mesh.update()
    mixed = _only_mesh(recording.export(scene)[0])
    is_none = ~mixed.normals.any(axis=1)  # computed by the library
    assert mixed.normal_domain == CORNER and np.allclose(mixed.normals[~is_none], (0, 0, 1))


@pytest.mark.skipif(bpy.app.version >= (4, 1, 0), reason="from 4.1 on normals have the same bits in every process")
def test_normals_that_blender_sums_in_any_order_are_computed_by_the_library(scene: bpy.types.Scene) -> None:
    """The library computes these normals, so that all processes have the same bits.

    Regression: their last bits differed between processes, so that frame stores were refused.
    """
    recording.add_camera()
    mesh = recording.grid(2)
    mesh.vertices[4].co.z = 1.0
    mesh.polygons.foreach_set("use_smooth", [False, True, True, True])
    mesh.update()
    recording.add(mesh)
    normals = _only_mesh(recording.export(scene)[0]).normals.reshape(4, 4, 3)
    assert not normals[1:].any()
    assert normals[0].any(axis=1).sum() == 3, "but where the flat face is alone"


def test_custom_split_normals(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    mesh = recording.grid(2)
    mesh.polygons.foreach_set("use_smooth", [True] * 4)
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    tilted = np.array((0.6, 0.0, 0.8))
    mesh.normals_split_custom_set([tuple(tilted)] * len(mesh.loops))
    recording.add(mesh)
    found = _only_mesh(recording.export(scene)[0])
    assert np.allclose(found.normals, tilted, atol=1e-3)


def test_materials_by_face(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    mesh = recording.grid(2)
    for name in ("A", "B"):
        mesh.materials.append(bpy.data.materials.new(name))
    mesh.polygons[1].material_index = 1
    mesh.polygons[3].material_index = 1
    recording.add(mesh)
    recorded, _ = recording.export(scene)
    assert list(_only_mesh(recorded).face_materials) == [0, 1, 0, 1]
    assert [recorded.materials[key] for key in recorded.instances["materials"][0]] == ["A", "B"]


def test_equal_meshes_are_stored_once(scene: bpy.types.Scene) -> None:
    """Equal meshes share one native mesh, including copies that a modifier makes separate evaluated meshes."""
    recording.add_camera()
    mesh = recording.grid(3)
    for index in range(3):
        recording.add(mesh, f"Linked {index}")
    for index in range(2):
        modifier = recording.add(mesh, f"Modified {index}").modifiers.new("Subdivision", "SUBSURF")
        modifier.levels = modifier.render_levels = 1
    recorded, _ = recording.export(scene)
    assert recorded.instances["count"] == 5
    assert len(recorded.meshes) == 2


def test_second_sync_sets_only_what_changed(scene: bpy.types.Scene) -> None:
    from gradus.export import Exporter

    recording.add_camera()
    first, second = (recording.add(recording.grid(2 + i, name=str(i)), str(i)) for i in range(2))
    recorded = recording.Recording()
    exporter = Exporter(recorded, 1)
    exporter.sync(bpy.context.evaluated_depsgraph_get())
    assert recorded.calls.count("mesh") == 2
    recorded.calls.clear()
    second.data.vertices[0].co.z = 1.0
    second.data.update()
    exporter.sync(bpy.context.evaluated_depsgraph_get())
    assert recorded.calls.count("mesh") == 1 and recorded.calls.count("remove") == 1
    recorded.calls.clear()
    bpy.data.objects.remove(first)
    exporter.sync(bpy.context.evaluated_depsgraph_get())
    assert recorded.calls.count("mesh") == 0 and recorded.calls.count("remove") == 1
    assert len(recorded.meshes) == 1


@pytest.mark.parametrize("kind", ["CURVE", "FONT", "SURFACE", "META"])
def test_objects_that_become_meshes(scene: bpy.types.Scene, kind: str) -> None:
    operators = {
        "CURVE": bpy.ops.curve.primitive_bezier_circle_add,
        "FONT": bpy.ops.object.text_add,
        "SURFACE": bpy.ops.surface.primitive_nurbs_surface_sphere_add,
        "META": bpy.ops.object.metaball_add,
    }
    operators[kind]()
    if kind == "CURVE":
        bpy.context.object.data.bevel_depth = 0.1
    recording.add_camera()
    recorded, report = recording.export(scene)
    assert recorded.instances["count"] == 1 and _only_mesh(recorded).triangles > 10
    assert report.warnings == []


def test_generated_coordinates_come_from_the_undeformed_mesh(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    obj = recording.add(recording.grid(2))
    modifier = obj.modifiers.new("Displace", "DISPLACE")
    modifier.strength = 1.0
    mesh = _only_mesh(recording.export(scene)[0])
    assert np.allclose(mesh.positions[0][:, 2].max(), 0.5, atol=0.51) and mesh.positions[0][:, 2].max() > 0.1
    location, size = mesh.generated
    assert np.allclose(size[:2], (1, 1)) and np.allclose(location[:2], (0, 0))


def test_motion_of_a_shape_key(scene: bpy.types.Scene) -> None:
    """Only deforming meshes have positions of neighbouring frames, and the scene returns to its frame."""
    recording.add_camera()
    scene.view_layers[0].use_pass_vector = True
    obj = recording.add(recording.grid(1), "Deforming")
    recording.add(recording.grid(2, name="Still"), "Still")
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Up")
    for point in key.data:
        point.co.z = 1.0
    for frame, value in ((1, 0.0), (11, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    animation.make_linear(obj.data.shape_keys)
    scene.frame_set(5)
    recorded, _ = recording.export(scene)
    meshes = {mesh.name: mesh for mesh in recorded.meshes.values()}
    assert scene.frame_current == 5
    assert meshes["Still"].keys == 1
    moving = meshes["Grid"]
    assert moving.keys == 3
    assert np.allclose(moving.positions[:, 0, 2], (0.3, 0.4, 0.5), atol=1e-5)


def test_topology_change_has_no_motion(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    scene.view_layers[0].use_pass_vector = True
    obj = recording.add(recording.grid(2))
    modifier = obj.modifiers.new("Array", "ARRAY")
    for frame in (1, 2, 3):
        modifier.count = frame
        modifier.keyframe_insert("count", frame=frame)
    scene.frame_set(2)
    assert _only_mesh(recording.export(scene)[0]).keys == 1


@pytest.mark.parametrize("case", ["nan", "inf", "no_faces", "loose_edges", "ngon", "zero_area"])
def test_e2_broken_meshes_pass_through(scene: bpy.types.Scene, case: str) -> None:
    recording.add_camera()
    mesh = recording.grid(2)
    if case == "nan":
        mesh.vertices[0].co = (float("nan"),) * 3
    elif case == "inf":
        mesh.vertices[0].co = (float("inf"), 0, 0)
    elif case == "no_faces":
        mesh.clear_geometry()
        mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    elif case == "loose_edges":
        mesh.clear_geometry()
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 5, 5)], [(0, 3)], [(0, 1, 2)])
    elif case == "ngon":
        mesh.clear_geometry()
        angles = np.linspace(0, 2 * np.pi, 11)[:-1]
        mesh.from_pydata([(float(np.cos(a)), float(np.sin(a)), 0.0) for a in angles], [], [range(10)])
    else:
        mesh.vertices.foreach_set("co", [0.0] * 27)
    recording.add(mesh)
    recorded, _ = recording.export(scene)
    assert recorded.instances["count"] == (0 if case == "no_faces" else 1)
    if case == "ngon":
        assert _only_mesh(recorded).triangles == 8


def _lines_run(scene: bpy.types.Scene, cells: int) -> int:
    """Returns the number of Python lines that the export of one grid executes."""
    mesh = recording.grid(cells)
    obj = recording.add(mesh)
    bpy.context.evaluated_depsgraph_get().update()
    lines = 0

    def count(_frame: Any, event: str, _argument: Any) -> Any:
        nonlocal lines
        lines += event == "line"
        return count

    sys.settrace(count)
    try:
        recorded, _ = recording.export(scene)
    finally:
        sys.settrace(None)
    assert _only_mesh(recorded).triangles == 2 * cells * cells
    bpy.data.objects.remove(obj)
    return lines


def test_large_meshes_take_no_more_lines_of_python(scene: bpy.types.Scene) -> None:
    """The export has no loop over vertices, faces or corners, which would take seconds for a million triangles."""
    recording.add_camera()
    _lines_run(scene, 2)  # makes late imports, whose lines are not counted
    assert _lines_run(scene, 4) == _lines_run(scene, 64)
