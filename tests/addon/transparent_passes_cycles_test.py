"""Passes of partly transparent surfaces agree with Cycles in the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import cycles, images
from support.nodes import Graph, new_material, shader_material, show

# Names of each pass: until Blender 4.5 and since 5.0, and of the property that adds it.
PASSES = {
    ("Mist", "Mist"): "use_pass_mist",
    ("AO", "Ambient Occlusion"): "use_pass_ambient_occlusion",
    ("DiffCol", "Diffuse Color"): "use_pass_diffuse_color",
}


def add_plane(location: tuple[float, float, float], size: float, opacity: float) -> None:
    """Adds an upright plane that is diffuse, and lets a part of the light pass in another colour."""
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=(np.pi / 2, 0.0, 0.0))
    material = new_material()
    graph = Graph(material)
    clear = graph("BsdfTransparent", "BSDF", {"Color": (0.9, 0.7, 0.4, 1.0)})
    matte = graph("BsdfDiffuse", "BSDF", {"Color": (0.3, 0.5, 0.8, 1.0)})
    show(material, graph("MixShader", "Shader", {"Fac": opacity, "Shader": clear, "Shader_001": matte}))
    bpy.context.object.data.materials.append(material)


@pytest.fixture
def sheets() -> bpy.types.Scene:
    """Returns a scene with two sheets, one before the other, above an opaque floor and in front of the sky."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    add_plane((-1.0, 0.0, 0.0), 4.0, 0.4)
    add_plane((1.0, 2.0, 0.5), 4.0, 0.8)
    bpy.ops.mesh.primitive_plane_add(size=20.0, location=(0.0, 0.0, -2.0))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -9.0, 0.0), (np.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.light_settings.distance = 3.0
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 5.0, 12.0
    for name in PASSES.values():
        setattr(bpy.context.view_layer, name, True)
    return scene


def picture_of(scene: bpy.types.Scene, folder: Path, engine: str, names: tuple[str, str]) -> np.ndarray:
    """Renders a pass and returns means of blocks of 4×4 pixels."""
    passes = cycles.passes(scene, folder, engine, 64)
    return cycles.blocks(next(passes[name] for name in names if name in passes)[..., :3])


@pytest.mark.parametrize("names", PASSES)
def test_passes_of_sheets_are_those_of_cycles(sheets: bpy.types.Scene, tmp_path: Path, names: tuple[str, str]) -> None:
    """Mist was negative and ambient occlusion above 1: the chance to pass a sheet was counted, its opacity was not."""
    expected, found = (picture_of(sheets, tmp_path, engine, names) for engine in ("CYCLES", "GRADUS"))
    assert expected.max() > expected.min() + 0.2
    np.testing.assert_allclose(found, expected, atol=0.05)
    np.testing.assert_allclose(found.mean(), expected.mean(), rtol=0.01)


def add_clear_sheet(color: tuple[float, float, float]) -> None:
    """Adds a sheet of a coloured Transparent BSDF in front of everything."""
    bpy.ops.mesh.primitive_plane_add(size=3.0, location=(0.3, -2.0, 0.2), rotation=(np.pi / 2, 0.0, 0.0))
    bpy.context.object.data.materials.append(shader_material("BsdfTransparent", {"Color": (*color, 1.0)}))


def add_glass_ball(scene: bpy.types.Scene) -> None:
    """Adds a ball of clear glass, behind which passes of data go on."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.0, location=(0.5, -2.0, 0.0))
    bpy.context.object.data.materials.append(shader_material("BsdfGlass", {"Roughness": 0.0, "IOR": 1.3}))
    scene.render.film_transparent = scene.cycles.film_transparent_glass = True


def add_dark_sheets(scene: bpy.types.Scene) -> None:
    """Adds more transparent sheets than a path may pass."""
    add_clear_sheet((0.9, 0.7, 0.8))
    scene.cycles.transparent_max_bounces = 2


def hold_out(_scene: bpy.types.Scene) -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(0.5, -2.0, 0.0))
    bpy.context.object.is_holdout = True


def hold_out_sheet(_scene: bpy.types.Scene) -> None:
    bpy.data.objects["Plane"].is_holdout = True


def catch_shadows(_scene: bpy.types.Scene) -> None:
    bpy.data.objects["Plane.002"].is_shadow_catcher = True


CHANGES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "clear sheet": lambda scene: add_clear_sheet((0.3, 0.9, 0.4)),
    "dark clear sheet": lambda scene: add_clear_sheet((0.1, 0.1, 0.1)),
    "limit of transparent surfaces": add_dark_sheets,
    "transparent glass": add_glass_ball,
    "held out": hold_out,
    "held out sheet": hold_out_sheet,
    "caught shadows": catch_shadows,
}


@pytest.mark.parametrize("name", [name for name in CHANGES if name != "held out sheet"])
def test_passes_behind_clear_surfaces(sheets: bpy.types.Scene, tmp_path: Path, name: str) -> None:
    """Mist and ambient occlusion left out surfaces that a path passed, and passes of data ended at clear glass."""
    if name == "caught shadows" and bpy.app.version < (4, 0, 0):
        pytest.skip("Cycles 3.4 counts shadow catchers twice in these passes")
    CHANGES[name](sheets)
    passes = [cycles.passes(sheets, tmp_path, engine, 64) for engine in ("CYCLES", "GRADUS")]
    for names in PASSES:
        expected, found = (cycles.blocks(next(p[key] for key in names if key in p)[..., :3]) for p in passes)
        print(f"  {names[0]}: mean {expected.mean():.4f} off by {abs(found.mean() - expected.mean()):.4f}")
        assert np.abs(found - expected).mean() < 0.01, names[0]
        np.testing.assert_allclose(found.mean(), expected.mean(), rtol=0.015, err_msg=names[0])


# Passes that show one surface of a pixel: names until Blender 4.5 and since 5.0, and the property that adds it.
SINGLE = {
    ("Depth", "Depth"): "use_pass_z",
    ("Position", "Position"): "use_pass_position",
    ("Normal", "Normal"): "use_pass_normal",
    ("UV", "UV"): "use_pass_uv",
    ("IndexOB", "Object Index"): "use_pass_object_index",
    ("IndexMA", "Material Index"): "use_pass_material_index",
}


@pytest.mark.parametrize("threshold", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("name", ["as they are", "clear sheet", "held out", "held out sheet", "transparent glass"])
def test_single_surfaces(sheets: bpy.types.Scene, tmp_path: Path, name: str, threshold: float) -> None:
    """Position added up the surfaces that a path passed, and a clear surface remained in front of the world.

    A pixel keeps what its first sample shows, which passes surfaces at random: the values that pixels have must agree,
    and their shares of the pixels.
    """
    CHANGES.get(name, lambda scene: None)(sheets)
    bpy.context.view_layer.pass_alpha_threshold = threshold
    for index, shape in enumerate(bpy.context.scene.objects):
        shape.pass_index = index + 1
        if shape.type == "MESH" and shape.data.materials:
            shape.data.materials[0].pass_index = 2 * index + 1
    for switch in SINGLE.values():
        setattr(bpy.context.view_layer, switch, True)
    passes = [cycles.passes(sheets, tmp_path, engine, 16) for engine in ("CYCLES", "GRADUS")]
    for names in SINGLE:
        expected, found = (np.minimum(next(p[key] for key in names if key in p), 40.0) for p in passes)
        print(f"  {names[0]}: means {expected.mean(axis=(0, 1)).round(3)} and {found.mean(axis=(0, 1)).round(3)}")
        spread = max(float(expected.std()), 0.05)
        assert np.abs(expected.mean(axis=(0, 1)) - found.mean(axis=(0, 1))).max() < 0.07 * spread, names[0]


def shares(passes: dict[str, np.ndarray]) -> dict[float, float]:
    """Returns the mean weight of each identifier of the Cryptomatte of objects."""
    found: dict[float, float] = {}
    for name, image in passes.items():
        if "." in name or not name.startswith("CryptoObject"):
            continue
        for rank in (0, 2):
            for identifier in np.unique(image[..., rank]):
                weight = float(image[..., rank + 1][image[..., rank] == identifier].sum())
                found[float(identifier)] = found.get(float(identifier), 0.0) + weight / image[..., 0].size
    return {identifier: weight for identifier, weight in found.items() if weight > 0.001}


@pytest.mark.parametrize("name", ["transparent glass", "held out", "limit of transparent surfaces"])
def test_cryptomatte(sheets: bpy.types.Scene, tmp_path: Path, name: str) -> None:
    """Cryptomatte ended at clear glass, and went on behind the limit of transparent surfaces."""
    CHANGES[name](sheets)
    bpy.context.view_layer.use_pass_cryptomatte_object = True
    expected, found = (shares(cycles.passes(sheets, tmp_path, engine, 64)) for engine in ("CYCLES", "GRADUS"))
    print(f"  {expected}, found {found}")
    assert expected.keys() == found.keys()
    for identifier, weight in expected.items():
        assert abs(found[identifier] - weight) < 0.01
