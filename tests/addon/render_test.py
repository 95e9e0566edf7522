"""Renders in Blender: sizes, borders, view layers, views, passes, animations and errors."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import native, progress
from support import images

Render = Callable[..., images.Passes]


@pytest.fixture
def cube(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene with a cube, a sun, a grey world and a camera: 40x24 pixels, plain paths."""
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0.6, 0.3, 0.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (4.0, -4.0, 3.0), (1.1, 0.0, 0.785)
    for item in (sun, camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    scene.render.resolution_x, scene.render.resolution_y = 40, 24
    scene.gradus.integrator, scene.gradus.samples = "PATH", 2
    return scene


@pytest.fixture
def arguments(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., None]]:
    """Returns a function that sets the command line that the add-on reads: arguments("--gradus-x", "1")."""
    yield lambda *given: monkeypatch.setattr(sys, "argv", ["blender", "--", *map(str, given)])


def test_picture_is_there(cube: bpy.types.Scene, render: Render) -> None:
    image = render(cube)["Combined"]
    assert image.shape == (24, 40, 4)
    assert np.isfinite(image).all()
    assert image[12, 20, :3].max() > 0.0
    assert np.ptp(image[:, :, 0]) > 0.0


@pytest.mark.parametrize(("percentage", "size"), [(1, (1, 1)), (50, (12, 20)), (400, (96, 160))])
def test_e8_percentage(cube: bpy.types.Scene, render: Render, percentage: int, size: tuple[int, int]) -> None:
    cube.render.resolution_percentage = percentage
    if percentage == 1:
        cube.render.resolution_x = cube.render.resolution_y = 100
    assert render(cube, samples=1)["Combined"].shape[:2] == size


@pytest.mark.parametrize("size", [(4, 4), (4, 1024), (2048, 16)])
def test_e8_odd_sizes(cube: bpy.types.Scene, render: Render, size: tuple[int, int]) -> None:
    cube.render.resolution_x, cube.render.resolution_y = size
    assert render(cube, samples=1)["Combined"].shape[:2] == size[::-1]


@pytest.mark.parametrize(
    "border", [(0.1, 0.5, 0.2, 0.7), (0.0, 0.033, 0.9, 1.0), (0.55, 1.0, 0.0, 0.31), (0.3, 0.7, 0.5, 0.55)]
)
def test_e8_a_cropped_border_is_the_crop_of_the_whole(
    cube: bpy.types.Scene, render: Render, border: tuple[float, ...]
) -> None:
    whole = render(cube)["Combined"]
    cube.render.use_border = cube.render.use_crop_to_border = True
    cube.render.border_min_x, cube.render.border_max_x, cube.render.border_min_y, cube.render.border_max_y = border
    part = render(cube)["Combined"]
    x0, y0 = (int(np.float32(value) * np.float32(size)) for value, size in ((border[0], 40), (border[2], 24)))
    assert np.array_equal(part, whole[y0 : y0 + part.shape[0], x0 : x0 + part.shape[1]])


def test_e8_pixels_outside_a_border_are_black(cube: bpy.types.Scene, render: Render) -> None:
    whole = render(cube)["Combined"]
    cube.render.use_border = True
    cube.render.border_min_x, cube.render.border_max_x, cube.render.border_min_y, cube.render.border_max_y = (
        0.25,
        0.75,
        0.25,
        0.75,
    )
    part = render(cube)["Combined"]
    assert part.shape == whole.shape
    assert np.array_equal(part[6:18, 10:30], whole[6:18, 10:30])
    assert not part[:6].any()


def test_e8_view_layers(cube: bpy.types.Scene, render: Render) -> None:
    first = cube.view_layers[0]
    second = cube.view_layers.new("Second/Ä")
    off = cube.view_layers.new("Off")
    off.use, second.use_pass_z, second.samples = False, True, 1
    passes = render(cube)
    assert f"{first.name}.Depth" not in passes
    assert "Second/Ä.Depth" in passes
    assert not any(name.startswith("Off.") for name in passes)
    assert passes[f"{first.name}.Combined"].any()
    assert not np.array_equal(passes[f"{first.name}.Combined"], passes["Second/Ä.Combined"])


