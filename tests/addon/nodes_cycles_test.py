"""Nodes have the values of Cycles in the same Blender.

Values are rendered as emission, so that there is noise at edges only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images, recording
from support.cycles import pictures
from support.nodes import Graph, new_material, show, socket

VERSION = tuple(bpy.app.version)


def checker_image() -> bpy.types.Image:
    """Returns an image of 32×32 pixels with blue checks and half-transparent stripes.

    Red increases to the right and green upwards.
    """
    image = bpy.data.images.new("pattern", 32, 32, alpha=True)
    y, x = np.mgrid[0:32, 0:32].astype(np.float32)
    pixels = np.stack([x / 31, y / 31, (x // 4 + y // 4) % 2, np.where((x // 8) % 2 == 0, 1.0, 0.5)], axis=2).astype(
        np.float32
    )
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def noise(graph: Graph, **properties: Any) -> bpy.types.NodeSocket:
    inputs = {"Vector": graph.place(), "Scale": 3.0, "Detail": 2.5, "Roughness": 0.6, "Distortion": 0.5, "W": 0.7}
    return graph("TexNoise", "Color", inputs, **properties)


def normal_colors(graph: Graph) -> bpy.types.NodeSocket:
    """Returns colours of a moderate normal map."""
    image = graph("TexImage", "Color", image=checker_image())
    return graph("MixRGB", "Color", {"Fac": 0.25, "Color1": (0.5, 0.5, 1.0, 1.0), "Color2": image})


def normal_from(graph: Graph, space: str, other: str) -> bpy.types.NodeSocket:
    """Returns a long normal in another space."""
    inputs = {"Vector": (0.5, 1.2, 0.8)}
    return graph("VectorTransform", "Vector", inputs, vector_type="NORMAL", convert_from=space, convert_to=other)


def coarse_image() -> bpy.types.Image:
    image = bpy.data.images.new("coarse", 3, 3, alpha=True, float_buffer=True)
    image.pixels.foreach_set(np.linspace(0.3, 1.0, 36, dtype=np.float32))
    return image


def beyond_borders(graph: Graph) -> bpy.types.NodeSocket:
    """Returns UV coordinates from -0.5 to 1.5."""
    return graph(
        "Mapping",
        "Vector",
        {"Vector": graph("TexCoord", "UV"), "Location": (-0.5, -0.5, 0.0), "Scale": (2.0, 2.0, 1.0)},
    )


def muted(output: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    output.node.mute = True
    return output


def changed(output: bpy.types.NodeSocket, path: str, value: Any) -> bpy.types.NodeSocket:
    """Sets a property of a part of the output's node."""
    part, name = path.split(".")
    setattr(getattr(output.node, part), name, value)
    return output


