"""Animations with Python handlers and drivers: every frame shows its own state, whatever was sampled ahead."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import animation, handlers, output
from gradus.failure import Failure
from support import images, recording, simulations
from support.animation import key, step
from support.exports import Exports

WIDTH, HEIGHT = 32, 18
KINDS = ("render_pre", "render_post", "render_write", "frame_change_pre", "frame_change_post", "depsgraph_update_post")
Scene = bpy.types.Scene
Handle = Callable[[str, Callable[[int], Any]], Callable[..., None]]


@pytest.fixture
def square(scene: Scene) -> Scene:
    """Returns a scene with a square in a grey world, and eight frames."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    square = recording.add(recording.grid(1), "Square")
    for name in ("White", "Black"):
        bpy.data.materials.new(name).diffuse_color = (0.8, 0.8, 0.8, 1.0) if name == "White" else (0.0, 0.0, 0.0, 1.0)
    square.data.materials.append(bpy.data.materials["White"])
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.frame_start, scene.frame_end = 1, 8
    scene.gradus.reconstruction, scene.gradus.samples = "L2", 4
    return scene


@pytest.fixture
def handle() -> Iterator[Handle]:
    """Returns a function that adds a handler of a kind, which calls a function with the frame."""
    before = {kind: list(getattr(bpy.app.handlers, kind)) for kind in KINDS}

    def add(kind: str, action: Callable[[int], Any]) -> Callable[..., None]:
        def handler(scene: Scene, *_: Any) -> None:
            action(scene.frame_current)

        getattr(bpy.app.handlers, kind).append(handler)
        return handler

    yield add
    for kind, listed in before.items():
        getattr(bpy.app.handlers, kind)[:] = listed


def animate(scene: Scene, folder: Path) -> dict[int, np.ndarray]:
    """Renders the animation. Returns its pictures by frame."""
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    return {
        frame: images.read(folder / f"f_{frame:04d}.exr")["Combined"]
        for frame in range(scene.frame_start, scene.frame_end + 1)
    }


def shows(picture: np.ndarray) -> float:
    """Returns the place of the square in a picture, in metres: the mean column of pixels that differ from the world."""
    grey = picture[..., :3].mean(axis=2)
    differs = np.abs(grey - grey[0, 0]) > 0.1 * grey[0, 0]
    assert differs.any(), "the square is in the picture"
    return (np.nonzero(differs)[1].mean() + 0.5 - WIDTH / 2) * 4.0 / WIDTH


def place(frame: int) -> float:
    return 0.25 * (frame - 4)


def move(frame: int) -> None:
    bpy.data.objects["Square"].location.x = place(frame)


def warnings(lines: list[dict[str, Any]]) -> list[str]:
    return [text for line in lines for text in line["warnings"] if "handlers" in text]


def alone(lines: list[dict[str, Any]]) -> list[int]:
    """Returns the frames that were rendered by themselves because of handlers."""
    return [line["frame"] for line in lines if "handlers" in line["plan"].get("frame_by_frame", "")]


# -------------------------------------------------------------------------------- handlers of renders


def swap_material(frame: int) -> None:
    name = "Black" if frame % 2 else "White"
    bpy.data.objects["Square"].data.materials[0] = bpy.data.materials[name]


def show(frame: int) -> None:
    bpy.data.objects["Square"].hide_render = frame % 2 == 0


def deform(frame: int) -> None:
    bpy.data.objects["Square"].data.vertices[0].co.x = -1.0 + 0.1 * frame


def brighten(frame: int) -> None:
    world, color = bpy.context.scene.world, (0.1 * frame, 0.1, 0.1)
    world.color = color
    if world.node_tree is not None:  # from Blender 5.0 on, every world has nodes
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)


def zoom(frame: int) -> None:
    bpy.context.scene.camera.data.ortho_scale = 4.0 + 0.1 * frame


def take_more_samples(frame: int) -> None:
    bpy.context.scene.gradus.samples = 4 if frame == 1 else 6


