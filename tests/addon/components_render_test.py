"""Components in Blender: their sum, names in files and nodes, layers, views, borders, animations and errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from gradus import passes, renderer
from support import application, compositing, images

SAMPLE = Path(__file__).resolve().parents[2] / "sample_blends" / "mirror_and_glass.blend"
DEFAULT = ("Emission", "Diffuse", "Reflection", "Transmission", "Residual")


@pytest.fixture
def sample() -> bpy.types.Scene:
    """Returns a scene with a mirror ball, glass, a lantern and a textured floor, and all passes of all components."""
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    scene = bpy.context.scene
    images.prepare(scene)
    show_all(scene.view_layers[0])
    return scene


def show_all(layer: bpy.types.ViewLayer) -> None:
    for part in passes.COMPONENT_TABLE:
        setattr(layer.gradus, part.switch.removeprefix("gradus."), True)


def part(rendered: images.Passes, name: str, suffix: str = "", layer: str = "ViewLayer") -> np.ndarray:
    return rendered[f"{layer}.Path {name}{suffix}"]


def require_sum(rendered: images.Passes, names: tuple[str, ...], layer: str = "ViewLayer") -> None:
    """Requires that components add up to Combined, within 1e-5 of the sum of their absolute values, because L2 may be
    negative."""
    parts = [part(rendered, name, "", layer).astype(np.float64) for name in names]
    combined = rendered[f"{layer}.Combined"][..., :3]
    scale = np.maximum(sum(np.abs(image) for image in parts), 1e-3)
    assert combined.any()
    np.testing.assert_array_less(np.abs(sum(parts) - combined) / scale, 1e-5)


# -------------------------------------------------------------------------------- sums


@pytest.mark.parametrize("reconstruction", ["NONE", "REGULARIZED", "L2", "L1"])
def test_components_add_up_to_combined(
    sample: bpy.types.Scene, render: Callable[..., images.Passes], reconstruction: str
) -> None:
    rendered = render(
        sample, frame=12, reconstruction=reconstruction, integrator="PATH" if reconstruction == "NONE" else "GRADIENT"
    )
    require_sum(rendered, DEFAULT)
    combined = rendered["ViewLayer.Combined"][..., :3].sum()
    assert all(part(rendered, name).sum() > 0.0005 * combined for name in DEFAULT)
    assert all(part(rendered, name).sum() < 0.95 * combined for name in DEFAULT)


@pytest.mark.parametrize("case", ["film", "holdout", "clamped", "denoised", "exposed"])
def test_components_add_up_after_each_kind_of_processing(
    sample: bpy.types.Scene, render: Callable[..., images.Passes], case: str
) -> None:
    """Components add up with each reconstruction, clamping and exposure, and with the denoiser if there is one."""
    bpy.data.objects.remove(bpy.data.objects["Back"])
    sample.render.film_transparent = case == "film"
    bpy.data.objects["Glass"].is_holdout = case == "holdout"
    settings = {
        "clamped": {"clamp_direct": 1.0, "clamp_indirect": 0.5},
        "denoised": {"denoiser": "AUTO"},
        "exposed": {"film_exposure": 2.5},
    }
    rendered = render(sample, samples=8, **settings.get(case, {}))
    assert (rendered["ViewLayer.Combined"][..., 3].min() == 0.0) == (case in ("film", "holdout"))
    require_sum(rendered, DEFAULT)


PLACES = {"Diffuse": (2, 3), "Reflection": (33, 15), "Transmission": (21, 15), "Emission": (36, 5)}
"""Pixels of the floor, the mirror ball, the slab and the lantern."""


@pytest.mark.parametrize("name", list(PLACES))
def test_each_component_has_the_light_that_its_name_describes(
    sample: bpy.types.Scene, render: Callable[..., images.Passes], name: str
) -> None:
    rendered = render(sample, frame=12, reconstruction="NONE", samples=16)
    x, y = PLACES[name]
    shares = {
        other: part(rendered, other)[y, x].sum() / rendered["ViewLayer.Combined"][y, x, :3].sum() for other in DEFAULT
    }
    assert shares[name] > 0.8, shares


def test_custom_components_add_up_and_match_their_expressions(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    rendered = render(sample, components="Direct=EDL;Indirect=ED.+L;Seen=EL")
    names = ("Direct", "Indirect", "Seen", "Residual")
    require_sum(rendered, names)
    by_default = render(sample, components="")
    both = part(rendered, "Direct") + part(rendered, "Indirect")
    diffuse = part(by_default, "Diffuse")
    assert both.sum() == pytest.approx(diffuse.sum(), rel=0.1)
    assert part(rendered, "Direct").sum() > 0.0
    assert part(rendered, "Indirect").sum() > 0.0


def test_components_without_paths_are_black(sample: bpy.types.Scene, render: Callable[..., images.Passes]) -> None:
    """Components without paths are not computed, but their passes exist."""
    bpy.data.objects.remove(bpy.data.objects["Glass"])
    bpy.data.objects.remove(bpy.data.objects["Slab"])
    rendered = render(sample)
    shown = [
        info.suffix for info in passes.COMPONENT_TABLE if not info.suffix.endswith(("Tracked", "Depth", "Face Index"))
    ]
    assert not any(part(rendered, "Transmission", suffix).any() for suffix in shown)
    assert (part(rendered, "Transmission", " Face Index") == -1.0).all()
    require_sum(rendered, DEFAULT)


def test_irradiance_times_reflectance_is_the_component(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    rendered = render(sample)
    for name in DEFAULT:
        color, reflectance, irradiance = (
            part(rendered, name, suffix) for suffix in ("", " Reflectance", " Irradiance")
        )
        expected = np.where(reflectance >= 1e-3, irradiance * reflectance, irradiance)
        np.testing.assert_allclose(color, expected, rtol=1e-4, atol=1e-6)
    floor = part(rendered, "Diffuse", " Normal")[1, 1:30]
    np.testing.assert_allclose(np.linalg.norm(floor, axis=-1), 1.0, atol=0.02)
    np.testing.assert_allclose(floor[:, 2], 1.0, atol=0.05)


# -------------------------------------------------------------------------------- surfaces

STEPS, CELL = 16, 1.25
"""Number of faces along a side of the wall, and their size."""


def add_plane(name: str, height: float, steps: int, cell: float, pass_index: int) -> bpy.types.Material:
    """Adds a plane of steps × steps faces with a UV map. Returns its material, which has no nodes."""
    side, half = steps + 1, 0.5 * steps
    vertices = [((x - half) * cell, (y - half) * cell, height) for y in range(side) for x in range(side)]
    corners = [
        (y * side + x, y * side + x + 1, (y + 1) * side + x + 1, (y + 1) * side + x)
        for y in range(steps)
        for x in range(steps)
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], corners)
    mesh.uv_layers.new(name="UVMap").data.foreach_set(
        "uv",
        [value / steps for corner in mesh.loops for value in (corner.vertex_index % side, corner.vertex_index // side)],
    )
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    mesh.materials.append(material)
    placed = bpy.data.objects.new(name, mesh)
    placed.pass_index = pass_index
    bpy.context.scene.collection.objects.link(placed)
    return material


def shade(material: bpy.types.Material, *kinds: str) -> list[bpy.types.Node]:
    """Gives a material the sum of shaders."""
    tree = material.node_tree
    shaders = [tree.nodes.new(f"ShaderNode{kind}") for kind in kinds]
    total = shaders[0].outputs[0]
    for shader in shaders[1:]:
        both = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(total, both.inputs[0])
        tree.links.new(shader.outputs[0], both.inputs[1])
        total = both.outputs[0]
    tree.links.new(total, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return shaders


@pytest.fixture
def mirror(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene whose camera, at height 3, looks down at a mirror, which shows an emissive wall above it."""
    gloss = shade(add_plane("Mirror", 0.0, 1, 20.0, 7), "BsdfGlossy")[0]
    gloss.inputs["Roughness"].default_value = 0.0
    gloss.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    screen = shade(add_plane("Wall", 6.0, STEPS, CELL, 9), "BsdfDiffuse", "Emission")[1]
    screen.inputs["Color"].default_value = (0.25, 0.5, 1.0, 1.0)
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location.z = 3.0
    scene.collection.objects.link(scene.camera)
    scene.gradus.use_decomposition = True
    show_all(scene.view_layers[0])
    return scene