CASES: dict[str, Callable[[Graph], bpy.types.NodeSocket]] = {
    "generated": lambda g: g("TexCoord", "Generated"),
    "normal": lambda g: g("TexCoord", "Normal"),
    "uv": lambda g: g("TexCoord", "UV"),
    "object": lambda g: g("TexCoord", "Object"),
    "camera": lambda g: g("TexCoord", "Camera"),
    "window": lambda g: g("TexCoord", "Window"),
    "reflection": lambda g: g("TexCoord", "Reflection"),
    "position": lambda g: g("NewGeometry", "Position"),
    "tangent": lambda g: g("NewGeometry", "Tangent"),
    "incoming": lambda g: g("NewGeometry", "Incoming"),
    "mapping": lambda g: g(
        "Mapping", "Vector", {"Vector": g.place(), "Location": (0.1, 0.2, 0.3), "Rotation": (0.4, 0.5, 0.6)}
    ),
    "image flat": lambda g: g("TexImage", "Color", image=checker_image()),
    "image alpha": lambda g: g("TexImage", "Alpha", image=checker_image()),
    "image box": lambda g: g(
        "TexImage", "Color", {"Vector": g.place()}, image=checker_image(), projection="BOX", projection_blend=0.3
    ),
    "image sphere": lambda g: g("TexImage", "Color", {"Vector": g.place()}, image=checker_image(), projection="SPHERE"),
    "image tube": lambda g: g("TexImage", "Color", {"Vector": g.place()}, image=checker_image(), projection="TUBE"),
    "environment": lambda g: g(
        "TexEnvironment", "Color", {"Vector": g("TexCoord", "Reflection")}, image=checker_image()
    ),
    "mirror ball": lambda g: g(
        "TexEnvironment",
        "Color",
        {"Vector": g("TexCoord", "Reflection")},
        image=checker_image(),
        projection="MIRROR_BALL",
    ),
    "noise 1D": lambda g: noise(g, noise_dimensions="1D"),
    "noise 2D": lambda g: noise(g, noise_dimensions="2D"),
    "noise 3D": lambda g: noise(g, noise_dimensions="3D"),
    "noise 4D": lambda g: noise(g, noise_dimensions="4D"),
    "overlay": lambda g: g(
        "MixRGB", "Color", {"Fac": 0.7, "Color1": g.place(), "Color2": (0.6, 0.3, 0.8, 1.0)}, blend_type="OVERLAY"
    ),
    "hue": lambda g: g("HueSaturation", "Color", {"Hue": 0.7, "Saturation": 1.3, "Color": g("TexCoord", "UV")}),
    "ramp": lambda g: g("ValToRGB", "Color", {"Fac": g.place()}),
    "curves": lambda g: g("RGBCurve", "Color", {"Color": g.place()}),
    "facing": lambda g: g("LayerWeight", "Facing", {"Blend": 0.3}),
    "fresnel": lambda g: g("Fresnel", "Fac", {"IOR": 1.7}),
    "normal map": lambda g: g("NormalMap", "Normal", {"Color": normal_colors(g)}),
    "half a normal map": lambda g: g("NormalMap", "Normal", {"Strength": 0.5, "Color": normal_colors(g)}),
    "normal in object space": lambda g: normal_from(g, "WORLD", "OBJECT"),
    "normal in world space": lambda g: normal_from(g, "OBJECT", "WORLD"),
    "normal in camera space": lambda g: normal_from(g, "OBJECT", "CAMERA"),
    "steep bump": lambda g: g("Bump", "Normal", {"Distance": 3.0, "Height": g("TexCoord", "Generated")}),
    "bump": lambda g: g(
        "Bump", "Normal", {"Distance": 0.2, "Height": g("TexNoise", "Fac", {"Vector": g.place(), "Scale": 2.0})}
    ),
    "bump of smooth cells": lambda g: g(
        "Bump",
        "Normal",
        {
            "Distance": 0.3,
            "Height": g("TexVoronoi", "Distance", {"Vector": g.place(), "Scale": 2.0}, feature="SMOOTH_F1"),
        },
    ),
    "bump of edges": lambda g: g(
        "Bump",
        "Normal",
        {
            "Distance": 0.3,
            "Height": g("TexVoronoi", "Distance", {"Vector": g.place(), "Scale": 2.0}, feature="DISTANCE_TO_EDGE"),
        },
    ),
    "tangent uv": lambda g: g("Tangent", "Tangent", direction_type="UV_MAP"),
    "image clipped": lambda g: g(
        "TexImage", "Color", {"Vector": beyond_borders(g)}, image=coarse_image(), extension="CLIP"
    ),
    "image clipped, cubic": lambda g: g(
        "TexImage",
        "Alpha",
        {"Vector": beyond_borders(g)},
        image=coarse_image(),
        extension="CLIP",
        interpolation="Cubic",
    ),
    "bump without height": lambda g: g("Bump", "Normal", {"Distance": 0.2}),
    "muted bump": lambda g: muted(g("Bump", "Normal", {"Height": g("TexNoise", "Fac", {"Vector": g.place()})})),
    "muted inversion": lambda g: muted(g("Invert", "Color", {"Fac": g("TexNoise", "Fac", {"Vector": g.place()})})),
    "constant ramp": lambda g: changed(
        g("ValToRGB", "Color", {"Fac": g.place()}), "color_ramp.interpolation", "CONSTANT"
    ),
    "curves clipped": lambda g: changed(g("RGBCurve", "Color", {"Color": g.place()}), "mapping.clip_min_y", 0.4),
    "candle": lambda g: g("Blackbody", "Color", {"Temperature": 1500.0}),
    "blue sky": lambda g: g("Blackbody", "Color", {"Temperature": 20000.0}),
}


