"""Changes that restart the Rendered viewport. Drawing is tested in a window by robustness/window_test.py."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from ctypes import byref
from typing import Any

import bpy
import pytest
from gradus import viewport
from gradus.export import ViewOverride
from gradus.native import Phase, Progress
from mathutils import Matrix
from support import compositing, recording

WIDTH, HEIGHT = 32, 18


def signature() -> object:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    return viewport._signature(depsgraph)


def no_sky(layer: bpy.types.ViewLayer) -> None:
    layer.use_sky = False


def no_surfaces(layer: bpy.types.ViewLayer) -> None:
    layer.use_solid = False


def clay(layer: bpy.types.ViewLayer) -> None:
    layer.material_override = bpy.data.materials.new("Clay")


class Engine:
    """Stands in for an engine in an export of a view."""

    resolution_x = resolution_y = 0


@pytest.fixture
def view(scene: bpy.types.Scene) -> Iterator[viewport.View]:
    """A viewport with an exported empty scene."""
    engine, depsgraph = Engine(), bpy.context.evaluated_depsgraph_get()
    made = viewport.View(engine, depsgraph)
    made.synchronize(depsgraph, ViewOverride.from_view(Matrix(), Matrix(), (0.1, 100.0), WIDTH, HEIGHT))
    yield made
    made.free()


@pytest.mark.parametrize("text", ["A=ED(", "A=EDL;B=ED.*L", "A=" + "E" * 600])
def test_a_malformed_set_of_components_does_not_stop_the_viewport(
    scene: bpy.types.Scene, view: viewport.View, text: str
) -> None:
    """Regression: the viewport refused malformed sets, although it has no components."""
    scene.gradus.use_decomposition, scene.gradus.components, scene.gradus.preview_samples = True, text, 1
    depsgraph = bpy.context.evaluated_depsgraph_get()
    view.start(depsgraph.scene_eval, depsgraph.view_layer_eval, (0, 0, WIDTH, HEIGHT))
    view.worker.join()
    view.session.library.render_wait(view.render, 60.0)
    view.session.library.render_poll(view.render, byref(progress := Progress()))
    assert (view.error, progress.phase, progress.samples_done) == (None, Phase.DONE, 1)
    assert view.settings.use_decomposition == 0


def test_components_are_edited_without_a_new_picture(scene: bpy.types.Scene) -> None:
    """Regression: each change of the set restarted the viewport, which has no components."""
    before = signature()
    settings = scene.gradus
    settings.use_decomposition, settings.components, settings.component_replays = True, "A=EDL", False
    scene.update_tag()  # as the interface does
    assert signature() == before
    settings.roughness_threshold = 0.2
    scene.update_tag()
    assert signature() != before


def has_edits(change: Callable[[], None]) -> bool:
    """Returns whether the update after a change is of more than the scene."""
    found: list[bool] = []

    def look(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        found.append(viewport._has_edits(depsgraph))

    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.append(look)
    change()
    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.remove(look)
    assert found
    return any(found)


def test_an_update_of_the_compositor_is_not_an_edit(scene: bpy.types.Scene) -> None:
    """Before Blender 5.0, the compositor is tagged along with the scene.

    Regression: every change of a setting restarted the viewport.
    """
    compositing.new_tree(scene)
    obj = recording.add(recording.grid(1))
    assert not has_edits(lambda: setattr(scene.gradus, "components", "A=EDL"))
    assert has_edits(lambda: setattr(obj, "location", (1.0, 0.0, 0.0)))


@pytest.mark.parametrize("change", [no_sky, no_surfaces, clay], ids=lambda change: change.__name__)
def test_a_changed_view_layer_starts_the_picture_again(
    scene: bpy.types.Scene, change: Callable[[bpy.types.ViewLayer], None]
) -> None:
    """Blender tags only the scene for these changes, as it does for selections."""
    obj = recording.add(recording.grid(1))
    before = signature()
    obj.select_set(True)
    assert signature() == before
    change(scene.view_layers[0])
    assert signature() != before


class Shown:
    """A view layer with two visible objects and a hidden one, an instanced collection and a collection of its own."""

    def __init__(self, scene: bpy.types.Scene) -> None:
        self.scene, self.layer = scene, scene.view_layers[0]
        self.seen, self.hidden, self.other = (recording.add(recording.grid(1)) for _ in range(3))
        self.hidden.hide_set(True)
        self.other.modifiers.new("Cut", "BOOLEAN").object = self.seen  # keeps a hidden object in the dependency graph
        self.source = bpy.data.objects.new("Source", recording.grid(1))
        instanced = bpy.data.collections.new("Instanced")
        instanced.objects.link(self.source)
        empty = bpy.data.objects.new("Instancer", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", instanced
        scene.collection.objects.link(empty)
        self.collection = bpy.data.collections.new("Props")
        scene.collection.children.link(self.collection)
        self.collection.objects.link(bpy.data.objects.new("Prop", recording.grid(1)))

    @property
    def layer_collection(self) -> bpy.types.LayerCollection:
        return self.layer.layer_collection.children["Props"]


def swap(shown: Shown) -> None:
    shown.seen.hide_set(True)
    shown.hidden.hide_set(False)


def replace(shown: Shown) -> None:
    bpy.data.objects.remove(shown.other)
    recording.add(recording.grid(1))


CHANGES: dict[str, Callable[[Shown], Any]] = {
    "hide": lambda shown: shown.other.hide_set(True),
    "hide what another object needs": lambda shown: shown.seen.hide_set(True),
    "unhide": lambda shown: shown.hidden.hide_set(False),
    "swap": swap,
    "hide for all view layers": lambda shown: setattr(shown.seen, "hide_viewport", True),
    "hide in an instanced collection": lambda shown: setattr(shown.source, "hide_viewport", True),
    "exclude": lambda shown: setattr(shown.layer_collection, "exclude", True),
    "hide a collection": lambda shown: setattr(shown.collection, "hide_viewport", True),
    "holdout": lambda shown: setattr(shown.layer_collection, "holdout", True),
    "indirect only": lambda shown: setattr(shown.layer_collection, "indirect_only", True),
    "remove": lambda shown: bpy.data.objects.remove(shown.other),
    "replace": replace,
    "move": lambda shown: setattr(shown.seen, "location", (1.0, 0.0, 0.0)),
    "edit an instance": lambda shown: setattr(shown.source, "location", (1.0, 0.0, 0.0)),
    "world": lambda shown: setattr(shown.scene, "world", bpy.data.worlds.new("Other")),
}


@pytest.mark.parametrize("name", list(CHANGES))
def test_no_change_is_missed(scene: bpy.types.Scene, name: str) -> None:
    shown = Shown(scene)
    before = signature()
    shown.other.select_set(True)
    assert signature() == before
    assert has_edits(lambda: CHANGES[name](shown)) or signature() != before


def test_another_frame_starts_the_picture_again(scene: bpy.types.Scene) -> None:
    before = signature()
    scene.frame_set(5)
    assert signature() != before


def calls_of(action: Callable[[], object]) -> int:
    """Counts the calls of Python and C functions that an action makes."""
    count = 0

    def note(_frame: object, event: str, _argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        action()
    finally:
        sys.setprofile(None)
    return count


def test_an_update_does_not_visit_the_instances(scene: bpy.types.Scene) -> None:
    """Regression: each selection took a second in a scene of a million instances."""
    mesh = recording.grid(1)
    counts = []
    for total in (2, 500):
        while len(scene.objects) < total:
            recording.add(mesh)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        depsgraph.update()
        counts.append(
            calls_of(lambda depsgraph=depsgraph: (viewport._signature(depsgraph), viewport._has_edits(depsgraph)))
        )
    assert counts[0] == counts[1]
