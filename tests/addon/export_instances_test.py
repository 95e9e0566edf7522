"""Instances: matrices, identity, visibility, slots and values of Object Info."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from gradus.export import shadow_terminator
from support import recording
from support.animation import step

CAMERA, GLOSSY, HOLDOUT = 1, 4, 64


def _collection_instances(count: int) -> bpy.types.Object:
    """Adds a collection with one grid, which is instanced by parented empties."""
    source = bpy.data.collections.new("Source")
    obj = bpy.data.objects.new("Inner", recording.grid(1))
    obj.location = (0, 0, 1)
    source.objects.link(obj)
    for index in range(count):
        empty = recording.add(None, f"Copy {index}", (index, 0, 0))
        empty.instance_type = "COLLECTION"
        empty.instance_collection = source
    return obj


def test_collection_instances_share_a_mesh(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    _collection_instances(4)
    recorded, _ = recording.export(scene)
    assert recorded.instances["count"] == 4 and len(recorded.meshes) == 1
    places = sorted(
        tuple(matrix[3, :3]) for matrix in recorded.instances["matrices"]
    )  # column-major, so that the translation is the last row
    assert np.allclose(places, [(i, 0, 1) for i in range(4)])
    assert len(set(recorded.instances["ids"])) == 4
    assert len(set(recorded.instances["random"])) == 4


def test_identity_survives_renames_and_order(scene: bpy.types.Scene) -> None:
    from gradus.export import Exporter

    recording.add_camera()
    for index in range(3):
        recording.add(recording.grid(1 + index), f"Object {index}", (index, 0, 0))
    recorded = recording.Recording()
    exporter = Exporter(recorded, 1)

    def ids_by_place() -> dict[float, int]:
        exporter.sync(bpy.context.evaluated_depsgraph_get())
        return {
            float(matrix[3, 0]): key
            for matrix, key in zip(recorded.instances["matrices"], recorded.instances["ids"], strict=True)
        }

    before = ids_by_place()
    bpy.data.objects["Object 0"].name = "Zzz"
    assert ids_by_place() == before


def test_identity_does_not_depend_on_the_frames_exported_before(scene: bpy.types.Scene) -> None:
    """Stored frames of several jobs are compared by it. An object that returns after it was hidden is the same one."""
    from gradus.export import Exporter

    recording.add_camera()
    guest = recording.add(recording.grid(2), "Guest")
    recording.add(recording.grid(1), "Object", (1, 0, 0))
    _collection_instances(2)
    step(guest, "hide_viewport", {1: False, 2: True, 3: False})
    recorded = recording.Recording()

    def ids_at(exporter: Exporter, frame: int) -> set[int]:
        scene.frame_set(frame)
        exporter.sync(bpy.context.evaluated_depsgraph_get())
        return set(map(int, recorded.instances["ids"]))

    exporter, other = Exporter(recorded, 1), Exporter(recorded, 1)
    everything, rest = ids_at(exporter, 1), ids_at(exporter, 2)
    assert len(everything) == 4 and rest < everything and len(rest) == 3
    assert ids_at(other, 2) == rest, "another job begins with the second frame"
    assert ids_at(exporter, 3) == ids_at(other, 3) == everything


def test_identity_of_an_object_that_takes_the_name_of_another(scene: bpy.types.Scene) -> None:
    from gradus.export import Exporter

    recording.add_camera()
    first = recording.add(recording.grid(1), "First")
    recorded = recording.Recording()
    exporter = Exporter(recorded, 1)
    exporter.sync(bpy.context.evaluated_depsgraph_get())
    before = set(recorded.instances["ids"])
    first.name = "Other"
    recording.add(recording.grid(1), "First")
    exporter.sync(bpy.context.evaluated_depsgraph_get())
    assert len(set(recorded.instances["ids"])) == 2 and before < set(recorded.instances["ids"])


def test_identity_of_an_object_that_is_made_again(scene: bpy.types.Scene) -> None:
    """As by a script that makes objects for each frame, and by undo in a viewport."""
    from gradus.export import Exporter

    recording.add_camera()
    recorded = recording.Recording()
    exporter = Exporter(recorded, 1)
    found = []
    for _ in range(3):
        before = bpy.data.objects.get("Made Again")
        if before is not None:
            before.name = "Gone"  # and still there, so that the next one has another address
        recording.add(recording.grid(1), "Made Again")
        if before is not None:
            bpy.data.objects.remove(before)
        exporter.sync(bpy.context.evaluated_depsgraph_get())
        found.append(set(recorded.instances["ids"]))
    assert found[0] == found[1] == found[2]


def test_visibility_of_object_and_instancer(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    obj = _collection_instances(1)
    obj.visible_glossy = False
    bpy.data.objects["Copy 0"].visible_camera = False
    recorded, _ = recording.export(scene)
    (bits,) = recorded.instances["visibility"]
    assert not bits & GLOSSY and not bits & CAMERA and bits & 2
    for name in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(obj, f"visible_{name}", False)
    assert recording.export(scene)[0].instances["count"] == 0


def test_holdout_and_indirect_only(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    for name in ("Holdout", "Indirect"):
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        collection.objects.link(bpy.data.objects.new(name, recording.grid(1)))
    children = scene.view_layers[0].layer_collection.children
    children["Holdout"].holdout = True
    children["Indirect"].indirect_only = True
    recorded, _ = recording.export(scene)
    bits = dict(zip(recorded.instances["names"], recorded.instances["visibility"], strict=True))
    assert bits["Holdout"] & HOLDOUT and bits["Holdout"] & CAMERA
    assert not bits["Indirect"] & CAMERA and not bits["Indirect"] & HOLDOUT


def test_hidden_instancer_and_excluded_collection(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    parent = recording.add(recording.grid(2, name="Instancer"), "Instancer")
    parent.instance_type = "VERTS"
    parent.show_instancer_for_viewport = parent.show_instancer_for_render = False
    recording.add(recording.grid(1, name="Child"), "Child").parent = parent
    gone = bpy.data.collections.new("Gone")
    scene.collection.children.link(gone)
    gone.objects.link(bpy.data.objects.new("Gone", recording.grid(1)))
    scene.view_layers[0].layer_collection.children["Gone"].exclude = True
    recorded, _ = recording.export(scene)
    assert recorded.instances["count"] == 10  # the instances and the child itself
    assert set(recorded.instances["names"]) == {"Child"}


def test_slots_linked_to_object_or_data(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    mesh = recording.grid(1)
    mesh.materials.append(bpy.data.materials.new("Of data"))
    mesh.materials.append(None)
    plain, own = recording.add(mesh, "Plain"), recording.add(mesh, "Own")
    own.material_slots[0].link = "OBJECT"
    own.material_slots[0].material = bpy.data.materials.new("Of object")
    recorded, _ = recording.export(scene)
    names = {
        name: [recorded.materials.get(key, "") for key in keys]
        for name, keys in zip(recorded.instances["names"], recorded.instances["materials"], strict=True)
    }
    empty = "" if bpy.app.version < (5, 0, 0) else "default_surface"
    assert names == {plain.name: ["Of data", empty], own.name: ["Of object", empty]}


def test_material_override(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    mesh = recording.grid(1)
    mesh.materials.append(bpy.data.materials.new("Own"))
    recording.add(mesh)
    recording.add(recording.grid(2))
    scene.view_layers[0].material_override = bpy.data.materials.new("Override")
    recorded, _ = recording.export(scene)
    assert [[recorded.materials[key] for key in keys] for keys in recorded.instances["materials"]] == [
        ["Override"],
        ["Override"],
    ]


def test_object_facts(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    obj = recording.add(recording.grid(1))
    obj.pass_index, obj.color = 7, (0.1, 0.2, 0.3, 0.4)
    recorded, _ = recording.export(scene)
    assert list(recorded.instances["pass_index"]) == [7]
    assert np.allclose(recorded.instances["colors"][0], (0.1, 0.2, 0.3, 0.4))


def test_shadow_terminator_offsets(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    for name, offset in (("Default", None), ("Off", 0.0), ("Wide", 0.5)):
        obj = recording.add(recording.grid(1), name)
        if offset is not None:
            setattr(shadow_terminator.owner(obj), shadow_terminator.GEOMETRY_OFFSET, offset)
    recorded, _ = recording.export(scene)
    found = dict(zip(recorded.instances["names"], recorded.instances["shadow_terminator_offset"], strict=True))
    assert found == pytest.approx({"Default": 0.1, "Off": 0.0, "Wide": 0.5})


def test_shading_offset(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    owner = shadow_terminator.owner(recording.add(recording.grid(1)))
    setattr(owner, shadow_terminator.shading_offset_name(owner), 0.25)
    recorded, _ = recording.export(scene)
    assert list(recorded.instances["shadow_terminator_shading_offset"]) == pytest.approx([0.25])


def test_coordinates_of_the_instancer(scene: bpy.types.Scene) -> None:
    """Instances on faces have a UV and a generated coordinate of the instancer."""
    recording.add_camera()
    parent = recording.add(recording.grid(2, name="Instancer"), "Instancer")
    parent.instance_type = "FACES"
    recording.add(recording.grid(1, name="Child"), "Child").parent = parent
    recorded, _ = recording.export(scene)
    uvs = {
        tuple(uv)
        for uv, name in zip(recorded.instances["uvs"], recorded.instances["names"], strict=True)
        if name == "Child"
    }
    assert uvs == {
        (0.0, 0.0),
        (0.25, 0.25),
        (0.25, 0.75),
        (0.75, 0.25),
        (0.75, 0.75),
    }  # the child itself has no such coordinates


def test_motion_of_instances_and_camera(scene: bpy.types.Scene) -> None:
    camera = recording.add_camera()
    scene.view_layers[0].use_pass_vector = True
    _collection_instances(2)
    for obj in (bpy.data.objects["Copy 1"], camera):
        for frame in (1, 11):
            obj.location.x += 10.0 * (frame == 11)
            obj.keyframe_insert("location", frame=frame)
        obj.animation_data.action = obj.animation_data.action  # forces an evaluation in the same depsgraph
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "BEZIER"
    scene.frame_set(6)
    recorded, _ = recording.export(scene)
    order = np.argsort(recorded.instances["matrices"][:, 3, 0])
    previous, now, following = (recorded.instances[name][order][:, 3, 0] for name in ("previous", "matrices", "next"))
    assert previous[0] == now[0] == following[0] == 0.0
    assert previous[1] < now[1] < following[1] and now[1] == pytest.approx(6.0, abs=1e-3)
    assert recorded.camera.matrix_previous[12] < recorded.camera.matrix[12] < recorded.camera.matrix_next[12]


def test_without_vector_pass_nothing_steps(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    recording.add(recording.grid(1))
    changes = []
    handler = lambda *_: changes.append(1)  # noqa: E731
    bpy.app.handlers.frame_change_pre.append(handler)
    try:
        recorded, _ = recording.export(scene)
    finally:
        bpy.app.handlers.frame_change_pre.remove(handler)
    assert changes == [] and recorded.instances["previous"] is None


@pytest.mark.parametrize("scale", [(0, 0, 0), (0, 1, 1), (-1, 1, 1), (float("nan"), 1, 1)])
def test_e2_broken_matrices_pass_through(scene: bpy.types.Scene, scale: tuple[float, float, float]) -> None:
    recording.add_camera()
    recording.add(recording.grid(1)).scale = scale
    assert recording.export(scene)[0].instances["count"] == 1


@pytest.mark.parametrize(
    "name, expected", [("Cube", 0.31314194202), ("Suzanne.001", 0.45797663927), ("é", 0.64412963390)]
)
def test_random_id_of_an_object_is_cycles_hash(name: str, expected: float) -> None:
    """The expected values of Object Info > Random were rendered with Cycles in 3.4 and 5.0."""
    from gradus.export.object_random import name_hash

    assert name_hash(name) / 2**32 == pytest.approx(expected, rel=1e-6)