@pytest.fixture(scope="module")
def stage() -> bpy.types.Scene:
    """Returns a scene with a smooth sphere and a rotated, non-uniformly scaled cube in a grey world."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    bpy.ops.mesh.primitive_uv_sphere_add(location=(-1.2, 0.0, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(1.2, 0.2, 0.0), rotation=(0.3, 0.2, 0.5))
    bpy.context.object.scale = (1.3, 1.0, 0.6)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.5, -6.0, 1.5), (1.33, 0.0, 0.08)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    return scene


@pytest.mark.parametrize("name", CASES)
def test_a9_node(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    if name in {"bump of smooth cells", "bump of edges"} and VERSION < (4, 5, 0):
        pytest.skip("before 4.5 Cycles compares heights of neighbouring pixels, which are far apart here")
    material = new_material()
    show(material, CASES[name](Graph(material)))
    for item in stage.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(material)
    expected, found = pictures(stage, tmp_path)
    difference = np.abs(expected - found)
    scale = np.abs(expected).mean() + 1e-2
    # Edges are sampled at other positions, so that a few blocks may differ, but not the mean.
    assert difference.mean() / scale < 0.025
    assert np.quantile(difference, 0.95) / scale < 0.15
    assert np.abs(expected.mean(axis=(0, 1)) - found.mean(axis=(0, 1))).max() / scale < 0.02


@pytest.mark.parametrize("kind", ["Squeeze", "UVAlongStroke"])
def test_a9_nodes_that_cycles_does_not_have(kind: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """The inputs that they are linked to have their own values."""
    material = new_material()
    graph = Graph(material)
    node = graph.tree.nodes.new(f"ShaderNode{kind}")
    show(material, graph("HueSaturation", "Color", {"Color": node.outputs[0]}))
    for item in stage.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(material)
    expected, found = pictures(stage, tmp_path)
    assert expected.mean() > 0.1
    assert np.abs(expected - found).mean() < 0.01 * expected.mean()


def menu_switch(graph: Graph) -> bpy.types.NodeSocket:
    node = graph.tree.nodes.new("GeometryNodeMenuSwitch")
    for target, output in zip(node.inputs[1:3], ("Generated", "UV"), strict=True):
        graph.tree.links.new(graph("TexCoord", output), target)
    node.inputs[0].default_value = "B"
    return node.outputs[0]


def repeat_zone(graph: Graph) -> bpy.types.NodeSocket:
    """Returns ((u + 0.2) + 0.2) + 0.2."""
    start, end = (graph.tree.nodes.new(f"GeometryNodeRepeat{kind}") for kind in ("Input", "Output"))
    start.pair_with_output(end)
    end.repeat_items.clear()
    end.repeat_items.new("FLOAT", "Number")
    start.inputs["Iterations"].default_value = 3
    graph.tree.links.new(graph("TexCoord", "UV"), start.inputs["Number"])
    more = graph("Math", "Value", {"Value": start.outputs["Number"], "Value_001": 0.2}, operation="ADD")
    graph.tree.links.new(more, end.inputs["Number"])
    return end.outputs["Number"]


def bundle(graph: Graph) -> bpy.types.NodeSocket:
    combined, separated = (graph.tree.nodes.new(f"Node{kind}Bundle") for kind in ("Combine", "Separate"))
    for node in (combined, separated):
        node.bundle_items.new("VECTOR", "Place")
    graph.tree.links.new(graph("TexCoord", "Generated"), combined.inputs["Place"])
    graph.tree.links.new(combined.outputs[0], separated.inputs[0])
    return separated.outputs["Place"]


def closure(graph: Graph) -> bpy.types.NodeSocket:
    """Returns a function of a zone, evaluated at UV coordinates."""
    first, last, evaluation = (
        graph.tree.nodes.new(f"Node{kind}") for kind in ("ClosureInput", "ClosureOutput", "EvaluateClosure")
    )
    first.pair_with_output(last)
    for node in (last, evaluation):
        node.input_items.new("VECTOR", "Place")
        node.output_items.new("VECTOR", "Moved")
    moved = graph("VectorMath", "Vector", {"Vector": first.outputs["Place"]}, operation="SINE")
    for source, target in (
        (moved, last.inputs["Moved"]),
        (last.outputs["Closure"], evaluation.inputs["Closure"]),
        (graph("TexCoord", "UV"), evaluation.inputs["Place"]),
    ):
        graph.tree.links.new(source, target)
    return evaluation.outputs["Moved"]


def scene_time(graph: Graph) -> bpy.types.NodeSocket:
    bpy.context.scene.frame_set(17)
    return graph.tree.nodes.new("GeometryNodeInputSceneTime").outputs["Seconds"]


MAKERS = [menu_switch, repeat_zone, bundle, closure] + ([scene_time] if VERSION >= (5, 2, 0) else [])


@pytest.mark.skipif(VERSION < (5, 0, 0), reason="came with Blender 5.0")
@pytest.mark.parametrize("make", MAKERS)
def test_a9_nodes_that_blender_evaluates(
    make: Callable[[Graph], bpy.types.NodeSocket], stage: bpy.types.Scene, tmp_path: Path
) -> None:
    material = new_material()
    show(material, make(Graph(material)))
    for item in stage.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(material)
    expected, found = pictures(stage, tmp_path)
    assert expected.mean() > 0.1
    assert np.abs(expected - found).mean() < 0.025 * expected.mean()


def test_a9_surfaces_without_a_material(stage: bpy.types.Scene, tmp_path: Path) -> None:
    """From Blender 5.0 on, such surfaces are slightly glossy.

    Regression: they were diffuse grey and 15 % too dark.
    """
    for item in stage.objects:
        if item.type == "MESH":
            item.data.materials.clear()
    expected, found = pictures(stage, tmp_path)
    difference = np.abs(expected - found)
    assert difference.mean() / expected.mean() < 0.01
    assert np.quantile(difference, 0.95) / expected.mean() < 0.05


@pytest.fixture
def bare(stage: bpy.types.Scene) -> Iterator[bpy.types.Scene]:
    """Returns the stage with its objects hidden. The active object, which a test adds, is removed afterwards."""
    others = [item for item in stage.objects if item.type == "MESH"]
    for item in others:
        item.hide_render = True
    yield stage
    bpy.data.objects.remove(bpy.context.object)
    for item in others:
        item.hide_render = False


@pytest.fixture
def coarse(bare: bpy.types.Scene) -> bpy.types.Scene:
    """Returns the stage with a smooth, coarse sphere instead of the other objects."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6, radius=1.5)
    bpy.ops.object.shade_smooth()
    return bare