def on_the_wall() -> tuple[np.ndarray, np.ndarray]:
    """Returns where the centres of pixels meet the wall through the mirror, in faces from its corner, 9 m along the
    axis."""
    width = 9.0 * 36.0 / 50.0 / CELL  # sensor / lens
    y, x = np.mgrid[0:36, 0:64]
    return STEPS / 2 + width * ((x + 0.5) / 64 - 0.5), STEPS / 2 + width * (y + 0.5 - 18) / 64


def test_a_mirror_has_the_map_indices_and_light_of_the_reflected_object(
    mirror: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    rendered = render(mirror, film_exposure=2.0)
    x, y = on_the_wall()
    uv = part(rendered, "Reflection", " UV")
    np.testing.assert_allclose(uv, np.stack((x / STEPS, y / STEPS, np.ones_like(x)), -1), atol=0.006)
    assert (part(rendered, "Reflection", " Object Index") == 9.0).all()
    inside = (np.abs(x - np.round(x)) > 0.2) & (np.abs(y - np.round(y)) > 0.2)
    faces = part(rendered, "Reflection", " Face Index")[..., 0]
    expected = np.floor(x) + STEPS * np.floor(y)
    assert inside.sum() > 500
    np.testing.assert_array_equal(faces[inside], expected[inside])
    assert len(set(faces[inside])) > 10
    np.testing.assert_allclose(
        part(rendered, "Reflection", " Emit"), np.broadcast_to((0.5, 1.0, 2.0), uv.shape), rtol=1e-5
    )
    for name in ("Diffuse", "Emission"):  # the mirror itself is specular and emits nothing
        assert (part(rendered, name, " Face Index") == -1.0).all()
        assert not any(part(rendered, name, suffix).any() for suffix in (" UV", " Object Index", " Emit"))


def test_directly_visible_surfaces_have_the_values_of_blender_s_passes(
    mirror: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    bpy.data.objects["Mirror"].location.z = 100.0
    mirror.camera.rotation_euler.x = np.pi
    layer = mirror.view_layers[0]
    layer.use_pass_uv = layer.use_pass_object_index = layer.use_pass_emit = True
    rendered = render(mirror)
    index, emit = ("Object Index", "Emission") if bpy.app.version >= (5, 0, 0) else ("IndexOB", "Emit")
    for name in ("Diffuse", "Emission"):
        for suffix, own in ((" UV", "UV"), (" Object Index", index), (" Emit", emit)):
            assert rendered[f"ViewLayer.{own}"].any()
            np.testing.assert_allclose(
                part(rendered, name, suffix), rendered[f"ViewLayer.{own}"], rtol=1e-5, atol=1e-6, err_msg=own
            )


# -------------------------------------------------------------------------------- names


def path_passes(rendered: images.Passes, layer: str = "ViewLayer") -> set[str]:
    head = f"{layer}.Path "
    return {name.removeprefix(f"{layer}.") for name in rendered if name.startswith(head)}


def test_names_registered_are_names_in_the_file(sample: bpy.types.Scene, render: Callable[..., images.Passes]) -> None:
    """Names have 24 letters, the maximum, because file formats and nodes have 64 bytes for them."""
    names = ("Abcdefghijklmnopqrstuvwx", "B")
    rendered = render(sample, components=f"{names[0]}=ED.*L;{names[1]}=ERDL")
    expected = {info.of(name).name: info for name in (*names, "Residual") for info in passes.COMPONENT_TABLE}
    assert path_passes(rendered) == set(expected)
    for name, info in expected.items():
        assert rendered[f"ViewLayer.{name}"].shape[2] == len(info.ids), name
    require_sum(rendered, (*names, "Residual"))


def test_the_longest_name_that_is_not_truncated_is_64_bytes(
    scene: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    """Blender's limit leaves 20 letters for the name of the view layer, if the name of the component has the maximum
    length."""
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    layer = scene.view_layers[0]
    scene.gradus.use_decomposition, scene.gradus.components = True, "Abcdefghijklmnopqrstuvwx=ED.*L"
    layer.gradus.use_pass_component_reflectance = True
    for letters, whole in ((20, True), (21, bpy.app.version >= (5, 0, 0))):
        layer.name = "L" * letters
        rendered = render(scene)
        channels = rendered.get(f"{layer.name}.Path Abcdefghijklmnopqrstuvwx Reflectance", np.zeros((1, 1, 0))).shape[2]
        assert (channels == 3) == whole


def test_layers_have_their_own_switches(sample: bpy.types.Scene, render: Callable[..., images.Passes]) -> None:
    second = sample.view_layers.new("Second")
    second.gradus.use_pass_components = False
    second.gradus.use_pass_component_normal = True
    rendered = render(sample)
    assert path_passes(rendered) == {info.of(name).name for name in DEFAULT for info in passes.COMPONENT_TABLE}
    assert path_passes(rendered, "Second") == {f"Path {name} Normal" for name in DEFAULT}


def test_a_border_is_the_crop_of_the_whole(sample: bpy.types.Scene, render: Callable[..., images.Passes]) -> None:
    whole = render(sample, reconstruction="NONE")
    sample.render.use_border = sample.render.use_crop_to_border = True
    sample.render.border_min_x, sample.render.border_max_x, sample.render.border_min_y, sample.render.border_max_y = (
        0.25,
        0.75,
        0.25,
        0.75,
    )
    crop = render(sample)
    for name in DEFAULT:
        for suffix in ("", " UV", " Object Index", " Face Index", " Emit"):
            np.testing.assert_array_equal(part(crop, name, suffix), part(whole, name, suffix)[9:27, 16:48])


def test_each_eye_has_its_components(sample: bpy.types.Scene, tmp_path: Path) -> None:
    sample.render.use_multiview = True
    sample.camera.data.stereo.interocular_distance = 0.4
    images.use_exr(sample, tmp_path / "eye.exr")
    sample.render.image_settings.views_format = "INDIVIDUAL"
    bpy.ops.render.render(write_still=True, scene=sample.name)
    left, right = (images.read(tmp_path / f"eye_{side}.exr") for side in "LR")
    for eye in (left, right):
        assert path_passes(eye) == {info.of(name).name for name in DEFAULT for info in passes.COMPONENT_TABLE}
        require_sum(eye, DEFAULT)
    assert not np.array_equal(part(left, "Diffuse"), part(right, "Diffuse"))


@pytest.mark.parametrize("temporal", [True, False])
def test_frames_of_an_animation_have_them(sample: bpy.types.Scene, tmp_path: Path, temporal: bool) -> None:
    sample.frame_start, sample.frame_end = 1, 3
    sample.gradus.use_temporal = temporal
    bpy.data.objects["Floor"].pass_index = 3
    images.use_exr(sample, tmp_path / "f_####.exr")
    bpy.ops.render.render(animation=True, scene=sample.name)
    frames = [images.read(tmp_path / f"f_{frame:04d}.exr") for frame in (1, 2, 3)]
    for rendered in frames:
        assert path_passes(rendered) == {info.of(name).name for name in DEFAULT for info in passes.COMPONENT_TABLE}
        require_sum(rendered, DEFAULT)
        assert (part(rendered, "Diffuse", " Object Index")[0, :30] == 3.0).all()
        assert (part(rendered, "Reflection", " Object Index") == 3.0).mean() > 0.01, "the ball shows the floor"
    assert not np.array_equal(part(frames[0], "Reflection"), part(frames[2], "Reflection"))


def test_k5_a_cancelled_render_keeps_its_picture(
    sample: bpy.types.Scene, render: Callable[..., images.Passes], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A cancelled render keeps its image without components, because they are computed after sampling."""
    calls: list[int] = []
    monkeypatch.setattr(renderer, "stop_requested", lambda engine: calls.append(1) or len(calls) > 4)
    rendered = render(sample, samples=100000)
    assert rendered["ViewLayer.Combined"][..., :3].any()
    assert all(np.isfinite(image).all() for image in rendered.values())


def test_without_decomposition_there_are_no_component_passes(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    assert path_passes(render(sample, use_decomposition=False)) == set()


# -------------------------------------------------------------------------------- refusals


MALFORMED = "A=EDL;B=ED.*L"


def test_a_malformed_set_ends_the_render_with_its_reason(
    sample: bpy.types.Scene, render: Callable[..., images.Passes]
) -> None:
    with pytest.raises(RuntimeError, match="components A and B overlap: both match EDL"):
        render(sample, components=MALFORMED)


@pytest.mark.application
def test_a_malformed_set_on_the_command_line_is_exit_code_1(
    blender: Callable[..., application.Outcome], tmp_path: Path
) -> None:
    arguments = (
        "--addons",
        "gradus",
        SAMPLE,
        "-o",
        tmp_path / "f_",
        "-f",
        "1",
        "--",
        "--gradus-use-decomposition",
        "1",
    )
    outcome = blender(*arguments, "--gradus-components", MALFORMED, "--gradus-samples", "1")
    assert (outcome.code, list(tmp_path.glob("f_*"))) == (1, []), outcome.output
    assert "overlap: both match EDL" in outcome.output


@pytest.mark.application
@pytest.mark.parametrize(
    "option", [("--gradus-components", "A=ED("), ("--gradus-passes", "components")], ids=lambda option: option[0]
)
def test_options_of_components_without_decomposition_are_exit_code_1(
    blender: Callable[..., application.Outcome], tmp_path: Path, option: tuple[str, str]
) -> None:
    """Regression: the options were ignored, and the image had no components."""
    sample = SAMPLE.with_name("cornell.blend")
    outcome = blender(
        "--addons", "gradus", sample, "-o", tmp_path / "f_", "-f", "1", "--", *option, "--gradus-samples", "1"
    )
    assert (outcome.code, list(tmp_path.glob("f_*"))) == (1, []), outcome.output
    assert (
        f"{option[0]}: the image is not decomposed into components; add --gradus-use-decomposition 1" in outcome.output
    )


@pytest.mark.application
def test_the_command_line_decomposes_an_image(blender: Callable[..., application.Outcome], tmp_path: Path) -> None:
    sample = SAMPLE.with_name("cornell.blend")
    outcome = blender(
        "--addons", "gradus", sample, "-o", tmp_path / "f_", "-F", "OPEN_EXR_MULTILAYER", "-f", "1", "--",
        "--gradus-use-decomposition", "1", "--gradus-components", "Direct=EDL",
        "--gradus-passes", "components", "--gradus-samples", "1",
    )  # fmt: skip
    assert outcome.code == 0, outcome.output
    rendered = images.read(tmp_path / "f_0001.exr")
    assert path_passes(rendered) == {
        info.of(name).name for name in ("Direct", "Residual") for info in passes.COMPONENT_TABLE
    }


# -------------------------------------------------------------------------------- File Output


def layer_of(name: str) -> str:
    """Returns the layer name with which a File Output node writes a pass.

    Blender 3.4 truncates names after 29 letters.
    """
    return name if bpy.app.version >= (4, 0) else name.replace("Irradiance ", "Flow ")[:29]


def file_output(
    scene: bpy.types.Scene, names: list[str], folder: Path, dimensions: int | None = None
) -> Callable[[], images.Passes]:
    """Adds a File Output node with passes of the render. Returns a function that reads its file."""
    tree = compositor(scene)
    render, node = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeOutputFile")
    settings = node.format
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    if hasattr(node, "file_output_items"):
        node.directory, node.file_name = str(folder), "out"
        for name in names:
            item = node.file_output_items.new(
                {"VALUE": "FLOAT", "RGBA": "RGBA"}.get(render.outputs[name].type, "VECTOR"), name
            )
            if dimensions is not None and item.socket_type == "VECTOR":
                item.vector_socket_dimensions = dimensions
    else:
        node.base_path = str(folder / "out")
        node.layer_slots.clear()
        for name in names:
            node.layer_slots.new(layer_of(name))
    for index, name in enumerate(names):
        tree.links.new(render.outputs[name], node.inputs[index])
    scene.render.use_compositing = True
    return lambda: images.read(next(folder.glob("out*")))


def compositor(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    tree, render, output = compositing.new_tree(scene)
    tree.links.new(render.outputs["Image"], output)
    scene.view_layers[0].update_render_passes()
    return tree


def test_a_file_output_node_writes_them(
    sample: bpy.types.Scene, render: Callable[..., images.Passes], tmp_path: Path
) -> None:
    names = [info.of(name).name for name in DEFAULT for info in passes.COMPONENT_TABLE]
    folder = tmp_path / "nodes"
    folder.mkdir()
    written = file_output(sample, names, folder)
    rendered, found = render(sample), written()
    for name in names:
        expected = rendered[f"ViewLayer.{name}"]
        layer = layer_of(name)
        image = next(image for full, image in found.items() if full == layer or full.startswith(f"{layer}."))
        channels = min(expected.shape[2], image.shape[2], 3)
        np.testing.assert_allclose(image[..., :channels], expected[..., :channels], rtol=1e-6, atol=1e-7, err_msg=name)


def test_the_fourth_number_of_a_motion_in_a_file_output(
    sample: bpy.types.Scene, render: Callable[..., images.Passes], tmp_path: Path
) -> None:
    """Only some versions of Blender write the fourth number, as the user guide describes."""
    keeps, asked = ((4, 0) <= bpy.app.version < (5, 0)), bpy.app.version >= (5, 0)
    name = "Path Diffuse Motion"
    for index, (dimensions, expected) in enumerate(
        [(None, 4 if keeps else 3), (4, 4)] if asked else [(None, 4 if keeps else 3)]
    ):
        folder = tmp_path / f"nodes{index}"
        folder.mkdir()
        written = file_output(sample, [name], folder, dimensions)
        render(sample)
        assert next(image for full, image in written().items() if full.startswith(name)).shape[2] == expected
