"""Light and shadow linking as sets and masks of the library."""

from __future__ import annotations

import bpy
import pytest
from gradus.export import light_linking
from support import recording

if bpy.app.version < (4, 0, 0):
    pytest.skip("light linking came with 4.0", allow_module_level=True)


def collection(*names: str, exclude: tuple[str, ...] = ()) -> bpy.types.Collection:
    made = bpy.data.collections.new("Linked")
    for name in names + exclude:
        made.objects.link(bpy.data.objects[name])
    for obj, entry in zip(made.objects, made.collection_objects, strict=True):
        entry.light_linking.link_state = "EXCLUDE" if obj.name in exclude else "INCLUDE"
    return made


@pytest.fixture
def light(scene: bpy.types.Scene) -> bpy.types.Object:
    recording.add_camera()
    for name in "ABC":
        recording.add(recording.grid(1), name)
    return recording.add(bpy.data.lights.new("Light", "POINT"), "Light")


def receivers(scene: bpy.types.Scene) -> tuple[str, dict[str, int]]:
    """Returns the objects that the light lights, and the sets of all objects."""
    recorded, report = recording.export(scene)
    assert report.warnings == []
    sets = dict(zip(recorded.instances["names"], map(int, recorded.instances["receiver_set"]), strict=True))
    (light,) = recorded.lights
    return "".join(sorted(name for name in sets if light.receiver_mask >> sets[name] & 1)), sets


def test_nothing_is_linked_in_an_ordinary_scene(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    recorded, _ = recording.export(scene)
    assert recorded.instances["receiver_set"] is None
    assert recorded.lights[0].receiver_mask == recorded.lights[0].blocker_mask == light_linking.ALL_OBJECTS


def test_included(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    light.light_linking.receiver_collection = collection("A", "C")
    lit, sets = receivers(scene)
    assert lit == "AC"
    assert sets["A"] == sets["C"] != sets["B"] == 0


def test_excluded(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    light.light_linking.receiver_collection = collection(exclude=("A",))
    assert receivers(scene)[0] == "BC"


def test_an_object_that_is_not_rendered_is_included(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    light.light_linking.receiver_collection = collection("A")
    bpy.data.objects["A"].hide_viewport = True
    recorded, _ = recording.export(scene)
    assert recorded.lights[0].receiver_mask == light_linking.NO_OBJECT


def test_an_empty_collection_links_nothing(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    light.light_linking.receiver_collection = collection()
    recorded, _ = recording.export(scene)
    assert recorded.lights[0].receiver_mask == light_linking.ALL_OBJECTS


def test_blockers_of_an_object(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    bpy.data.objects["A"].light_linking.blocker_collection = collection("B")
    recorded, _ = recording.export(scene)
    of = {name: i for i, name in enumerate(recorded.instances["names"])}
    mask, sets = int(recorded.instances["blocker_mask"][of["A"]]), recorded.instances["blocker_set"]
    assert [name for name in "ABC" if mask >> int(sets[of[name]]) & 1] == ["B"]
    assert recorded.lights[0].blocker_mask == light_linking.ALL_OBJECTS


def test_too_many_sets_are_named(scene: bpy.types.Scene, light: bpy.types.Object) -> None:
    for i in range(70):
        recording.add(recording.grid(1), f"Part {i}")
        lamp = recording.add(bpy.data.lights.new("Light", "POINT"), f"Light {i}")
        lamp.light_linking.receiver_collection = collection(f"Part {i}")
    (warning,) = recording.export(scene)[1].warnings
    assert warning.startswith("Light linking: more than 63 different sets of receivers")