def test_film_transparent(cube: bpy.types.Scene, render: Render) -> None:
    opaque = render(cube)["Combined"][:, :, 3]
    assert (opaque == 1.0).all()
    cube.render.film_transparent = True
    alpha = render(cube)["Combined"][:, :, 3]
    assert alpha[0, 0] == 0.0
    assert alpha[12, 20] == 1.0


def test_both_views_are_rendered(cube: bpy.types.Scene, tmp_path: Path) -> None:
    cube.render.use_multiview = True
    cube.view_layers[0].use_pass_z = True
    images.use_exr(cube, tmp_path / "v")
    cube.render.use_file_extension = True
    bpy.ops.render.render(write_still=True)
    left, right = (images.read(next(tmp_path.glob(f"v*{side}.exr"))) for side in "LR")
    assert left["Combined"].any()
    assert right["Combined"].any()
    assert not np.array_equal(left["Combined"], right["Combined"])
    assert 1.0 < right["Depth"][12, 20, 0] < 10.0


def test_passes_are_in_the_file_under_this_version_s_names(cube: bpy.types.Scene, render: Render) -> None:
    layer = cube.view_layers[0]
    layer.use_pass_object_index = layer.use_pass_diffuse_color = layer.use_pass_vector = True
    layer.gradus.use_pass_sample_count = True
    passes = render(cube, samples=3)
    long_names = bpy.app.version >= (5, 0, 0)
    for name in ("Object Index", "Diffuse Color") if long_names else ("IndexOB", "DiffCol"):
        assert name in passes
    assert (passes["Debug Sample Count"] == 1.0).all()
    assert passes["Vector"].shape[2] == 4
    assert not passes["Vector"].any()  # static, and not Blender's 10000


def test_noisy_image_beside_a_reconstruction(cube: bpy.types.Scene, render: Render) -> None:
    assert "Noisy Image" not in render(cube)
    passes = render(cube, integrator="AUTO")
    assert passes["Noisy Image"].shape[2] == 4
    assert passes["Noisy Image"].any()


def test_error_is_the_squared_difference_of_the_halves(
    cube: bpy.types.Scene, render: Render, arguments: Callable[..., None]
) -> None:
    """Renders a cube by path tracing in a grey world, which has no noise."""
    cube.view_layers[0].gradus.use_pass_error = True
    passes = render(cube, samples=16, reconstruction="NONE")
    error, image = passes["Error"][..., 0], passes["Combined"][..., :3]
    assert error.shape == (24, 40)
    assert np.isfinite(error).all()
    assert (error[:, 0] == 0.0).all()  # the world has no noise
    converged = render(cube, samples=1024, reconstruction="NONE")["Combined"][..., :3]
    actual = ((image - converged) ** 2).mean()
    assert 0.5 < error.mean() / actual < 2.0
    cube.view_layers[0].gradus.use_pass_error = False
    assert "Error" not in render(cube)
    arguments("--gradus-passes", "error")
    assert "Error" in render(cube)


def test_files_have_the_letters_of_the_table(
    cube: bpy.types.Scene, arguments: Callable[..., None], tmp_path: Path
) -> None:
    """Images of the command-line tool have them, too: compositors address channels by their letters."""
    import OpenImageIO as oiio
    from gradus import compat, passes

    arguments("--gradus-passes", "all,components", "--gradus-use-decomposition", 1)
    path = tmp_path / "all.exr"
    images.use_exr(cube, path)
    bpy.ops.render.render(write_still=True)
    file, names, part = oiio.ImageInput.open(str(path)), set(), 0
    while file.seek_subimage(part, 0):
        names |= set(file.spec().channelnames)
        part += 1
    file.close()
    layer = cube.view_layers[0].name
    of_component = [info.of("Diffuse") for info in passes.COMPONENT_TABLE]
    for info in (*passes.TABLE, *of_component):
        prefix = f"{layer}.{info.blender_name(compat.VERSION)}."
        found = {name.removeprefix(prefix) for name in names if name.startswith(prefix)}
        assert found == set(info.ids) or (not found and info.switch == "reconstructed"), prefix


