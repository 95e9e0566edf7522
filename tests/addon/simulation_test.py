"""Simulations that are not baked, in rendered animations.

The export of a frame, independent or ahead of its delivery, must equal the scene after stepping to that frame.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import pytest
from gradus import simulation
from gradus.export import Cancelled, motion
from support import animation, images, recording, simulations
from support.exports import Exports

LAST = 8
TOLERANCE = 2e-4  # caches of particles have less precision


def new_scene(kind: str, first: int = 1, last: int = LAST, temporal: bool = False) -> bpy.types.Scene:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    recording.add_camera(type="ORTHO", ortho_scale=20.0)
    scene.frame_start, scene.frame_end = 1, 50  # caches use the range of the scene
    simulations.KINDS[kind]()
    scene.frame_start, scene.frame_end = first, last
    scene.render.resolution_x, scene.render.resolution_y = 16, 9
    scene.gradus.samples, scene.gradus.reconstruction, scene.gradus.use_temporal = 2, "L2", temporal
    return scene


def check(kind: str, found: list[tuple[int, simulations.Places]], frames: range, starts_at: int = 1) -> None:
    compare(simulations.in_order(new_scene(kind, starts_at), starts_at, LAST), found, frames)


def compare(truth: dict[int, simulations.Places], found: list[tuple[int, simulations.Places]], frames: range) -> None:
    first = min(truth)
    assert [frame for frame, _ in found] == list(frames), "each frame is exported once, in order"
    for frame, places in found:
        assert set(places) == set(truth[frame]), frame
        for name, place in places.items():
            assert place == pytest.approx(truth[frame][name], abs=TOLERANCE), (frame, name)
    moving = {
        name for name in truth[LAST] if truth[LAST][name] != pytest.approx(truth[first].get(name, ()), abs=TOLERANCE)
    }
    assert moving, "the scene simulates something"


def render(scene: bpy.types.Scene, folder: Path) -> None:
    images.use_exr(scene, folder / "####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)


def check_changed(change: Callable[[bpy.types.Scene], None], temporal: bool, exports: Exports, folder: Path) -> None:
    """Changes the scene of a cloth and checks its animation."""
    scene = new_scene("cloth", temporal=temporal)
    change(scene)
    render(scene, folder)
    truth = new_scene("cloth")
    change(truth)
    compare(simulations.in_order(truth, 1, LAST), exports.of["ViewLayer"], range(1, LAST + 1))


@pytest.fixture(params=[kind for kind in simulations.KINDS if kind != "liquid"])
def kind(request: pytest.FixtureRequest) -> str:
    if not simulations.exists(request.param):
        pytest.skip("node groups that scripts can give sockets, which a simulation zone needs, came with 4.1")
    return request.param


@pytest.fixture(params=[False, True], ids=["frame by frame", "ahead"])
def temporal(request: pytest.FixtureRequest) -> bool:
    return request.param


def test_c6_a_simulation_is_that_of_the_scene_stepped_in_order(
    kind: str, temporal: bool, exports: Exports, tmp_path: Path
) -> None:
    render(new_scene(kind, temporal=temporal), tmp_path)
    check(kind, exports.of["ViewLayer"], range(1, LAST + 1))


@pytest.mark.application
def test_c6_a_liquid_that_is_computed_during_playback(temporal: bool, exports: Exports, tmp_path: Path) -> None:
    """A liquid is exported as the scene computes it. In the bpy modules, Mantaflow does not find its Python code."""
    render(new_scene("liquid", temporal=temporal), tmp_path)
    check("liquid", exports.of["ViewLayer"], range(1, LAST + 1))


def test_c6_a_later_first_frame_and_persistent_data_change_nothing(
    kind: str, temporal: bool, exports: Exports, tmp_path: Path
) -> None:
    scene = new_scene(kind, first=4, temporal=temporal)
    scene.render.use_persistent_data = True
    render(scene, tmp_path)
    check(kind, exports.of["ViewLayer"], range(4, LAST + 1), starts_at=4 if kind == "simulation zone" else 1)


def test_c6_layers_and_frames_around_for_vectors_change_nothing(
    kind: str, temporal: bool, exports: Exports, tmp_path: Path
) -> None:
    scene = new_scene(kind, temporal=temporal)
    scene.gradus.window_size, scene.gradus.window_overlap = 4, 2  # so that there are several windows
    scene.view_layers.new("Second")
    for layer in scene.view_layers:
        layer.use_pass_vector = True
    render(scene, tmp_path)
    found = dict(exports.of)
    for name in ("ViewLayer", "Second"):
        check(kind, found[name], range(1, LAST + 1))


def test_c6_consecutive_windows_show_all_simulations(kind: str, exports: Exports, tmp_path: Path) -> None:
    """Regression: particles were missing in all frames of the second window except the last."""
    scene = new_scene(kind, temporal=True)
    scene.gradus.window_size, scene.gradus.window_overlap = 4, 2
    render(scene, tmp_path)
    check(kind, exports.of["ViewLayer"], range(1, LAST + 1))


# -------------------------------------------------------------------------------- motion blur


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> dict[int, motion.Moments]:
    """Returns by frame what the export reads while the shutter is open."""
    found: dict[int, motion.Moments] = {}
    read = motion.read_moments

    def note(depsgraph: Any, *arguments: Any) -> motion.Moments:
        frame = depsgraph.scene_eval.frame_current
        found[frame] = read(depsgraph, *arguments)
        return found[frame]

    monkeypatch.setattr(motion, "read_moments", note)
    return found


def height(moment: motion.Moment) -> float:
    """Returns the height of the falling object."""
    (matrix,) = moment.matrices.values()
    positions = next(iter(moment.positions.values()), (0.0, 0.0, 0.0))
    return matrix[14] + sum(positions[2::3]) / len(positions[2::3])


@pytest.mark.parametrize("kind", ["rigid body", "cloth", "soft body"])
def test_c6_the_moments_of_a_shutter_lie_between_the_frames(
    kind: str, temporal: bool, opened: dict[int, motion.Moments], tmp_path: Path
) -> None:
    """Positions half a frame before and after are interpolated: the acceleration within a frame is small."""
    scene = new_scene(kind, temporal=temporal)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    render(scene, tmp_path)
    falls = simulations.in_order(new_scene(kind), 1, LAST + 1)
    (heights,) = (
        [place[2] + place[5] for place in places]
        for places in zip(*(falls[frame].values() for frame in falls), strict=True)
    )
    assert sorted(opened)[-(LAST):] == list(range(1, LAST + 1))
    for frame in range(3, LAST + 1):
        before, now, after = heights[frame - 2 : frame + 1]
        assert before - after > 0.01
        assert height(opened[frame][-0.5]) == pytest.approx(0.5 * (before + now), abs=0.1 * (before - now)), frame
        assert height(opened[frame][0.5]) == pytest.approx(0.5 * (now + after), abs=0.1 * (now - after)), frame


# -------------------------------------------------------------------------------- other places of simulations


def put_into_an_instanced_collection(scene: bpy.types.Scene) -> None:
    """Moves an object to a nested collection, so that the scene contains an instance of it only."""
    inner, outer = (bpy.data.collections.new(name) for name in ("Inner", "Outer"))
    for obj in [obj for obj in scene.objects if obj.type == "MESH"]:
        scene.collection.objects.unlink(obj)
        inner.objects.link(obj)
    for collection, user in ((inner, outer), (outer, scene.collection)):
        instance = bpy.data.objects.new("Instance", None)
        instance.instance_type, instance.instance_collection = "COLLECTION", collection
        user.objects.link(instance)


def put_into_the_background(scene: bpy.types.Scene) -> None:
    background = bpy.data.scenes.new("Background")
    for obj in [obj for obj in scene.objects if obj.type == "MESH"]:
        scene.collection.objects.unlink(obj)
        background.collection.objects.link(obj)
    scene.background_set = background


@pytest.mark.parametrize("hide_object", [put_into_an_instanced_collection, put_into_the_background])
def test_c6_simulations_in_instances_and_backgrounds(
    hide_object: Callable, temporal: bool, exports: Exports, tmp_path: Path
) -> None:
    """Regression: such simulations were not found and were static, without a warning."""
    check_changed(hide_object, temporal, exports, tmp_path)


def test_a_rigid_body_in_the_background_is_found() -> None:
    scene = new_scene("rigid body")
    other = bpy.data.scenes.new("Before the background")
    other.background_set = scene
    assert simulation.Simulations(other).names == ["Rigid Body World"]


def test_a_cancel_between_steps_leaves_the_scene_at_its_frame() -> None:
    """Regression: after a cancel, the scene stayed at the last stepped frame."""
    scene = new_scene("cloth", first=4)
    scene.frame_set(4)
    with pytest.raises(Cancelled):
        simulation.Simulations(scene).compute(LAST, LAST, lambda: scene.frame_current == 2)
    assert scene.frame_current == 4


# -------------------------------------------------------------------------------- invisible simulations


def hide(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    obj.hide_render = True


def collect(scene: bpy.types.Scene, obj: bpy.types.Object, *names: str) -> list[bpy.types.LayerCollection]:
    """Moves an object to nested collections. Returns their layer collections in the first view layer."""
    scene.collection.objects.unlink(obj)
    places = [scene.view_layers[0].layer_collection]
    for name in names:
        collection = bpy.data.collections.new(name)
        places[-1].collection.children.link(collection)
        places.append(places[-1].children[name])
    places[-1].collection.objects.link(obj)
    return places[1:]


def exclude(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    collect(scene, obj, "Excluded")[0].exclude = True


def hide_its_collection(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    collect(scene, obj, "Outer", "Inner")[0].collection.hide_render = True


def put_into_a_disabled_layer(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    scene.view_layers.new("Off").use = False
    exclude(scene, obj)


HIDING_CHANGES = [hide, exclude, hide_its_collection, put_into_a_disabled_layer]


def simulated_object(kind: str) -> bpy.types.Object:
    return bpy.data.objects[
        {"rigid body": "Falling", "cloth": "Cloth", "soft body": "Soft", "particles": "Emitter"}[kind]
    ]


@pytest.mark.parametrize("kind", ["rigid body", "cloth", "soft body", "particles"])
@pytest.mark.parametrize("hide_object", HIDING_CHANGES)
def test_invisible_simulations_are_ignored(hide_object: Callable, kind: str) -> None:
    """Simulations that are not visible must neither make frames independent nor require stepping the scene."""
    scene = new_scene(kind)
    assert len(simulation.Simulations(scene).names) == 1
    hide_object(scene, simulated_object(kind))
    assert simulation.Simulations(scene).names == []


def test_a_rigid_body_world_without_bodies_is_ignored(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Regression: Blender keeps a rigid body world after its bodies were deleted, and the scene was stepped for it."""
    scene = new_scene("rigid body", temporal=True)
    bpy.data.objects.remove(bpy.data.objects["Falling"])
    assert scene.rigidbody_world is not None
    assert simulation.Simulations(scene).names == []
    monkeypatch.setattr(simulation.Simulations, "compute", lambda *_: pytest.fail("nothing moves"))
    render(scene, tmp_path)


