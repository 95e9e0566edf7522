"""The export inside a render, by an engine that exports with the depsgraph of the render and changes frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest
from support import recording

SAMPLES = Path(__file__).resolve().parents[2] / "sample_blends"


class RecordingEngine(bpy.types.RenderEngine):
    """An engine that exports the scene and delivers an empty image."""

    bl_idname = "GRADUS_TEST_EXPORT"
    bl_label = "Gradus test: export"

    def update(self, data: Any, depsgraph: Any) -> None:
        _on_update(self, depsgraph)

    def render(self, depsgraph: Any) -> None:
        result = self.begin_result(0, 0, self.resolution_x, self.resolution_y)
        self.end_result(result)


_on_update: Callable[[Any, Any], None] = lambda engine, depsgraph: None  # noqa: E731


@pytest.fixture
def exported(tmp_path: Path) -> Iterator[Callable[[], SimpleNamespace]]:
    """Returns a function that renders the current scene with the recording engine."""

    def run(exporter: Any = None, recorded: recording.Recording | None = None) -> SimpleNamespace:
        from gradus.export import Exporter

        global _on_update
        found = SimpleNamespace(recorded=recorded or recording.Recording(), report=None, error=None)
        used = exporter or Exporter(found.recorded, 1)

        def on_update(engine: Any, depsgraph: Any) -> None:
            try:
                found.report = used.sync(depsgraph, engine, cancelled=engine.test_break)
                found.frame = depsgraph.scene_eval.frame_current
            except Exception as error:
                found.error = error

        _on_update = on_update
        scene = bpy.context.scene
        scene.render.engine = RecordingEngine.bl_idname
        scene.render.use_compositing = False
        scene.render.filepath = str(tmp_path / "out")
        bpy.ops.render.render(write_still=False)
        if found.error is not None:
            raise found.error
        return found

    bpy.utils.register_class(RecordingEngine)
    yield run
    bpy.utils.unregister_class(RecordingEngine)


def _open(name: str) -> bpy.types.Scene:
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{name}.blend"))
    return bpy.context.scene


@pytest.mark.parametrize(
    "name", ["hero", "cornell", "glass_and_chrome", "many_lights", "textures_world", "compositor", "animated"]
)
def test_sample_scenes(exported: Callable[[], SimpleNamespace], name: str) -> None:
    scene = _open(name)
    found = exported()
    # The scene of the compositor asks for denoising data.
    named = ["serve the reconstruction, too"] if name == "compositor" else []
    if named and bpy.app.version >= (5, 2, 0):
        named.append("not supported are the passes Denoising Roughness, Denoising Specular Albedo")
    warnings = found.report.warnings
    assert len(warnings) == len(named) and all(part in text for part, text in zip(named, warnings, strict=True))
    assert (found.report.width, found.report.height) == (scene.render.resolution_x, scene.render.resolution_y)
    assert found.recorded.instances["count"] > 4
    assert len(found.recorded.lights) == {"cornell": 0, "textures_world": 0, "many_lights": 200}.get(name, 1)


def test_vectors_of_the_animated_scene(exported: Callable[[], SimpleNamespace]) -> None:
    """Moving, rotating and deforming objects and the camera have vectors, static walls do not.

    Afterwards the scene is at its frame again.
    """
    scene = _open("animated")
    scene.view_layers[0].use_pass_vector = True
    scene.frame_set(6)
    found = exported()
    instances = found.recorded.instances
    places = {name: index for index, name in enumerate(instances["names"])}
    step = (0.9 + 1.0) / 23
    ball = places["Ball"]
    assert np.allclose(instances["previous"][ball][3, 0] + step, instances["matrices"][ball][3, 0], atol=1e-4)
    assert np.allclose(instances["next"][ball][3, 0] - step, instances["matrices"][ball][3, 0], atol=1e-4)
    wall = places["Back"]
    assert np.array_equal(instances["previous"][wall], instances["matrices"][wall])
    assert not np.allclose(instances["previous"][places["Block"]], instances["matrices"][places["Block"]])
    assert {mesh.name: mesh.keys for mesh in found.recorded.meshes.values()}["Flag"] == 3
    assert (
        found.recorded.camera.matrix_previous[12]
        < found.recorded.camera.matrix[12]
        < found.recorded.camera.matrix_next[12]
    )
    assert found.frame == 6 and scene.frame_current == 6


def test_subframes_are_kept(exported: Callable[[], SimpleNamespace]) -> None:
    scene = _open("animated")
    scene.view_layers[0].use_pass_vector = True
    scene.frame_set(6, subframe=0.5)
    found = exported()
    ball = found.recorded.instances["names"].index("Ball")
    assert found.recorded.instances["matrices"][ball][3, 0] == pytest.approx(-1.0 + (0.9 + 1.0) / 23 * 5.5, abs=1e-4)
    assert scene.frame_subframe == pytest.approx(0.5)


def test_frames_share_static_objects(exported: Callable[..., SimpleNamespace]) -> None:
    """Each frame has a new depsgraph, but meshes and materials are set once and keep their keys."""
    from gradus.export import Exporter

    scene = _open("animated")
    recorded = recording.Recording()
    exporter = Exporter(recorded, 1)
    identities = []
    for frame in (1, 2, 3):
        scene.frame_set(frame)
        recorded.calls.clear()
        exported(exporter, recorded)
        identities.append(dict(zip(recorded.instances["names"], recorded.instances["ids"], strict=True)))
        if frame > 1:
            assert recorded.calls.count("mesh") <= 1, "only the waving flag"
            assert recorded.calls.count("material") == 0
    assert identities[0] == identities[1] == identities[2]


def test_percentage_and_border(exported: Callable[[], SimpleNamespace]) -> None:
    """The exported size is that of the full frame, even with a border."""
    scene = _open("cornell")
    scene.render.resolution_percentage = 50
    scene.render.use_border = True
    scene.render.border_max_x = 0.5
    found = exported()
    assert (found.report.width, found.report.height) == (256, 256)


def test_stereo_views_have_their_own_cameras(exported: Callable[..., SimpleNamespace]) -> None:
    """The eyes are displaced along the x axis of the camera by its interocular distance."""
    from gradus.export import Exporter

    scene = _open("cornell")
    scene.render.use_multiview = True
    scene.camera.data.stereo.interocular_distance = 0.2
    recorded = recording.Recording()
    places = {}

    class EachView(Exporter):
        def sync(self, depsgraph: Any, engine: Any, **arguments: Any) -> Any:
            for view in ("left", "right"):
                engine.active_view_set(view)
                report = super().sync(depsgraph, engine, **arguments)
                places[view] = recorded.camera.matrix[12]
            return report

    exported(EachView(recorded, 1), recorded)
    assert places["right"] - places["left"] == pytest.approx(0.2, abs=1e-4)