@pytest.mark.parametrize("change", [move, swap_material, show, deform, brighten, zoom, take_more_samples])
def test_c9_what_render_pre_sets_for_a_frame_is_in_it(
    square: Scene, handle: Handle, lines: Any, render: Callable[..., images.Passes], tmp_path: Path, change: Any
) -> None:
    if change is show and bpy.app.version >= (5, 2, 0):
        pytest.skip("a still crashes in Blender 5.2 if render_pre hides an object, also without frames ahead")
    square.frame_end = 4
    handle("render_pre", change)
    pictures = animate(square, tmp_path)
    assert alone(lines()) == [2, 3, 4]
    found = warnings(lines())
    assert len(found) == 1
    assert "render_pre: handle.<locals>" in found[0]
    for frame in (2, 3, 4):
        assert np.array_equal(pictures[frame], render(square, frame=frame)["Combined"]), frame
    still = render(square, frame=1)["Combined"]
    assert np.abs(pictures[1] - still).mean() < 0.02, "the first frame has its neighbours' samples where they fit"
    assert animation._running == {}
    assert animation._given_up == set()


@pytest.mark.parametrize("kind", ["render_post", "render_write"])
def test_c9_what_a_handler_sets_after_a_frame_is_in_the_next(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path, kind: str
) -> None:
    square.frame_end = 4
    move(1)
    handle(kind, lambda frame: move(frame + 1))
    pictures = animate(square, tmp_path)
    assert np.allclose([shows(pictures[frame]) for frame in range(1, 5)], list(map(place, range(1, 5))), atol=0.07)
    assert alone(lines()) == [2, 3, 4]
    assert len(warnings(lines())) == 1


def test_c9_a_late_change_leaves_the_frames_before_it_as_they_are(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path
) -> None:
    square.frame_end = 12
    handle("render_pre", lambda frame: move(8 if frame >= 8 else 4))
    pictures = animate(square, tmp_path)
    expected = [place(8 if frame >= 8 else 4) for frame in range(1, 13)]
    assert np.allclose([shows(pictures[frame]) for frame in range(1, 13)], expected, atol=0.07)
    assert alone(lines()) == [8, 9, 10, 11, 12]
    assert len(warnings(lines())) == 1
    assert "From frame 8 on" in warnings(lines())[0]


@pytest.mark.parametrize("kind", KINDS)
def test_c9_handlers_that_only_look_keep_temporal(
    square: Scene, handle: Handle, lines: Any, exports: Exports, tmp_path: Path, kind: str
) -> None:
    animate_square(square)
    without = animate(square, tmp_path)
    assert exports.frames() == list(range(1, 9)), "without handlers nothing is exported twice"
    seen: list[int] = []
    handle(kind, seen.append)
    found = animate(square, tmp_path)
    assert all(np.array_equal(found[frame], without[frame]) for frame in found)
    assert alone(lines()) == warnings(lines()) == []
    assert sorted(exports.frames()) == sorted([*range(1, 9), *range(1, 9), *range(2, 9)])
    if kind.startswith("render"):
        assert seen == list(range(1, 9)), "handlers of renders run once a frame"


def animate_square(scene: Scene) -> None:
    """Animates what is exported under keys that change from frame to frame: a mesh and its material."""
    square = bpy.data.objects["Square"]
    square.shape_key_add(name="Basis")
    shape = square.shape_key_add(name="Wide")
    shape.data[0].co.x = -1.5
    for frame in (scene.frame_start, scene.frame_end):
        move(frame)
        square.keyframe_insert("location", frame=frame)
        shape.value = frame / scene.frame_end
        shape.keyframe_insert("value", frame=frame)


def blur(scene: Scene) -> None:
    scene.render.use_motion_blur = True


def ask_for_vectors(scene: Scene) -> None:
    scene.view_layers[0].use_pass_vector = True


def keep_data(scene: Scene) -> None:
    scene.render.use_persistent_data = True


def see_with_two_eyes(scene: Scene) -> None:
    scene.render.use_multiview = True


