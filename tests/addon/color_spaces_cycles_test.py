"""Images in all colour spaces of Blender's configuration look as in Cycles of the same Blender, pixel by pixel.

A sheet shows an image of 4×4 pixels in each colour space, every pixel of the image on a pixel of the picture.
"""

from __future__ import annotations

import ctypes
import itertools
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from gradus import native, store
from support import images, recording
from support.nodes import Graph, new_material, show, translate

DIFFERENCE = 5e-3 if bpy.app.version >= (5, 2, 0) else 4e-2
"""Before 5.2, Cycles cuts bits off where it makes halves of bytes. Logarithmic spaces and tables magnify that."""
SKIES = [item.identifier for item in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items]
Make = Callable[[Path, str], Any]
"""Makes an image of 4×4 pixels in a colour space, with files in a folder."""

SIDE, COLUMNS = 4, 16
HAS_WORKING_SPACES = hasattr(bpy.data, "colorspace")
SPACES = [
    item.identifier for item in bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items
]


@pytest.fixture
def sheet(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Returns a scene whose camera sees a unit of length for each pixel, and a black world."""
    recording.add_camera(type="ORTHO", ortho_scale=64.0)
    return scene


def place(index: int, material: bpy.types.Material) -> None:
    """Adds a square of 4×4 pixels, the index counting from the lower left corner of the picture."""
    row, column = divmod(index, COLUMNS)
    location = ((column - 7.5) * SIDE, (row - 4.0) * SIDE, 0.0)
    bpy.ops.mesh.primitive_plane_add(size=float(SIDE), location=location)
    bpy.context.object.data.materials.append(material)


def add_image(index: int, image: Any) -> None:
    material = new_material()
    show(material, Graph(material)("TexImage", "Color", image=image, interpolation="Closest"))
    place(index, material)


def compare(
    scene: bpy.types.Scene, folder: Path, names: list[str], difference: float = DIFFERENCE, is_opaque: bool = True
) -> None:
    """Asserts that the pixels of each square are those of Cycles and that Gradus has nothing to say.

    difference: the largest one, relative to the largest component of a pixel above 1.
    """
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 4, False, False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1.0
    settings = {"samples": 4, "integrator": "PATH", "reconstruction": "NONE", "pixel_filter": "BOX"}
    pictures = []
    for engine in ("CYCLES", "GRADUS"):
        scene.render.engine = engine
        pictures.append(images.render(scene, folder, **settings, filter_width=1.0)["Combined"][..., :3])
    expected, got = pictures
    assert expected.max() > 0.1
    relative = np.abs(got - expected) / np.maximum(np.abs(expected).max(axis=2, keepdims=True), 1.0)
    found = {}
    for index, name in enumerate(names):
        row, column = divmod(index, COLUMNS)
        rows, columns = slice(SIDE * row, SIDE * (row + 1)), slice(SIDE * column, SIDE * (column + 1))
        if name == "AgX Log" and bpy.app.version < (5, 2, 0) and not is_opaque:
            continue  # where alpha is 0, Cycles shows 0.18 instead of black, for an unknown reason (2026-11-28)
        if relative[rows, columns].max() > difference:
            at = np.unravel_index(relative[rows, columns].argmax(), (SIDE, SIDE, 3))[:2]
            found[name] = (got[rows, columns][at], expected[rows, columns][at])
    text = [f"{name}: {got} instead of {expected}" for name, (got, expected) in found.items()]
    assert not text, "\n".join(text)


def values(alpha: bool, is_float: bool) -> np.ndarray:
    """Returns 16 colours: greys, saturated ones and dark ones; floats also beyond 0 and 1."""
    levels = np.array((0.0, 0.04, 0.25, 0.5, 0.8, 1.0), np.float32)
    colors = np.array(list(itertools.product(levels, repeat=3)), np.float32)[:: 216 // 16 - 1][:16]
    if is_float:
        colors = colors * 1.5 - 0.02
    alphas = np.tile((0.0, 0.25, 0.75, 1.0), 4) if alpha else np.ones(16)
    return np.concatenate([colors, alphas[:, None]], axis=1).astype(np.float32)


def save(folder: Path, kind: str, alpha: bool) -> str:
    is_float = kind == "OPEN_EXR"
    image = bpy.data.images.new("saved", SIDE, SIDE, alpha=alpha, float_buffer=is_float)
    image.pixels.foreach_set(values(alpha, is_float).ravel())
    image.filepath_raw, image.file_format = str(folder / f"image-{alpha}.{kind.lower()}"), kind
    image.save()
    bpy.data.images.remove(image)
    return str(folder / f"image-{alpha}.{kind.lower()}")


def file(kind: str, alpha: bool = False, mode: str = "STRAIGHT") -> Make:
    def load(folder: Path, space: str) -> Any:
        image = bpy.data.images.load(save(folder, kind, alpha), check_existing=False)
        image.alpha_mode = mode
        image.colorspace_settings.name = space
        return image

    return load


def packed(folder: Path, space: str) -> Any:
    image = file("PNG")(folder, space)
    image.pack()
    return image


def generated(_folder: Path, space: str) -> Any:
    image = bpy.data.images.new("generated", SIDE, SIDE, alpha=True)
    image.colorspace_settings.name = space
    image.pixels.foreach_set(values(True, False).ravel())
    image.update()
    return image


KINDS = {
    "bytes": file("PNG"),
    "bytes and alpha": file("PNG", alpha=True),
    "channel-packed bytes": file("PNG", alpha=True, mode="CHANNEL_PACKED"),
    "floats": file("OPEN_EXR"),
    "premultiplied floats": file("OPEN_EXR", alpha=True, mode="PREMUL"),
    "packed file": packed,
    "generated": generated,
}
OPAQUE = {"bytes", "floats", "packed file"}


def show_all_spaces(folder: Path, make: Make) -> None:
    for index, space in enumerate(SPACES):
        add_image(index, make(folder, space))


@pytest.mark.parametrize("kind", KINDS)
def test_all_colour_spaces(sheet: bpy.types.Scene, tmp_path: Path, kind: str) -> None:
    if kind == "channel-packed bytes" and bpy.app.version < (5, 0, 0):
        pytest.skip("Cycles divides by the fourth channel; the next test expects a warning")
    show_all_spaces(tmp_path, KINDS[kind])
    compare(sheet, tmp_path, SPACES, is_opaque=kind in OPAQUE)


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="Cycles no longer divides by the fourth channel")
@pytest.mark.parametrize("space, is_named", [("Filmic Log", True), ("sRGB", False), ("Non-Color", False)])
def test_channels_that_cycles_divides_are_named(
    sheet: bpy.types.Scene, tmp_path: Path, space: str, is_named: bool
) -> None:
    add_image(0, KINDS["channel-packed bytes"](tmp_path, space))
    images.render(sheet, tmp_path, samples=1)
    warnings = store.summaries[(sheet.name, bpy.context.view_layer.name)]["warnings"]
    assert any("is channel-packed, and Cycles before Blender 5.0 divides" in text for text in warnings) == is_named


@pytest.fixture(params=["Linear Rec.2020", "ACEScg"])
def working_space(request: pytest.FixtureRequest, sheet: bpy.types.Scene) -> str:
    if not HAS_WORKING_SPACES:
        pytest.skip("this Blender has no working spaces")
    bpy.ops.wm.set_working_color_space(working_space=request.param, convert_colors=True)
    return request.param


@pytest.mark.parametrize("kind", ["bytes and alpha", "floats"])
def test_all_colour_spaces_in_a_working_space(
    sheet: bpy.types.Scene, tmp_path: Path, working_space: str, kind: str
) -> None:
    show_all_spaces(tmp_path, KINDS[kind])
    compare(sheet, tmp_path, SPACES, is_opaque=kind in OPAQUE)


def make_colors(graph: Graph) -> dict[str, bpy.types.NodeSocket]:
    """Returns colours that nodes make themselves."""
    made = {f"{kelvin} K": graph("Blackbody", "Color", {"Temperature": kelvin}) for kelvin in (2500.0, 6500.0, 11000.0)}
    mixed = graph("RGB", "Color")
    mixed.default_value = (0.9, 0.3, 0.1, 1.0)
    made["grey"] = graph("RGBToBW", "Val", {"Color": graph("HueSaturation", "Color", {"Color": mixed})})
    made["constant grey"] = graph("RGBToBW", "Val", {"Color": mixed})
    made["converted to a number"] = graph("Math", "Value", {"Value": mixed}, operation="ADD")
    return made


def test_colours_that_nodes_make_in_a_working_space(sheet: bpy.types.Scene, tmp_path: Path, working_space: str) -> None:
    names = list(make_colors(Graph(new_material())))
    for index, name in enumerate(names):
        material = new_material()
        show(material, make_colors(Graph(material))[name])
        place(index, material)
    compare(sheet, tmp_path, names, 1e-2)


@pytest.mark.parametrize("kind", SKIES)
def test_skies_in_a_working_space(sheet: bpy.types.Scene, tmp_path: Path, working_space: str, kind: str) -> None:
    sheet.camera.rotation_euler = (math.radians(130.0), 0.0, 0.0)
    sheet.world = bpy.data.worlds.new("World")
    graph = Graph(sheet.world)
    graph.tree.links.new(graph("TexSky", "Color", sky_type=kind), graph.tree.nodes["Background"].inputs["Color"])
    compare(sheet, tmp_path, ["sky"], 1e-2)


def test_colours_of_meshes_in_a_working_space(sheet: bpy.types.Scene, tmp_path: Path, working_space: str) -> None:
    kinds = ["BYTE_COLOR CORNER", "FLOAT_COLOR CORNER", "FLOAT_COLOR POINT", "BYTE_COLOR POINT"]
    for index, kind in enumerate(kinds):
        material = new_material()
        show(material, Graph(material)("Attribute", "Color", attribute_name="Painted"))
        place(index, material)
        colors = bpy.context.object.data.color_attributes.new("Painted", *kind.split())
        for point in colors.data:
            point.color = (0.9, 0.3, 0.1, 1.0)
    compare(sheet, tmp_path, kinds, 1e-2)


def test_light_of_a_temperature_in_a_working_space(sheet: bpy.types.Scene, tmp_path: Path, working_space: str) -> None:
    material = new_material()
    place(0, material)
    show(material, Graph(material)("BsdfDiffuse", "BSDF"))
    light = bpy.data.lights.new("Sun", "SUN")
    light.use_temperature, light.temperature = True, 3000.0
    recording.add(light, "Sun", (0.0, 0.0, 3.0))
    compare(sheet, tmp_path, ["light"], 1e-2)


def test_a_space_that_the_configuration_does_not_know(sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """The file was saved with another configuration. Blender takes its default for the space."""
    for index, kind in enumerate(("bytes", "packed file")):
        add_image(index, KINDS[kind](tmp_path, "Filmic Log"))
    path = tmp_path / "other.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    contents = path.read_bytes()
    assert b"Filmic Log\0" in contents
    path.write_bytes(contents.replace(b"Filmic Log\0", b"Studio Log\0"))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    compare(bpy.context.scene, tmp_path, ["bytes", "packed file"])


def test_a_scene_file_needs_no_configuration(
    sheet: bpy.types.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tool renders scene files without Blender."""
    path = tmp_path / "saved.gradus"
    show_all_spaces(tmp_path, KINDS["bytes and alpha"])
    monkeypatch.setattr(sys, "argv", ["blender", "--", "--gradus-save-scene", str(path)])
    expected = images.render(sheet, tmp_path, samples=4, integrator="PATH", reconstruction="NONE")["Combined"]
    library = native.load()
    device, scene, render = ctypes.c_uint64(), ctypes.c_uint64(), ctypes.c_uint64()
    settings = native.Settings()
    library.device_create(ctypes.byref(native.DeviceSettings()), ctypes.byref(device))
    library.scene_load(device.value, native.text(str(path)), ctypes.byref(scene), ctypes.byref(settings))
    library.render_start(scene.value, ctypes.byref(settings), ctypes.byref(render))
    library.render_wait(render.value, -1.0)
    pixels = np.zeros(expected.shape, np.float32)
    address = pixels.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
    library.render_read_pass(render.value, native.Pass.COMBINED, address, pixels.size)
    assert library.take_device_warnings(device.value) == []
    library.render_release(render.value)
    library.scene_release(scene.value)
    library.device_release(device.value)
    assert np.array_equal(pixels, expected)


@pytest.mark.parametrize(
    ("kind", "inputs", "is_named"),
    [
        ("Wavelength", {}, True),
        ("Blackbody", {"Temperature": 1000.0}, True),
        ("Blackbody", {"Temperature": 3000.0}, False),
    ],
)
def test_colours_that_are_cut_off_in_a_working_space_are_named(
    sheet: bpy.types.Scene, working_space: str, kind: str, inputs: dict[str, float], is_named: bool
) -> None:
    material = new_material()
    show(material, Graph(material)(kind, "Color", inputs))
    warnings = translate(material).warnings
    assert any("Rec. 709" in text for text in warnings) == is_named


@pytest.mark.skipif(not getattr(bpy.app, "module", False), reason="starts Python, not Blender")
def test_a_configuration_of_a_studio(tmp_path: Path) -> None:
    """The environment variable OCIO names a configuration whose scene-linear space is ACEScg, as studios have it."""
    folder = shutil.copytree(Path(bpy.utils.resource_path("LOCAL"), "datafiles", "colormanagement"), tmp_path / "ocio")
    config = folder / "config.ocio"
    text = config.read_text(encoding="utf-8")
    assert "scene_linear: Linear Rec.709" in text
    config.write_text(text.replace("scene_linear: Linear Rec.709", "scene_linear: ACEScg"), encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", f"{__file__}::test_all_colour_spaces[bytes]"]
    root = Path(__file__).parents[2]
    environment = os.environ | {"OCIO": str(config), "PYTHONPATH": f"{root / 'tests'}{os.pathsep}{root / 'addon'}"}
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert result.returncode == 0 and "1 passed" in result.stdout, result.stdout[-3000:]