def frames_of(cube: bpy.types.Scene, folder: Path) -> list[np.ndarray]:
    images.use_exr(cube, folder / "f")
    cube.render.use_file_extension = True
    bpy.ops.render.render(animation=True)
    return [images.read(path)["Combined"] for path in sorted(folder.glob("f*.exr"))]


def test_i4_frames_alone_and_in_a_row_are_equal(cube: bpy.types.Scene, render: Render, tmp_path: Path) -> None:
    cube.frame_end = 3
    cube.objects[0].keyframe_insert("location", frame=1)
    cube.objects[0].location.x = 1.0
    cube.objects[0].keyframe_insert("location", frame=3)
    alone = [render(cube, frame=frame)["Combined"] for frame in (1, 2, 3)]
    for persistent in (False, True):
        cube.render.use_persistent_data = persistent
        folder = tmp_path / str(persistent)
        folder.mkdir()
        together = frames_of(cube, folder)
        assert len(together) == 3
        for one, other in zip(alone, together, strict=True):
            assert np.array_equal(one, other)
    assert not np.array_equal(alone[0], alone[1])


def test_stats_line(cube: bpy.types.Scene, render: Render, tmp_path: Path, arguments: Callable[..., None]) -> None:
    path = tmp_path / "stats.jsonl"
    arguments("--gradus-stats", path, "--gradus-samples", 3)
    cube.view_layers.new("Second")
    render(cube, frame=7)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert [(line["frame"], line["layer"]) for line in lines] == [(7, cube.view_layers[0].name), (7, "Second")]
    keys = (
        "schema version scene view seed integrator reconstruction samples samples_fresh samples_replayed unbiased "
        "resolution plan seconds cpu_seconds"
    )
    keys += " denoiser rays shifts nonfinite_dropped peak_memory_bytes process_cpu warnings"
    assert set(keys.split()) <= lines[0].keys()
    assert {"export", "build", "sample", "reconstruct", "denoise", "upload", "total"} <= lines[0]["seconds"].keys()
    assert lines[0]["seconds"]["preview"] == lines[0]["cpu_seconds"]["preview"] == 0.0  # there is no window
    assert lines[0]["samples"] == 3
    assert lines[0]["resolution"] == [40, 24]


def test_i7_an_unknown_option_is_an_error(
    cube: bpy.types.Scene, render: Render, arguments: Callable[..., None]
) -> None:
    arguments("--gradus-sampels", 3)
    with pytest.raises(RuntimeError, match="--gradus-sampels"):
        render(cube)


@pytest.mark.parametrize(
    ("name", "value"), [("samples", "many"), ("samples", "0"), ("integrator", "best"), ("noise-threshold", "-1")]
)
def test_i7_a_wrong_value_is_an_error(
    cube: Any, render: Render, arguments: Callable[..., None], name: str, value: str
) -> None:
    arguments(f"--gradus-{name}={value}")
    with pytest.raises(RuntimeError, match=name.replace("-", "_")):
        render(cube)


def test_options_do_not_change_the_scene(cube: bpy.types.Scene, render: Render, arguments: Callable[..., None]) -> None:
    arguments("--gradus-samples", 1, "--gradus-passes", "depth,noisy-image")
    passes = render(cube)
    assert {"Depth", "Noisy Image"} <= passes.keys()
    assert cube.gradus.samples == 2
    assert not cube.view_layers[0].use_pass_z


def test_what_cannot_be_obeyed_is_refused(cube: bpy.types.Scene, render: Render) -> None:
    with pytest.raises(RuntimeError, match="(?i)gradient"):
        render(cube, integrator="PATH", reconstruction="L2")