# -------------------------------------------------------------------------------- visible simulations


def show_in_another_layer(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    scene.view_layers.new("Second")
    exclude(scene, obj)


def show_inside_an_excluded_collection(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    outer, inner = collect(scene, obj, "Outer", "Inner")
    outer.exclude, inner.exclude = True, False


def show_in_another_collection(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    exclude(scene, obj)
    scene.collection.objects.link(obj)


def show_at_times(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    animation.key(obj, "hide_render", {1: True, LAST: False})
    obj.hide_render = True


def show_by_a_driver(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    obj.driver_add("hide_render").driver.expression = "frame < 4"
    obj.hide_render = True


def show_by_an_instance(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    outer, inner = collect(scene, obj, "Outer", "Inner")
    outer.exclude = inner.exclude = True
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", outer.collection
    scene.collection.objects.link(instance)


def show_by_nodes(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    group = bpy.data.node_groups.new("Instancing", "GeometryNodeTree")
    group.nodes.new("GeometryNodeObjectInfo").inputs["Object"].default_value = obj
    add_mesh(scene).modifiers.new("Nodes", "NODES").node_group = group
    obj.hide_render = True


def parent_a_child(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    child = add_mesh(scene)
    child.parent, child.parent_type = obj, "VERTEX"
    obj.hide_render = True


def be_a_boolean_operand(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    add_mesh(scene).modifiers.new("Boolean", "BOOLEAN").object = obj
    obj.hide_render = True


def be_instanced_by_particles(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    emitter = add_mesh(scene)
    settings = emitter.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.render_type, settings.instance_object = "HAIR", "OBJECT", obj
    obj.hide_render = True


def be_a_collider(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    obj.modifiers.new("Collision", "COLLISION")
    obj.hide_render = True


def be_a_force_field(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    bpy.ops.object.forcefield_toggle()
    assert obj.field.type != "NONE"
    obj.hide_render = True


def be_a_brush(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    obj.modifiers.new("Dynamic Paint", "DYNAMIC_PAINT").ui_type = "BRUSH"
    bpy.ops.dpaint.type_toggle(type="BRUSH")
    obj.hide_render = True


def be_a_fluid_source(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    obj.modifiers.new("Fluid", "FLUID").fluid_type = "FLOW"
    obj.hide_render = True


def be_a_passive_body(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    obj.hide_render = True


def add_mesh(scene: bpy.types.Scene) -> bpy.types.Object:
    mesh = bpy.data.meshes.new("Shown")
    mesh.from_pydata([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], [], [(0, 1, 2)])
    obj = bpy.data.objects.new("Shown", mesh)
    scene.collection.objects.link(obj)
    return obj


SHOWING_CHANGES = [
    show_in_another_layer,
    show_inside_an_excluded_collection,
    show_in_another_collection,
    show_at_times,
    show_by_a_driver,
    show_by_an_instance,
    show_by_nodes,
    parent_a_child,
    be_a_boolean_operand,
    be_instanced_by_particles,
    be_a_collider,
    be_a_force_field,
    be_a_brush,
    be_a_fluid_source,
    be_a_passive_body,
]


@pytest.mark.parametrize("use", SHOWING_CHANGES)
def test_hidden_simulations_that_pictures_may_show_are_found(use: Callable) -> None:
    scene = new_scene("cloth")
    use(scene, bpy.data.objects["Cloth"])
    assert "Cloth, Cloth" in simulation.Simulations(scene).names


def test_the_force_of_hidden_particles_makes_them_seen() -> None:
    scene = new_scene("particles")
    emitter = bpy.data.objects["Emitter"]
    emitter.hide_render = True
    assert simulation.Simulations(scene).names == []
    emitter.particle_systems[0].settings.force_field_1.type = "FORCE"
    assert simulation.Simulations(scene).names == ["Emitter, Particles"]


def test_a_hidden_body_counts_where_another_of_its_world_is_shown() -> None:
    scene = new_scene("rigid body")
    bpy.data.objects["Falling"].hide_render = True
    bpy.context.view_layer.objects.active = add_mesh(scene)
    bpy.ops.rigidbody.object_add()
    assert simulation.Simulations(scene).names == ["Rigid Body World"]


def test_a_layer_that_is_off_counts_where_it_is_rendered_alone() -> None:
    scene = new_scene("cloth")
    put_into_a_disabled_layer(scene, bpy.data.objects["Cloth"])
    assert simulation.Simulations(scene, "Off").names == ["Cloth, Cloth"]


def test_a_layer_that_is_keyed_counts_while_it_is_off() -> None:
    scene = new_scene("cloth")
    put_into_a_disabled_layer(scene, bpy.data.objects["Cloth"])
    animation.step(scene, 'view_layers["Off"].use', {1: False, LAST: True})
    scene.view_layers["Off"].use = False
    assert simulation.Simulations(scene).names == ["Cloth, Cloth"]


def test_a_modifier_that_is_keyed_counts_while_it_is_off() -> None:
    """Regression: the simulation was static from the frame at which the modifier was enabled."""
    scene = new_scene("cloth")
    cloth = bpy.data.objects["Cloth"]
    animation.step(cloth, 'modifiers["Cloth"].show_render', {1: False, LAST: True})
    cloth.modifiers[0].show_render = False
    assert simulation.Simulations(scene).names == ["Cloth, Cloth"]


def parent_an_invisible_object(scene: bpy.types.Scene) -> None:
    """Adds an invisible simulated object, which is also hidden in the viewport, whose depsgraph is stepped."""
    cloth = bpy.data.objects["Cloth"]
    parent_a_child(scene, cloth)
    bpy.data.objects["Shown"].parent_vertices = [48, 48, 48]
    cloth.hide_viewport = True


def test_c6_objects_that_depend_on_a_hidden_simulation_move_with_it(
    temporal: bool, exports: Exports, tmp_path: Path
) -> None:
    check_changed(parent_an_invisible_object, temporal, exports, tmp_path)


# -------------------------------------------------------------------------------- what is left behind


def test_caches_are_the_users_again_after_the_render(exports: Exports, tmp_path: Path) -> None:
    scene = new_scene("cloth", last=3)
    render(scene, tmp_path)
    cache = bpy.data.objects["Cloth"].modifiers[0].point_cache
    assert not cache.is_baked
    assert scene.frame_current == 1


def test_a_baked_simulation_is_left_alone(tmp_path: Path) -> None:
    scene = new_scene("cloth", last=3)
    cache = bpy.data.objects["Cloth"].modifiers[0].point_cache
    cache.frame_end = 3
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.bake(bake=True)
    assert simulation.Simulations(scene).names == []
    render(scene, tmp_path)
    assert cache.is_baked
