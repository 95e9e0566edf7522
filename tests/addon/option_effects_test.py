"""Every option of schema/options.toml has an effect on a tiny scene.

A value other than the default changes the picture, the stats or the files, or is an error. Options of the scene are
also moved on the command line.
"""

from __future__ import annotations

import itertools
import json
import sys
import tomllib
from collections.abc import Callable
from ctypes import byref
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import compat, viewport
from gradus.export import ViewOverride
from gradus.native import Pass, Phase, Progress
from mathutils import Matrix
from support import images, nodes, recording
from support.animation import key

SCHEMA = Path(__file__).resolve().parents[2] / "schema" / "options.toml"
ROWS = tomllib.loads(SCHEMA.read_text(encoding="utf-8"))["option"]
OPTIONS = [row for row in ROWS if row["type"] != "plain"]
WIDTH, HEIGHT, FRAMES = 24, 16, 12  # more than a window has

# Stats that differ from run to run.
TIMES = frozenset(("seconds", "cpu_seconds", "process_cpu", "peak_memory_bytes"))


def material(name: str, shader: str, **inputs: Any) -> bpy.types.Material:
    made = nodes.new_material(name)
    node = made.node_tree.nodes.new(shader)
    for socket, value in inputs.items():
        node.inputs[socket].default_value = value
    nodes.show(made, node.outputs[0])
    return made


def see_through() -> bpy.types.Material:
    """Returns a material that is transparent by seven tenths."""
    made = nodes.new_material("Gauze")
    tree = made.node_tree
    mix = tree.nodes.new("ShaderNodeMixShader")
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    cloth = tree.nodes.new("ShaderNodeBsdfDiffuse")
    mix.inputs[0].default_value = 0.3
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(cloth.outputs[0], mix.inputs[2])
    nodes.show(made, mix.outputs[0])
    return made


def add(mesh: bpy.types.Mesh, shown: bpy.types.Material, location: tuple[float, float, float]) -> bpy.types.Object:
    mesh.materials.append(shown)
    return recording.add(mesh, shown.name, location)


def ball(radius: float) -> bpy.types.Mesh:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, radius=radius)
    made = bpy.context.object
    mesh = made.data
    bpy.data.objects.remove(made)
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    return mesh