def drop_a_body(_scene: Scene) -> None:
    simulations.rigid_body()


def show_pixels(scene: Scene) -> None:
    """Shows an image of which only Blender has the pixels, and one that is a lamp's pattern."""
    image = bpy.data.images.new("Pixels", 4, 4)
    image.pixels[:4] = (1.0, 0.0, 0.0, 1.0)
    material = bpy.data.materials["White"]
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    light = bpy.data.lights.new("Light", "POINT")
    scene.collection.objects.link(bpy.data.objects.new("Light", light))


@pytest.mark.parametrize("change", [blur, ask_for_vectors, keep_data, see_with_two_eyes, drop_a_body, show_pixels])
def test_c9_nothing_but_a_change_looks_like_one(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path, change: Callable[[Scene], None]
) -> None:
    square.frame_end = 3
    animate_square(square)
    change(square)
    handle("render_pre", lambda _frame: None)
    images.use_exr(square, tmp_path / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=square.name)
    assert {line["frame"] for line in lines()} == {1, 2, 3}
    assert alone(lines()) == warnings(lines()) == []


def paint(frame: int) -> None:
    bpy.data.images["Pixels"].pixels[:4] = (0.0, 0.2 * frame, 0.0, 1.0)
    bpy.data.images["Pixels"].update()


def dim(frame: int) -> None:
    bpy.data.lights["Light"].energy = 10.0 * frame


def turn_temporal_off(frame: int) -> None:
    bpy.context.scene.gradus.use_temporal = frame < 2


@pytest.mark.parametrize("change", [paint, dim, turn_temporal_off])
def test_c9_changes_of_all_kinds_are_noticed(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path, change: Callable[[int], None]
) -> None:
    square.frame_end = 3
    show_pixels(square)
    handle("render_pre", change)
    animate(square, tmp_path)
    assert alone(lines()) == [2, 3]
    assert len(warnings(lines())) == 1


def key_switch(owner: Any, switch: str) -> None:
    """Hides what has a switch at first, in all frames but 6 and 7."""
    step(owner, switch, {1: True, 6: False, 8: True})


def add_guest(collection: bpy.types.Collection) -> bpy.types.Object:
    """Adds an object in front of the square, with a mesh, a material and an image of its own."""
    show_pixels(bpy.context.scene)
    guest = bpy.data.objects.new("Guest", recording.grid(1, 0.5, name="Guest"))
    guest.location = (1.0, 0.0, 0.1)
    guest.data.materials.append(bpy.data.materials["White"].copy())
    bpy.data.objects["Square"].data.materials[0] = bpy.data.materials["Black"]
    collection.objects.link(guest)
    return guest


def show_an_object(scene: Scene) -> None:
    key_switch(add_guest(scene.collection), "hide_render")


def show_an_instanced_collection(scene: Scene) -> None:
    collection = bpy.data.collections.new("Guests")
    add_guest(collection)
    empty = recording.add(None, "Copy")
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    key_switch(empty, "hide_render")


def show_copies(scene: Scene) -> None:
    """Shows more copies of an object on the vertices of another one, which gets more of them."""
    guest = add_guest(scene.collection)
    row = recording.add(recording.grid(1, 0.1, name="Row"), "Row", (0.5, 0.0, 0.0))
    guest.parent, row.instance_type = row, "VERTS"
    row.modifiers.new("Copies", "ARRAY")
    step(row, 'modifiers["Copies"].count', {1: 1, 6: 4})


def change_topology(scene: Scene) -> None:
    """Gives the mesh of an object more faces."""
    guest = add_guest(scene.collection)
    guest.modifiers.new("Thick", "SOLIDIFY").thickness = 0.1
    step(guest, 'modifiers["Thick"].show_render', {1: False, 6: True})


def switch_a_light_on(scene: Scene) -> None:
    add_guest(scene.collection)
    key_switch(bpy.data.objects["Light"], "hide_render")


APPEARANCES = [show_an_object, show_an_instanced_collection, show_copies, change_topology, switch_a_light_on]