def use_lost_image(scene: bpy.types.Scene) -> bpy.types.Image:
    """Gives the cube a texture from a file that does not exist."""
    material = bpy.data.materials.new("Lost")
    material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("Lost", 1, 1)
    texture.image.source, texture.image.filepath = "FILE", "/nonexistent/lost.png"
    surface = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    scene.objects["Cube"].data.materials.append(material)
    return texture.image


def test_a_strict_render_fails_for_a_missing_image(cube: bpy.types.Scene, render: Render) -> None:
    use_lost_image(cube)
    render(cube)
    with pytest.raises(RuntimeError, match="strict: .*/nonexistent/lost.png"):
        render(cube, strict=True)
    with pytest.raises(RuntimeError, match="strict: "):  # also when the warning is no longer new
        render(cube, strict=True)


def test_strict_holds_with_persistent_data(cube: bpy.types.Scene, render: Render) -> None:
    """Warnings are reported once per session, which persistent data keeps: strict renders must fail all the same."""
    from gradus import store

    cube.render.use_persistent_data = True
    image = use_lost_image(cube)
    layer = cube.view_layers[0]
    fog = bpy.data.objects.new("Fog", bpy.data.volumes.new("Fog"))
    cube.collection.objects.link(fog)
    try:
        render(cube)
        with pytest.raises(RuntimeError, match="strict: Object 'Fog' is left out"):
            render(cube, strict=True)
        bpy.data.objects.remove(fog)
        with pytest.raises(RuntimeError, match="strict: .*/nonexistent/lost.png"):
            render(cube, strict=True)
        cube.objects["Cube"].data.materials.clear()
        bpy.data.images.remove(image)
        render(cube, strict=True)
        assert store.summaries[(cube.name, layer.name)]["warnings"] == []
    finally:
        cube.render.use_persistent_data = False
        store.release_kind(store.FINAL)