@pytest.mark.parametrize("name", ["normal map", "tangent uv"])
def test_a9_tangents_run_smoothly_over_coarse_meshes(name: str, coarse: bpy.types.Scene, tmp_path: Path) -> None:
    material = new_material()
    show(material, CASES[name](Graph(material)))
    bpy.context.object.data.materials.append(material)
    expected, found = pictures(coarse, tmp_path)
    difference = np.abs(expected - found)
    assert np.abs(expected).mean() > 0.05
    assert np.quantile(difference, 0.95) / np.abs(expected).mean() < 0.02


def test_a9_normals_of_polygons(bare: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: before 4.0 the triangles of quads weighted smooth normals, up to 22° off."""
    bpy.ops.mesh.primitive_monkey_add(size=3.0)
    bpy.ops.object.shade_smooth()
    material = new_material()
    graph = Graph(material)
    half = graph("VectorMath", "Vector", {"Vector": graph("NewGeometry", "Normal")}, operation="MULTIPLY_ADD")
    for item in half.node.inputs[1:3]:
        item.default_value = (0.5, 0.5, 0.5)
    show(material, half)
    bpy.context.object.data.materials.append(material)
    expected, found = pictures(bare, tmp_path)
    assert np.abs(expected - found).mean() < 0.01 * expected.mean()


@pytest.mark.skipif("convention" not in bpy.types.ShaderNodeNormalMap.bl_rna.properties, reason="came with 5.2")
def test_a9_normal_maps_of_directx(coarse: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: the convention was ignored."""
    material = new_material()
    graph = Graph(material)
    show(material, graph("NormalMap", "Normal", {"Color": normal_colors(graph)}, convention="DIRECTX"))
    bpy.context.object.data.materials.append(material)
    expected, found = pictures(coarse, tmp_path)
    assert np.quantile(np.abs(expected - found), 0.95) / np.abs(expected).mean() < 0.02


@pytest.mark.parametrize("alpha", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize("kind", ["float", "data", "raw"])
def test_a9_alpha_of_images(kind: str, alpha: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Since 5.2 Cycles multiplies float images by their alpha.

    Regression: data were multiplied by it, too, and the colour space Raw of Blender 3.4 did not count as data.
    """
    image = bpy.data.images.new("pattern", 4, 4, alpha=True, float_buffer=kind == "float", is_data=kind == "data")
    image.pixels.foreach_set(np.tile(np.array([0.8, 0.4, 0.2, 0.5], np.float32), 16))
    image.update()
    if kind == "raw":
        if VERSION >= (4, 0, 0):
            pytest.skip("from 4.0 on, Raw is another name of Non-Color")
        image.colorspace_settings.name = "Raw"
    image.alpha_mode = alpha
    material = new_material()
    show(material, Graph(material)("TexImage", "Color", image=image))
    bpy.ops.mesh.primitive_plane_add(size=10.0)
    bpy.context.object.data.materials.append(material)
    recording.add_camera().location = (0.0, 0.0, 3.0)
    expected, found = pictures(scene, tmp_path)
    np.testing.assert_allclose(found, expected, atol=0.01)


FILES = {
    "PNG": {"color_depth": "8"},
    "PNG 16 bit": {"color_depth": "16"},
    "TIFF": {"color_depth": "8"},
    "TARGA": {},
    "WEBP": {"quality": 100},
    "BMP": {},
    "IRIS": {},
    "DPX": {"color_depth": "10"},
    "OPEN_EXR": {"color_depth": "32"},
}


def save_columns(
    scene: bpy.types.Scene, kind: str, mode: str, folder: Path, alphas: tuple[float, float], is_float: bool
) -> str:
    """Saves an image whose columns have two alphas in turn, in a format, and returns its path."""
    image = bpy.data.images.new("columns", 8, 8, alpha=True, float_buffer=is_float)
    image.pixels.foreach_set([value for alpha in alphas for value in (0.4, 0.3, 0.15, alpha)] * 32)
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode = kind.split()[0], mode
    for name, value in FILES[kind].items():
        setattr(settings, name, value)
    path = str(folder / f"columns.{kind.split()[0].lower()}")
    image.save_render(path, scene=scene)
    bpy.data.images.remove(image)
    return path


@pytest.mark.parametrize("is_packed", [False, True])
@pytest.mark.parametrize("kind", FILES)
def test_a9_alpha_of_files(kind: str, is_packed: bool, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Every alpha mode, with and without a use of the output Alpha, for a column of planes.

    Regression: 16 bit images, Premultiplied and formats that Blender decodes differed by up to a factor of 4.
    """
    if kind in {"BMP", "IRIS", "DPX"} and VERSION < (4, 0, 0):
        pytest.skip("Gradus shows Blender's pixels, because this Blender has no OpenImageIO for Python")
    if is_packed and kind in {"TARGA", "WEBP", "TIFF", "BMP", "IRIS", "DPX"}:
        pytest.skip("Cycles reads packed files of this format in other ways from version to version")
    path = save_columns(scene, kind, "RGBA", tmp_path, (0.5, 0.5), is_float=kind == "OPEN_EXR")
    modes = ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"]
    for column, mode in enumerate(modes):
        for row, is_used in enumerate((False, True)):
            image = bpy.data.images.load(path, check_existing=False)
            if is_packed:
                image.pack()
            image.alpha_mode = mode
            material = new_material()
            color = Graph(material)("TexImage", "Color", image=image)
            show(material, color)
            if is_used:
                graph = Graph(material)
                scale = graph("Math", "Value", {"Value": socket(color.node.outputs, "Alpha")}, operation="MULTIPLY_ADD")
                scale.node.inputs[1].default_value, scale.node.inputs[2].default_value = 0.0, 1.0
                emission = next(n for n in graph.tree.nodes if n.bl_idname == "ShaderNodeEmission")
                graph.tree.links.new(scale, emission.inputs["Strength"])
            bpy.ops.mesh.primitive_plane_add(size=1.0, location=(column - 1.5, row - 0.5, 0.0))
            bpy.context.object.data.materials.append(material)
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    expected, found = pictures(scene, tmp_path)
    inside = np.s_[2:7, 1:15]  # without the blocks at edges
    np.testing.assert_allclose(found[inside], expected[inside], rtol=0.02, atol=0.01)


SLOTS = {
    "empty slot": (("OBJECT", False), ("DATA", True)),
    "two empty slots": (("OBJECT", False), ("OBJECT", False)),
    "material of the object": (("OBJECT", True), ("DATA", True)),
    "material of the data": (("DATA", True), ("OBJECT", False)),
}


@pytest.mark.parametrize("is_instance", [False, True])
@pytest.mark.parametrize("name", SLOTS)
def test_a9_slots_of_objects(name: str, is_instance: bool, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: from Blender 5.2 on, an empty slot of an object does not show the material of its mesh."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=2, y_subdivisions=1, size=2.0)
    obj = bpy.context.object
    obj.data.polygons[1].material_index = 1
    for index, (link, has_material) in enumerate(SLOTS[name]):
        for place in ("data", "object"):
            material = new_material()
            color = (0.2 + 0.6 * index, 0.3, 0.9 if place == "object" else 0.1)
            show(material, Graph(material)("CombineXYZ", "Vector", dict(zip("XYZ", color, strict=True))))
            if place == "data":
                obj.data.materials.append(material)
            elif link == "OBJECT":
                obj.material_slots[index].link = "OBJECT"
                obj.material_slots[index].material = material if has_material else None
    if is_instance:
        source = bpy.data.collections.new("Source")
        source.objects.link(obj)
        scene.collection.objects.unlink(obj)
        empty = bpy.data.objects.new("Instancer", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", source
        scene.collection.objects.link(empty)
    scene.world = bpy.data.worlds.new("World")
    recording.add_camera(type="ORTHO", ortho_scale=2.0).location = (0.0, 0.0, 3.0)
    expected, found = pictures(scene, tmp_path)
    np.testing.assert_allclose(found, expected, atol=0.02)


CLIPPED = [
    *((kind, mode) for kind in ("PNG", "PNG 16 bit", "TIFF", "OPEN_EXR") for mode in ("RGBA", "BW")),
    ("generated", "RGBA"),
    ("packed", "BW"),
    ("missing", "RGBA"),
]


@pytest.mark.parametrize(("kind", "mode"), CLIPPED)
def test_a9_alpha_outside_of_clipped_images(kind: str, mode: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Every alpha mode, and every interpolation, for a column of planes that show alpha.

    Regression: images without alpha were opaque outside, and files of one channel were not.
    """
    if kind == "missing" and VERSION < (5, 1, 0):
        pytest.skip("Cycles then clips the pink of missing files, too, which Gradus names and does not clip")
    if kind == "generated":
        image = bpy.data.images.new("generated", 8, 8, alpha=True)
    else:
        file = "PNG" if kind in {"packed", "missing"} else kind
        path = save_columns(scene, file, mode, tmp_path, (0.5, 1.0), is_float=True)
        image = bpy.data.images.load(path)
    if kind == "packed":
        image.pack()
    if kind == "missing":
        Path(path).unlink()
        image.reload()
    for column, alpha in enumerate(["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"]):
        shown = image.copy()
        shown.alpha_mode = alpha
        for row, interpolation in enumerate(["Linear", "Closest", "Cubic"]):
            material = new_material()
            graph = Graph(material)
            properties = {"image": shown, "extension": "CLIP", "interpolation": interpolation}
            show(material, graph("TexImage", "Alpha", {"Vector": beyond_borders(graph)}, **properties))
            bpy.ops.mesh.primitive_plane_add(size=1.0, location=(column - 1.5, 0.75 * (row - 1), 0.0))
            bpy.context.object.scale.y = 0.75
            bpy.context.object.data.materials.append(material)
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    expected, found = pictures(scene, tmp_path)
    assert expected.max() > 0.1
    assert np.abs(found - expected).mean() < 0.01
    assert np.quantile(np.abs(found - expected), 0.95) < 0.1


@pytest.mark.parametrize("kind", ["AREA", "POINT", "SPOT"])
@pytest.mark.parametrize(("node", "output"), [("NewGeometry", "Parametric"), ("TexCoord", "Normal")])
def test_a9_lights_have_coordinates_of_their_own(
    node: str, output: str, kind: str, scene: bpy.types.Scene, tmp_path: Path
) -> None:
    """Regression: textures of lights used the coordinates of the world, or none."""
    if kind != "AREA" and output == "Parametric" and VERSION < (4, 0, 0):
        pytest.skip("before 4.0 Cycles had another order of parametric coordinates")
    bpy.ops.mesh.primitive_plane_add(size=4.0)
    data = bpy.data.lights.new("Light", kind)
    data.energy, data.use_nodes = 200.0, True
    if kind != "AREA":
        data.shadow_soft_size = 0.1
    graph = Graph(data)
    shown = graph("VectorMath", "Vector", {"Vector": graph(node, output)}, operation="MULTIPLY_ADD")
    for item, constant in zip(shown.node.inputs[1:3], (0.5, 0.6), strict=True):
        item.default_value = (constant,) * 3
    emission = next(item for item in graph.tree.nodes if item.bl_idname == "ShaderNodeEmission")
    graph.tree.links.new(shown, emission.inputs["Color"])
    light = bpy.data.objects.new("Light", data)
    light.location, light.rotation_euler = (0.4, -0.3, 1.5), (0.3, 0.2, 0.1)
    scene.collection.objects.link(light)
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    expected, found = pictures(scene, tmp_path)
    assert np.abs(expected).mean() > 0.05
    assert np.abs(expected.mean(axis=(0, 1)) / found.mean(axis=(0, 1)) - 1.0).max() < 0.03


LUMINAIRE = """IESNA:LM-63-1995
TILT=NONE
1 1000 1 5 3 1 2 0 0 0
1 1 50
0 15 30 60 90
0 90 180
1000 900 200 10 0
1000 700 400 50 0
1000 500 900 20 0
"""


@pytest.mark.parametrize("is_file", [False, True])
@pytest.mark.parametrize("kind", ["AREA", "POINT", "SPOT", "MESH"])
def test_a9_ies(kind: str, is_file: bool, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """An IES Texture in a turned light, and in the material of a turned mesh."""
    bpy.ops.mesh.primitive_plane_add(size=8.0)
    profile = bpy.data.texts.new("luminaire.ies")
    profile.write(LUMINAIRE)
    (tmp_path / "luminaire.ies").write_text(LUMINAIRE)
    place = {"location": (0.4, -0.3, 1.5), "rotation": (0.3, 0.2, 0.1)}
    if kind == "MESH":
        bpy.ops.mesh.primitive_plane_add(size=0.5, **place)
        block = new_material()
        bpy.context.object.data.materials.append(block)
    else:
        bpy.ops.object.light_add(type=kind, **place)
        block = bpy.context.object.data
        block.energy, block.use_nodes = 1.0, True
        if kind == "POINT":
            block.shadow_soft_size = 0.0
    graph = Graph(block)
    named = {"mode": "EXTERNAL", "filepath": str(tmp_path / "luminaire.ies")} if is_file else {"ies": profile}
    strength = graph("TexIES", "Fac", **named)
    if kind == "MESH":
        show(block, graph("Emission", "Emission", {"Strength": strength}))
    else:
        emission = next(item for item in graph.tree.nodes if item.bl_idname == "ShaderNodeEmission")
        graph.tree.links.new(strength, emission.inputs["Strength"])
    recording.add_camera(type="ORTHO", ortho_scale=8.0)
    expected, found = pictures(scene, tmp_path)
    assert np.abs(expected).mean() > 0.01
    assert np.abs(expected.mean(axis=(0, 1)) / found.mean(axis=(0, 1)) - 1.0).max() < 0.03
    assert np.abs(expected - found).mean() < 0.05 * expected.mean()


@pytest.mark.parametrize("output", ["Is Camera Ray", "Is Shadow Ray", "Is Singular Ray", "Ray Depth", "Is Diffuse Ray"])
def test_a9_light_path_of_sampled_emission(output: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """A surface lights a floor. What Cycles does not know of the rays that sample it is named, and all else agrees."""
    bpy.ops.mesh.primitive_plane_add(size=6.0)
    bpy.ops.mesh.primitive_plane_add(size=2.0, location=(0.3, 0.0, 1.0))
    material = new_material()
    bpy.context.object.data.materials.append(material)
    graph = Graph(material)
    strength = graph("Math", "Value", operation="MULTIPLY_ADD")
    graph.tree.links.new(graph("LightPath", output), strength.node.inputs[0])
    strength.node.inputs[1].default_value, strength.node.inputs[2].default_value = 2.0, 0.4
    show(material, graph("Emission", "Emission", {"Strength": strength}))
    recording.add_camera(type="ORTHO", ortho_scale=3.0)
    expected, found = pictures(scene, tmp_path, 64)
    agrees = found.mean() == pytest.approx(expected.mean(), rel=0.01)
    assert agrees != (output == "Is Diffuse Ray")


def test_a9_narrow_area_light(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: light that a spread limits to 5° was mostly lost at 16 samples."""
    bpy.ops.mesh.primitive_plane_add(size=4.0)
    bpy.ops.object.light_add(type="AREA", location=(0.0, 0.0, 3.0))
    data = bpy.context.object.data
    data.energy, data.spread, data.shape, data.size, data.size_y = 20.0, 0.09, "RECTANGLE", 1.5, 0.8
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    expected, found = pictures(scene, tmp_path)
    assert found.mean() == pytest.approx(expected.mean(), rel=0.02)
    assert np.abs(expected - found).mean() < 0.05 * expected.mean()


@pytest.mark.parametrize("scale", [(1.0, 2.0, 1.0), (0.5, 0.7, 2.0), (1.0, 1.0, 0.4)])
def test_a9_spots_scaled_unevenly(scale: tuple[float, ...], scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: the elliptical cone of a spot was rendered as a circular one."""
    bpy.ops.mesh.primitive_plane_add(size=6.0)
    bpy.ops.object.light_add(type="SPOT", location=(0.3, -0.2, 2.0), rotation=(0.3, 0.2, 0.4))
    spot = bpy.context.object
    spot.scale = scale
    spot.data.energy, spot.data.spot_size, spot.data.spot_blend, spot.data.shadow_soft_size = 200.0, 0.9, 0.4, 0.0
    recording.add_camera(type="ORTHO", ortho_scale=6.0)
    expected, found = pictures(scene, tmp_path)
    assert np.abs(expected).mean() > 0.005
    assert np.abs(expected - found).mean() < 0.02 * expected.mean()


@pytest.mark.parametrize("modifiers", [("WAVE", "SUBSURF"), ("SUBSURF", "WAVE"), ("MIRROR", "WAVE"), ("WAVE", "ARRAY")])
def test_a9_generated_coordinates_stick_to_what_deforms(
    modifiers: tuple[str, ...], scene: bpy.types.Scene, tmp_path: Path
) -> None:
    """Regression: with modifiers that add vertices, the coordinates were those of the deformed surface."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=3.0)
    obj = bpy.context.object
    for kind in modifiers:
        modifier = obj.modifiers.new(kind.title(), kind)
        if kind == "WAVE":
            modifier.height, modifier.width, modifier.time_offset = 1.0, 1.0, -40.0
    material = new_material()
    show(material, Graph(material)("TexCoord", "Generated"))
    obj.data.materials.append(material)
    camera = recording.add_camera()
    camera.location, camera.rotation_euler = (0.0, -6.0, 3.0), (1.1, 0.0, 0.0)
    expected, found = pictures(scene, tmp_path)
    assert np.abs(expected - found).mean() < 0.02 * expected.mean()


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "VERTEX_PAINT", "WEIGHT_PAINT", "TEXTURE_PAINT"])
def test_a9_the_mode_of_an_object_does_not_matter(mode: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: a mesh in Edit Mode was missing, or had lost its materials and UV map."""
    image = checker_image()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=3.0)
    obj = bpy.context.object
    for textured in (False, True):
        material = new_material()
        graph = Graph(material)
        show(material, graph("TexImage", "Color", image=image) if textured else graph("RGB", "Color"))
        obj.data.materials.append(material)
    for polygon in obj.data.polygons:
        polygon.material_index = polygon.index % 2
    obj.modifiers.new("Subsurf", "SUBSURF").show_in_editmode = False
    recording.add_camera().location = (0.0, 0.0, 6.0)
    bpy.ops.object.mode_set(mode=mode)
    if mode == "EDIT":
        bpy.ops.transform.translate(value=(0.7, 0.0, 0.0))
    expected, found = pictures(scene, tmp_path)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.abs(expected).mean() > 0.05
    assert np.abs(expected - found).mean() < 0.02 * expected.mean()