def animate_passes(scene: Scene, folder: Path) -> dict[int, images.Passes]:
    """Renders the animation. Returns all passes by frame."""
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    return {
        frame: images.read(folder / f"f_{frame:04d}.exr") for frame in range(scene.frame_start, scene.frame_end + 1)
    }


@pytest.mark.parametrize("appear", APPEARANCES)
def test_c9_what_appears_ahead_of_the_frame_stays_joined_under_a_handler(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path, appear: Callable[[Scene], None]
) -> None:
    """Objects that only frames ahead show were taken for others after the frame of the handler had been exported."""
    appear(square)
    # Frames that differ in nothing are copies. Under the orthographic camera, everything stays in its pixel.
    key(bpy.data.objects["Square"], "location", {1: (0.0, 0.0, -0.1), 8: (0.0, 0.0, -0.8)})
    square.gradus.reconstruction = "REGULARIZED"  # samples one frame ahead for each frame that Blender asks for
    square.view_layers[0].gradus.use_pass_gradients = True
    without = animate_passes(square, tmp_path)
    correspondence = without[6]["Gradient T Correspondence"]
    assert (correspondence[..., 2] == 1.0).all(), "everything that frame 6 shows stays"
    handle("render_pre", lambda _frame: None)
    found = animate_passes(square, tmp_path)
    assert alone(lines()) == warnings(lines()) == []
    for frame, passes in found.items():
        assert all(np.array_equal(passes[name], without[frame][name]) for name in passes), frame


def test_c9_after_the_handler_is_removed_frames_are_sampled_ahead_again(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path
) -> None:
    square.frame_end = 4
    added = handle("render_pre", move)
    animate(square, tmp_path)
    bpy.app.handlers.render_pre.remove(added)
    animate(square, tmp_path)
    assert alone(lines()) == [2, 3, 4]
    assert [line["samples_replayed"] for line in lines()[4:]] == [2, 2, 2, 2]


def test_c9_a_handler_that_removes_itself_is_noticed(square: Scene, handle: Handle, lines: Any, tmp_path: Path) -> None:
    square.frame_end = 4

    def once(frame: int) -> None:
        if frame == 2:
            move(8)
            bpy.app.handlers.render_pre.remove(added)

    added = handle("render_pre", once)
    pictures = animate(square, tmp_path)
    assert np.allclose([shows(pictures[frame]) for frame in (1, 2, 3, 4)], [0.0, 1.0, 1.0, 1.0], atol=0.07)
    assert alone(lines()) == [2, 3, 4]


# -------------------------------------------------------------------------------- handlers of frame changes, drivers


@pytest.mark.parametrize("kind", ["frame_change_pre", "frame_change_post"])
def test_c9_frame_changes_that_depend_on_the_frame_alone_keep_temporal(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path, kind: str
) -> None:
    handle(kind, move)
    pictures = animate(square, tmp_path)
    assert np.allclose([shows(pictures[frame]) for frame in range(1, 9)], list(map(place, range(1, 9))), atol=0.07)
    assert alone(lines()) == warnings(lines()) == []
    assert all(line["samples_replayed"] == 2 for line in lines())


def test_c9_a_handler_that_counts_its_calls_is_noticed(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path
) -> None:
    square.frame_end = 4
    calls: list[int] = []
    places: dict[int, float] = {}

    def count(frame: int) -> None:
        calls.append(frame)
        bpy.data.objects["Square"].location.x = 0.01 * len(calls)

    def note(frame: int) -> None:
        places[frame] = bpy.data.objects["Square"].location.x

    handle("frame_change_pre", count)
    handle("render_post", note)
    pictures = animate(square, tmp_path)
    assert alone(lines()) == [2, 3, 4]
    assert len(warnings(lines())) == 1
    for frame in (2, 3, 4):
        assert abs(shows(pictures[frame]) - places[frame]) < 0.07, "it is where the handler has put it for the frame"