def test_strict_covers_warnings_about_colours(
    cube: bpy.types.Scene, render: Render, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Warnings about colours belong to the device, which several scenes share."""
    from gradus import store

    monkeypatch.setattr(store.Session, "device_warnings", lambda _session: ["colour: the space X is not known"])
    render(cube)
    with pytest.raises(RuntimeError, match="strict: colour: the space X is not known"):
        render(cube, strict=True)


def test_strict_accepts_warnings_that_change_no_picture(cube: bpy.types.Scene, render: Render) -> None:
    """Limits that differ from those of Cycles are reported, but they are the settings of the scene for Gradus."""
    cube.cycles.max_bounces = 3
    render(cube, strict=True)


def test_no_camera(cube: bpy.types.Scene, render: Render) -> None:
    cube.camera = None
    with pytest.raises(RuntimeError, match="camera"):
        render(cube)


def test_k5_a_cancelled_render_keeps_its_image(cube: Any, render: Render, monkeypatch: pytest.MonkeyPatch) -> None:
    from gradus import renderer

    calls = []
    monkeypatch.setattr(renderer, "stop_requested", lambda engine: calls.append(1) or len(calls) > 4)
    image = render(cube, samples=100000)["Combined"]
    assert len(calls) > 4
    assert np.isfinite(image).all()


def test_k2_test_break_is_polled_often(cube: Any, render: Render, monkeypatch: pytest.MonkeyPatch) -> None:
    import time

    from gradus import renderer

    moments = []
    monkeypatch.setattr(renderer, "stop_requested", lambda engine: moments.append(time.monotonic()))
    cube.gradus.time_limit = 1.0
    render(cube, samples=1000000)
    gaps = np.diff(moments)
    assert len(gaps) >= 8
    assert gaps.max() <= 0.25


def test_warnings_are_reported_once(cube: bpy.types.Scene, render: Render) -> None:
    from gradus import store

    cube.frame_end = 2
    summary = store.summaries
    render(cube, frame=1)
    assert summary[(cube.name, cube.view_layers[0].name)]["frame"] == 1
    render(cube, frame=2)
    assert summary[(cube.name, cube.view_layers[0].name)]["frame"] == 2


def test_scene_file_and_frame_store(
    cube: bpy.types.Scene, render: Render, tmp_path: Path, arguments: Callable[..., None]
) -> None:
    arguments("--gradus-save-scene", tmp_path / "s_%f.gradus", "--gradus-frame-store", tmp_path / "store")
    render(cube, frame=4)
    assert (tmp_path / "s_4.gradus").stat().st_size > 100
    stored = list((tmp_path / "store").rglob("*.exr"))
    assert [path.name for path in stored] == ["f+0000004.exr"]
    assert stored[0].parent.parent.name == frame_store_name(cube.name)


def test_stored_frames_open_in_other_programs(
    cube: Any, render: Render, tmp_path: Path, arguments: Callable[..., None]
) -> None:
    import OpenImageIO as oiio

    arguments("--gradus-frame-store", tmp_path, "--gradus-integrator", "gradient", "--gradus-passes", "denoising,depth")
    render(cube)
    path = str(next(tmp_path.rglob("*.exr")))
    image = bpy.data.images.load(path)
    image.size[:]  # reads the file
    assert image.type == "MULTILAYER"
    file, parts = oiio.ImageInput.open(path), {}
    while file.seek_subimage(len(parts), 0):
        parts[file.spec().getattribute("oiio:subimagename")] = file.spec().channelnames
    features = [f"Denoising_{name}" for name in ("Normal", "Albedo", "Depth")]
    assert list(parts) == ["samples", "counts", "gradients", "pairs", *features, "passes"]
    assert parts["samples"] == tuple(f"{half}.{channel}" for half in "AB" for channel in "RGB")
    assert not any(np.isnan(file.read_image(part, 0, 0, -1, oiio.FLOAT)).any() for part in range(len(parts)))


def frame_store_name(name: str) -> str:
    from gradus import frame_store

    return frame_store.escape(name)


def test_a_saved_scene_renders_to_the_same_picture(
    cube: Any, render: Render, tmp_path: Path, arguments: Callable[..., None]
) -> None:
    """The saved scene renders to the image that Blender showed."""
    import ctypes
    from ctypes import byref

    from gradus import native, store

    path = tmp_path / "s.gradus"
    arguments("--gradus-save-scene", path)
    expected = render(cube)["Combined"]
    library = native.load()
    scene, handle, settings = ctypes.c_uint64(), ctypes.c_uint64(), native.Settings()
    library.scene_load(store.device(library), native.text(str(path)), byref(scene), byref(settings))
    library.render_start(scene.value, byref(settings), byref(handle))
    library.render_wait(handle.value, -1.0)
    pixels = (ctypes.c_float * expected.size)()
    library.render_read_pass(handle.value, native.Pass.COMBINED, pixels, expected.size)
    library.render_release(handle.value)
    library.scene_release(scene.value)
    assert np.array_equal(np.frombuffer(pixels, np.float32).reshape(expected.shape), expected)


def test_i9_the_file_says_how_it_was_made(cube: bpy.types.Scene, tmp_path: Path) -> None:
    import OpenImageIO as oiio

    path = tmp_path / "meta.exr"
    images.use_exr(cube, path)
    bpy.ops.render.render(write_still=True)
    spec = oiio.ImageInput.open(str(path)).spec()
    assert spec.getattribute("gradus.integrator") == "path"
    assert spec.getattribute("gradus.samples") == "2.0"
    assert str(spec.getattribute("gradus.version")).startswith("0.1.0")


def test_the_progress_of_a_frame_that_was_sampled_ahead_names_no_samples() -> None:
    """Regression: the text of a frame of an animation ended with "sample 0/4"."""
    job: Any = SimpleNamespace(current=SimpleNamespace(settings=SimpleNamespace(samples=4)))
    display = progress.Display(job)
    texts = {phase: display._text(native.Progress(phase=phase)) for phase in native.Phase}
    assert texts[native.Phase.DONE] == "reconstructed"
    assert texts[native.Phase.RECONSTRUCTING] == "reconstructing"
    assert texts[native.Phase.SAMPLING] == "sample 0/4, 0 %"