@pytest.fixture
def room(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene: floor, wall, polished ball, two panes of glass, gauze, a point light and a grey world."""
    recording.add_camera(type="ORTHO", ortho_scale=5.0)
    add(recording.grid(1, 4.0), material("Floor", "ShaderNodeBsdfDiffuse"), (0.0, 0.0, 0.0))
    red = material("Wall", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.2, 0.1, 1.0))
    wall = add(recording.grid(1, 2.0), red, (-1.9, 0.0, 1.0))
    wall.rotation_euler = (0.0, 1.2, 0.0)
    add(ball(0.6), material("Polish", "ShaderNodeBsdfGlossy", Roughness=0.2), (-0.6, 0.6, 0.6))
    pane = material("Pane", "ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.5)
    for height in (0.8, 1.2):
        add(recording.grid(1, 0.9), pane, (0.7, 0.6, height))
    add(recording.grid(1, 0.9), see_through(), (0.7, -0.6, 1.0))
    light = bpy.data.lights.new("Light", "POINT")
    light.energy, light.shadow_soft_size = 200.0, 0.3
    recording.add(light, "Light", (1.0, -1.0, 3.0))
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.view_layers[0].use_pass_z = True
    return scene


def add_missing_image() -> None:
    shown = nodes.new_material("Missing")
    texture = shown.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("Missing", 1, 1)
    texture.image.source, texture.image.filepath = "FILE", "/nonexistent/picture.png"
    nodes.show(shown, texture.outputs[0])
    add(recording.grid(1, 0.5), shown, (-0.8, -0.8, 0.2))


def let_move(scene: bpy.types.Scene) -> None:
    """Animates the scene: the ball passes over the floor, and the wall that it reflects rotates."""
    key(bpy.data.objects["Polish"], "location", {1: (-0.6, 0.6, 0.6), FRAMES: (0.2, 0.2, 0.6)})
    scene.frame_start, scene.frame_end = 1, FRAMES


# ------------------------------------------------------------------------------------------------ moving an option


def stored(option: dict[str, Any], value: Any, folder: Path) -> Any:
    return str(folder / value) if option["type"] == "folder" and value else value


def set_option(scene: bpy.types.Scene, option: dict[str, Any], value: Any, source: str, arguments: list[str]) -> None:
    """Sets an option as an artist does: in the engine's settings, in Blender's own, or on the command line."""
    if source in ("scene", "panel"):
        setattr(scene.gradus, option["name"], value)
    elif source == "command":
        text = str(int(value)) if isinstance(value, bool) else str(value)
        arguments += [f"--gradus-{option['name'].replace('_', '-')}", text]
    elif option["name"] == "frame":
        scene.frame_set(value)
    else:
        owner, _, name = option["blender"].rpartition(".")
        setattr({"render": scene.render, "view_layer": scene.view_layers[0]}[owner], name, value)
        if name == "threads":
            scene.render.threads_mode = "FIXED"


Outcome = dict[str, Any]


def render_still(scene: bpy.types.Scene, folder: Path) -> Outcome:
    return dict(images.render(scene, folder))


def render_animation(scene: bpy.types.Scene, folder: Path) -> Outcome:
    images.use_exr(scene, folder / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    paths = sorted(folder.glob("f_*.exr"))
    assert len(paths) == FRAMES
    return {f"{path.stem} {name}": image for path in paths for name, image in images.read(path).items()}


class Engine:
    """The parts of a render engine that the export of a viewport uses."""

    resolution_x = resolution_y = 0


def render_viewport(scene: bpy.types.Scene, _folder: Path) -> Outcome:
    scene.update_tag()  # as the interface does
    engine, depsgraph = Engine(), bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    view = viewport.View(engine, depsgraph)
    window = Matrix.Translation((0.0, 0.0, -5.0))
    view.synchronize(depsgraph, ViewOverride.from_view(window, Matrix(), (0.1, 100.0), WIDTH, HEIGHT))
    view.start(depsgraph.scene_eval, depsgraph.view_layer_eval, (0, 0, WIDTH, HEIGHT))
    view.worker.join()
    library = view.session.library
    library.render_wait(view.render, 60.0)
    library.render_poll(view.render, byref(progress := Progress()))
    assert (view.error, progress.phase) == (None, Phase.DONE)
    pixels = np.zeros(WIDTH * HEIGHT * 4, np.float32)
    library.render_read_pass(view.render, Pass.NOISY_IMAGE, np.ctypeslib.as_ctypes(pixels), pixels.size)
    view.free()
    return {"viewport": pixels}


RENDERS = {
    "still": render_still,
    "animation": render_animation,
    "motion blur": render_still,
    "viewport": render_viewport,
}


def is_same(one: Outcome, other: Outcome) -> bool:
    if one.keys() != other.keys():
        return False
    return all(one[name].shape == other[name].shape and np.array_equal(one[name], other[name], True) for name in one)


def differences(one: Outcome, other: Outcome) -> list[str]:
    """Returns the names of the stats that differ, without times."""
    return [name for name in one if name not in TIMES and one[name] != other.get(name)]


@pytest.fixture
def outcome(room: bpy.types.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, Any]]:
    """Returns a function outcome(option, source) that renders with an option at its default or, set in `source`, moved.

    It returns the picture, the stats, the files and the error.
    """
    runs = itertools.count()
    # Options whose default is that of the Blender may then be moved.
    monkeypatch.setattr(compat, "has_one_more_transparent", lambda: False)
    monkeypatch.setattr(compat, "has_background_motion", lambda: True)

    def make(option: dict[str, Any], source: str = "") -> dict[str, Any]:
        folder = tmp_path / f"run{next(runs)}"
        folder.mkdir()
        arguments = ["blender", "--", "--gradus-stats", str(folder / "stats.jsonl")]
        for name, value in option.get("given", {}).items():
            setattr(room.gradus, name, value)
        if source:
            set_option(room, option, stored(option, option["moved"], folder), source, arguments)
        monkeypatch.setattr(sys, "argv", arguments)
        shown = option.get("shown", "still")
        result: dict[str, Any] = {"picture": {}, "error": ""}
        try:
            result["picture"] = RENDERS[shown](room, folder)
        except RuntimeError as error:
            result["error"] = str(error)
        stats = folder / "stats.jsonl"
        result["stats"] = json.loads(stats.read_text(encoding="utf-8").splitlines()[-1]) if stats.exists() else {}
        result["files"] = sorted(str(path.relative_to(folder)) for path in folder.glob("*/**/*.exr"))
        return result

    return make


def has_effect(kind: str, before: dict[str, Any], after: dict[str, Any]) -> bool:
    if kind == "picture":
        return not after["error"] and not is_same(before["picture"], after["picture"])
    if kind == "stats":
        return not after["error"] and differences(before["stats"], after["stats"]) != []
    return before[kind] != after[kind]


def prepare(scene: bpy.types.Scene, option: dict[str, Any]) -> None:
    if option["name"].startswith("film_transparent_"):  # glass in front of the world
        scene.render.film_transparent = True
        bpy.data.objects["Floor"].hide_render = True
        bpy.data.materials["Pane"].node_tree.nodes["Glass BSDF"].inputs["Roughness"].default_value = 0.05
    if option["name"] == "background_motion":  # the outline of the floor before the world
        bpy.data.objects["Floor"].scale = (0.3, 0.3, 0.3)
        key(bpy.data.objects["Floor"], "location", {0: (-0.2, 0.0, 0.0), 2: (0.2, 0.0, 0.0)})
        scene.view_layers[0].use_pass_vector = True
        scene.frame_set(1)
    if option["name"] == "strict":
        add_missing_image()
    if option.get("shown") in ("animation", "motion blur"):
        let_move(scene)
    if option["name"] == "component_replays":  # a pane of glass passes over what is seen through it
        key(bpy.data.objects["Pane"], "location", {1: (-1.5, 0.6, 0.8), FRAMES: (1.5, 0.6, 0.8)})
    if option.get("shown") == "motion blur":
        scene.render.use_motion_blur = True
        scene.view_layers[0].use_pass_vector = True
        scene.frame_set(2)


Run = Callable[..., dict[str, Any]]


@pytest.mark.parametrize("option", OPTIONS, ids=lambda option: option["name"])
def test_every_option_has_an_effect(room: bpy.types.Scene, outcome: Run, option: dict[str, Any]) -> None:
    prepare(room, option)
    before = outcome(option)
    assert not before["error"]
    kinds = option.get("effect", "picture").split(" or ")
    sources = ("command", "scene") if option["from"] == "scene" else (option["from"],)
    for source in sources:  # the command line first, since it leaves the scene as it is
        after = outcome(option, source)
        changed = [kind for kind in kinds if has_effect(kind, before, after)]
        assert changed, f"{option['moved']} in {source} changes no {' and no '.join(kinds)}"


def test_a_picture_and_its_stats_do_not_differ_by_themselves(outcome: Run) -> None:
    """Two equal renders have equal results. Otherwise any option would seem to have an effect."""
    still = {"name": "none", "moved": None}
    first, second = outcome(still), outcome(still)
    assert is_same(first["picture"], second["picture"])
    assert differences(first["stats"], second["stats"]) == []
    assert first["files"] == second["files"] == []