def driven_by(expression: str) -> None:
    driver = bpy.data.objects["Square"].driver_add("location", 0).driver
    driver.type, driver.expression = "SCRIPTED", expression


@pytest.mark.parametrize("expression", ["0.25 * (frame - 4)", "place_of_frame(frame)"])
def test_c9_drivers_are_evaluated_for_frames_ahead(
    square: Scene, lines: Any, exports: Exports, tmp_path: Path, expression: str
) -> None:
    bpy.app.driver_namespace["place_of_frame"] = place
    driven_by(expression)
    pictures = animate(square, tmp_path)
    assert np.allclose([shows(pictures[frame]) for frame in range(1, 9)], list(map(place, range(1, 9))), atol=0.07)
    assert exports.frames() == list(range(1, 9))
    assert all(line["samples_replayed"] == 2 for line in lines())
    del bpy.app.driver_namespace["place_of_frame"]


def test_c9_a_driver_that_reads_what_render_pre_sets(square: Scene, handle: Handle, lines: Any, tmp_path: Path) -> None:
    square.frame_end = 4
    values = {"place": place(1)}
    bpy.app.driver_namespace["place_now"] = lambda frame: values["place"] + 0.0 * frame
    driven_by("place_now(frame)")
    handle("render_pre", lambda frame: values.update(place=place(frame)))
    pictures = animate(square, tmp_path)
    assert np.allclose([shows(pictures[frame]) for frame in range(1, 5)], list(map(place, range(1, 5))), atol=0.07)
    assert alone(lines()) == [2, 3, 4]
    del bpy.app.driver_namespace["place_now"]


# -------------------------------------------------------------------------------- layers, views, stores


def test_c9_all_layers_and_views_give_up_with_one_warning(
    square: Scene, handle: Handle, lines: Any, tmp_path: Path
) -> None:
    square.frame_end = 3
    square.view_layers.new("Second")
    square.render.use_multiview = True
    handle("render_pre", move)
    images.use_exr(square, tmp_path / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=square.name)
    assert len(lines()) == 3 * 2 * 2
    assert alone(lines()) == [2] * 4 + [3] * 4
    assert len(warnings(lines())) == 1


@pytest.mark.parametrize("end", [2, 3])
def test_c9_a_store_goes_on_with_own_states(
    square: Scene, handle: Handle, lines: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, end: int
) -> None:
    """The first render ends at frame `end`, before or after the change was noticed."""

    def stop(_files: Any, _render: Any, frame: int, _size: int) -> None:
        if frame == end:
            raise Failure("the disk is gone")

    square.frame_end, square.gradus.frame_store = 5, str(tmp_path / "store")
    handle("render_pre", move)
    with monkeypatch.context() as patched:
        patched.setattr(output.FrameFiles, "before_frame", stop)
        with pytest.raises(RuntimeError, match="the disk is gone"):
            animate(square, tmp_path)
    square.render.use_overwrite = False
    pictures = animate(square, tmp_path)
    assert [line["frame"] for line in lines()] == [1, 2, 3, 4, 5]
    found = [shows(pictures[frame]) for frame in range(1, 6)]
    assert np.allclose(found, list(map(place, range(1, 6))), atol=0.07)


def test_c9_a_store_has_no_frames_of_another_state(square: Scene, handle: Handle, tmp_path: Path) -> None:
    square.frame_end, square.gradus.frame_store = 8, str(tmp_path / "store")
    handle("render_pre", lambda frame: move(max(frame, 7)))
    animate(square, tmp_path)
    folder = tmp_path / "store" / "Scene" / "ViewLayer"
    assert {path.name for path in folder.glob("*.exr")} >= {"f+0000008.exr"}
    assert not [path.name for path in folder.glob("f+0000008.*") if path.name != "f+0000008.exr"]
    assert animation.frame_store.frame_path(str(tmp_path / "store"), "Scene", "ViewLayer", "", 8).is_file()


def test_blender_has_no_handlers_of_its_own() -> None:
    assert handlers.that_may_change_frames() == []
