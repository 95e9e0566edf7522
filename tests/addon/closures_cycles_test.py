"""Closures have the values of Cycles in the same Blender.

A dome is lit by one sun without size and sampled at the centres of pixels, so that pictures show values of the closure
without noise.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from support import images
from support.nodes import Graph, new_material, show, socket

SUNS = {"front": (0.6, 0.4, 0.0), "side": (-0.3, -1.3, 0.0), "back": (math.pi - 0.3, 0.2, 0.0)}
SETTINGS = {
    "samples": 4,
    "integrator": "PATH",
    "reconstruction": "NONE",
    "pixel_filter": "BLACKMAN_HARRIS",
    "filter_width": 0.01,
    "max_bounces": 0,
}
VERSION = tuple(bpy.app.version)
GOLD = {"IOR": (0.2, 0.9, 1.5), "Extinction": (3.0, 2.4, 1.9)}
OLD_GLOSSY = "BsdfGlossy" if VERSION >= (4, 0, 0) else "BsdfAnisotropic"
TANGENT = "tangent of the node Tangent"


def glossy(distribution: str, roughness: float, anisotropy: float = 0.0, rotation: float = 0.0) -> tuple[Any, ...]:
    inputs = {"Color": (0.9, 0.6, 0.3, 1.0), "Roughness": roughness, "Anisotropy": anisotropy, "Rotation": rotation}
    if anisotropy:
        inputs["Tangent"] = TANGENT
    return (OLD_GLOSSY, inputs, {"distribution": distribution})


def toon(component: str, size: float, smooth: float) -> tuple[Any, ...]:
    inputs = {"Color": (0.9, 0.6, 0.3, 1.0), "Size": size, "Smooth": smooth}
    return ("BsdfToon", inputs, {"component": component})


def rough(kind: str, distribution: str, roughness: float, **inputs: Any) -> tuple[Any, ...]:
    return (kind, {"Roughness": roughness, **inputs}, {"distribution": distribution})


def velvet(sigma: float) -> tuple[Any, ...]:
    if VERSION >= (4, 0, 0):
        return ("BsdfSheen", {"Roughness": sigma}, {"distribution": "ASHIKHMIN"})
    return ("BsdfVelvet", {"Sigma": sigma}, {})


CASES: dict[str, tuple[Any, ...]] = {
    "diffuse": ("BsdfDiffuse", {}, {}),
    "ggx 0.5": glossy("GGX", 0.5),
    "toon": toon("DIFFUSE", 0.5, 0.0),
    "toon, smooth": toon("DIFFUSE", 0.3, 0.4),
    "toon beyond the horizon": toon("DIFFUSE", 0.8, 0.5),
    "glossy toon": toon("GLOSSY", 0.3, 0.0),
    "glossy toon, smooth": toon("GLOSSY", 0.1, 0.5),
    **{f"beckmann {r}": glossy("BECKMANN", r) for r in (0.2, 0.5, 0.8, 1.0)},
    **{f"beckmann 0.5, anisotropy {a}": glossy("BECKMANN", 0.5, a) for a in (-0.6, 0.4)},
    "beckmann 0.5, rotated": glossy("BECKMANN", 0.5, 0.5, 0.2),
    **{f"ashikhmin-shirley {r}": glossy("ASHIKHMIN_SHIRLEY", r) for r in (0.2, 0.5, 0.9, 1.0)},
    **{f"ashikhmin-shirley 0.5, anisotropy {a}": glossy("ASHIKHMIN_SHIRLEY", 0.5, a) for a in (-0.6, 0.4)},
    "ggx 0.9, anisotropy 0.7": glossy("GGX", 0.9, 0.7),
    **{f"beckmann refraction {r}": rough("BsdfRefraction", "BECKMANN", r, IOR=1.45) for r in (0.3, 0.6, 1.0)},
    **{f"beckmann glass {r}": rough("BsdfGlass", "BECKMANN", r, IOR=1.45) for r in (0.3, 0.6, 1.0)},
    **{f"velvet {s}": velvet(s) for s in (0.2, 0.5, 1.0)},
}
if VERSION >= (4, 0, 0):
    CASES |= {f"sheen {r}": rough("BsdfSheen", "MICROFIBER", r) for r in (0.3, 0.5, 0.75, 1.0)}
if hasattr(bpy.types, "ShaderNodeBsdfMetallic"):
    CASES |= {
        "beckmann metal": rough("BsdfMetallic", "BECKMANN", 0.5),
        **{
            f"conductor {r}": ("BsdfMetallic", {"Roughness": r, **GOLD}, {"fresnel_type": "PHYSICAL_CONDUCTOR"})
            for r in (0.2, 0.6, 1.0)
        },
        **{
            f"conductor {r} of small extinction": (
                "BsdfMetallic",
                {"Roughness": r, "IOR": (2.7, 2.2, 1.6), "Extinction": (0.5, 0.1, 0.0)},
                {"fresnel_type": "PHYSICAL_CONDUCTOR"},
            )
            for r in (0.3, 1.0)
        },
    }


def film(kind: str, thickness: float, properties: dict[str, Any] | None = None, **inputs: Any) -> tuple[Any, ...]:
    named = {name.replace("_", " "): value for name, value in inputs.items()}
    inputs = {"Roughness": 0.5, "Thin Film Thickness": thickness, "Thin Film IOR": 1.33, **named}
    return (kind, inputs, properties or {})


BLACK = (0.0, 0.0, 0.0, 1.0)
if VERSION >= (4, 2, 0):
    CASES |= {
        **{f"film of {t} nm": film("BsdfPrincipled", t, Base_Color=BLACK) for t in (10, 200, 450, 1500)},
        "film and tint": film("BsdfPrincipled", 350, Base_Color=BLACK, Specular_Tint=(0.3, 0.6, 0.9, 1.0)),
        "film of high index": film("BsdfPrincipled", 300, Base_Color=BLACK, Thin_Film_IOR=2.2),
        "film without a step below": film("BsdfPrincipled", 300, Base_Color=BLACK, IOR=1.0),
        "film over diffuse": film("BsdfPrincipled", 300),
        "film on principled glass": film("BsdfPrincipled", 400, Transmission_Weight=1.0),
        "film on principled metal": film("BsdfPrincipled", 400, Metallic=1.0, Base_Color=(0.9, 0.6, 0.3, 1.0)),
    }
if VERSION >= (5, 0, 0):
    CASES |= {
        **{f"film of {t} nm on glass": film("BsdfGlass", t) for t in (200, 450)},
        "film on beckmann glass": film("BsdfGlass", 300, {"distribution": "BECKMANN"}),
        **{f"film of {t} nm on metal": film("BsdfMetallic", t) for t in (200, 450, 1500)},
        **{
            f"film of {t} nm on a conductor": film("BsdfMetallic", t, {"fresnel_type": "PHYSICAL_CONDUCTOR"}, **GOLD)
            for t in (10, 200, 450)
        },
    }


@pytest.fixture(scope="module")
def dome() -> bpy.types.Scene:
    """Returns a scene with the front half of a smooth sphere, seen from the front, in a black world with a sun."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64)
    bpy.ops.object.shade_smooth()
    mesh = bpy.context.object.data
    mesh.transform(Matrix.Rotation(1.3, 4, "X"))  # no highlight at the poles, whose triangles are thin
    kept = [polygon for polygon in mesh.polygons if polygon.center.z > 0.0]
    faces = [tuple(polygon.vertices) for polygon in kept]
    half = bpy.data.meshes.new("Dome")
    half.from_pydata([vertex.co for vertex in mesh.vertices], [], faces)
    half.polygons.foreach_set("use_smooth", [True] * len(faces))
    bpy.context.object.data = half
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 3.6, (0.0, 0.0, 5.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.angle, sun.data.energy = 0.0, 1.0
    scene.collection.objects.link(sun)
    cycles = scene.cycles
    cycles.max_bounces, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 0, 4, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    for name, value in SETTINGS.items():
        setattr(scene.gradus, name, value)
    return scene


def pictures(scene: bpy.types.Scene, folder: Path, sun: str) -> tuple[np.ndarray, np.ndarray]:
    """Returns the picture of Cycles and that of Gradus."""
    scene.objects["Sun"].rotation_euler = SUNS[sun]
    found = []
    for engine in ("CYCLES", "GRADUS"):
        scene.render.engine = engine
        found.append(images.render(scene, folder)["Combined"][..., :3])
    return found[0], found[1]


def transmits(name: str) -> bool:
    return "refraction" in name or "glass" in name


def material_of(case: tuple[Any, ...]) -> bpy.types.Material:
    kind, inputs, properties = case
    material = new_material()
    graph = Graph(material)
    linked = {
        name: graph("Tangent", "Tangent", axis="Z") if value == TANGENT else value for name, value in inputs.items()
    }
    show(material, graph(kind, "BSDF", linked, **properties))
    return material


@pytest.mark.parametrize("sun", SUNS)
@pytest.mark.parametrize("name", CASES)
def test_a9_closure(name: str, sun: str, dome: bpy.types.Scene, tmp_path: Path) -> None:
    if (sun == "back" and not transmits(name)) or (sun != "back" and "refraction" in name):
        pytest.skip("no light comes from there")
    # Before 4.0 Cycles chooses one side of glass for each sample.
    dome.cycles.samples = 256 if VERSION < (4, 0, 0) and "glass" in name else 4
    mesh = next(item for item in dome.objects if item.type == "MESH")
    mesh.data.materials.clear()
    mesh.data.materials.append(material_of(CASES[name]))
    expected, found = pictures(dome, tmp_path, sun)
    difference = np.abs(expected - found)
    scale = expected.mean() + 1e-3
    mean = (found - expected).mean(axis=(0, 1)) / scale
    print(f"{name}, {sun}: mean {mean[np.abs(mean).argmax()]:+.4f}, differences {difference.mean() / scale:.4f}")
    assert expected.mean() > 5e-4
    assert difference.mean() / scale < 0.02
    assert np.abs(mean).max() < 0.015


BUMPED: dict[str, tuple[Any, ...]] = {
    "diffuse": CASES["diffuse"],
    "rough diffuse": ("BsdfDiffuse", {"Roughness": 0.7}, {}),
    "toon": CASES["toon"],
    "velvet": CASES["velvet 0.5"],
    "glossy": CASES["ggx 0.5"],
}


@pytest.mark.parametrize("sun", ["front", "side"])
@pytest.mark.parametrize("name", BUMPED)
def test_a9_closure_with_a_tilted_normal(name: str, sun: str, dome: bpy.types.Scene, tmp_path: Path) -> None:
    """Bumps darken where they face a light behind the surface, and mirror directions stay above it.

    Regression: Blender 3.4 had the bumps of Blender 4.5, which were 1 % brighter.
    """
    material = material_of(BUMPED[name])
    graph = Graph(material)
    closure = next(node for node in graph.tree.nodes if node.bl_idname.startswith("ShaderNodeBsdf"))
    tilted = graph("VectorMath", "Vector", {"Vector": graph("NewGeometry", "Normal")}, operation="ADD")
    tilted.node.inputs[1].default_value = (0.6, 0.3, 0.0)
    unit = graph("VectorMath", "Vector", {"Vector": tilted}, operation="NORMALIZE")
    graph.tree.links.new(unit, socket(closure.inputs, "Normal"))
    mesh = next(item for item in dome.objects if item.type == "MESH")
    mesh.data.materials.clear()
    mesh.data.materials.append(material)
    expected, found = pictures(dome, tmp_path, sun)
    scale = expected.mean() + 1e-3
    mean = (found - expected).mean(axis=(0, 1)) / scale
    print(f"tilted {name}, {sun}: mean {mean[np.abs(mean).argmax()]:+.4f}")
    assert expected.mean() > 5e-4
    assert np.abs(found - expected).mean() / scale < 0.01
    assert np.abs(mean).max() < 0.004


@pytest.fixture
def sheet(dome: bpy.types.Scene) -> Iterator[bpy.types.Scene]:
    """Returns the scene with a tilted sheet that fills the picture, in a white world."""
    shown = [item for item in dome.objects if item.type != "CAMERA"]
    for item in shown:
        item.hide_render = True
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    item = bpy.data.objects.new("Sheet", mesh)
    dome.collection.objects.link(item)
    dome.world = bpy.data.worlds.new("World")
    if VERSION < (5, 0, 0):
        dome.world.use_nodes = True
    background = next(node for node in dome.world.node_tree.nodes if node.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    dome.cycles.max_bounces = dome.gradus.max_bounces = 1
    dome.cycles.samples = dome.gradus.samples = 64
    yield dome
    dome.cycles.max_bounces = dome.gradus.max_bounces = 0
    dome.cycles.samples = dome.gradus.samples = 4
    dome.world = None
    bpy.data.objects.remove(item)
    for item in shown:
        item.hide_render = False


@pytest.mark.skipif(VERSION < (4, 0, 0), reason="before 4.0 multiple scattering is a walk between microfacets")
@pytest.mark.parametrize("tilt", [0.2, 1.0, math.pi - 0.2])
@pytest.mark.parametrize("roughness", [0.5, 0.8])
def test_a9_coloured_rough_glass(roughness: float, tilt: float, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: light between microfacets kept its colour, which was up to 20 % too bright."""
    item = sheet.objects["Sheet"]
    item.rotation_euler = (0.0, tilt, 0.0)
    case = rough("BsdfGlass", "MULTI_GGX", roughness, Color=(0.8, 0.3, 1.0, 1.0))
    item.data.materials.append(material_of(case))
    expected, found = (picture.mean(axis=(0, 1)) for picture in pictures(sheet, tmp_path, "front"))
    print(f"glass {roughness}, {tilt:.1f}: {found / expected - 1}")
    assert found == pytest.approx(expected, rel=0.012)


@pytest.mark.parametrize("name", ["toon, smooth", "glossy toon", "beckmann 0.5", "ashikhmin-shirley 0.5", "velvet 0.5"])
def test_a9_sampled_closure(name: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Light of the world, which is sampled by the closure, is that of Cycles."""
    if VERSION < (4, 2, 0) and name == "toon, smooth":
        pytest.skip("before 4.2 Cycles samples the edge with another brightness than it evaluates")
    item = sheet.objects["Sheet"]
    item.rotation_euler = (0.0, 0.8, 0.0)
    item.data.materials.append(material_of(CASES[name]))
    expected, found = (picture.mean(axis=(0, 1)) for picture in pictures(sheet, tmp_path, "front"))
    print(f"sampled {name}: {found / expected - 1}")
    assert found == pytest.approx(expected, rel=0.01)


@pytest.mark.skipif(VERSION >= (4, 0, 0), reason="from 4.0 on Cycles, too, scales the light of single bounces")
@pytest.mark.parametrize(("anisotropy", "tolerance"), [(0.0, 0.045), (0.5, 0.07)])
@pytest.mark.parametrize("tilt", [0.2, 1.0])
def test_a9_walks_between_microfacets(
    tilt: float, anisotropy: float, tolerance: float, sheet: bpy.types.Scene, tmp_path: Path
) -> None:
    """Regression: anisotropic surfaces were too dark. Cycles takes different colours for lights and for rays."""
    item = sheet.objects["Sheet"]
    item.rotation_euler = (0.0, tilt, 0.0)
    item.data.materials.append(material_of(glossy("MULTI_GGX", 0.6, anisotropy)))
    expected, found = (picture.mean(axis=(0, 1)) for picture in pictures(sheet, tmp_path, "front"))
    print(f"walk {anisotropy}, {tilt:.1f}: {found / expected - 1}")
    assert found == pytest.approx(expected, rel=tolerance)


@pytest.mark.skipif(VERSION < (4, 5, 0), reason="before 4.5 a coat loses what single scattering does")
@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX"])
@pytest.mark.parametrize("roughness", [0.6, 0.9])
def test_a9_rough_coat(roughness: float, distribution: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: surfaces below a rough coat were up to 5 % too dark."""
    item = sheet.objects["Sheet"]
    item.rotation_euler = (0.0, 0.4, 0.0)
    case = rough("BsdfPrincipled", distribution, 0.5, **{"Coat Weight": 1.0, "Coat Roughness": roughness})
    case[1]["Coat IOR"] = 1.7
    item.data.materials.append(material_of(case))
    expected, found = (picture.mean(axis=(0, 1)) for picture in pictures(sheet, tmp_path, "front"))
    print(f"coat {roughness}, {distribution}: {found / expected - 1}")
    assert found == pytest.approx(expected, rel=0.006)


COLOURED = {name: CASES[name] for name in ("ggx 0.5", "beckmann 0.8", "ashikhmin-shirley 0.5", "velvet 0.5")}
if VERSION >= (4, 0, 0):  # in 3.4, colours of Cycles are weights without Fresnel
    BASE = {"Base Color": (0.6, 0.3, 0.1, 1.0)}
    LAYERS = {
        "dielectric": {},
        "tint": {"Specular IOR Level": 0.9, "Specular Tint": (0.2, 0.5, 1.0, 1.0)},
        "metal": {"Metallic": 1.0},
        "coat": {"Coat Weight": 1.0, "Coat Roughness": 0.8},
        "glass": {"Transmission Weight": 1.0},
        "filmed": {"Thin Film Thickness": 400.0},
        "filmed glass": {"Thin Film Thickness": 400.0, "Transmission Weight": 1.0},
    }
    if VERSION < (4, 5, 0):
        del LAYERS["coat"]
    COLOURED |= {
        f"{distribution}, {layer}": rough("BsdfPrincipled", distribution, 0.8, **BASE, **inputs)
        for layer, inputs in LAYERS.items()
        for distribution in ("GGX", "MULTI_GGX")
    }
    COLOURED |= {f"{d} glass": rough("BsdfGlass", d, 0.8, Color=(0.6, 0.3, 0.1, 1.0)) for d in ("GGX", "MULTI_GGX")}
    COLOURED |= {f"{d} refraction": rough("BsdfRefraction", d, 0.8) for d in ("GGX", "BECKMANN")}
    COLOURED |= {name: case for name, case in CASES.items() if name in {"beckmann glass 1.0", "beckmann metal"}}
    COLOURED |= {name: case for name, case in CASES.items() if name in {"conductor 0.6", "film of 450 nm on metal"}}


# Before 5.2, Cycles estimates what rough glass transmits at flat angles from a smooth surface.
@pytest.mark.parametrize("tilt", [0.2, 0.8, 1.2] if VERSION >= (5, 2, 0) else [0.2, 0.8])
@pytest.mark.parametrize("name", COLOURED)
def test_a9_colour_of_a_closure(name: str, tilt: float, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: the colour passes of rough surfaces lacked what single scattering loses, up to 58 %."""
    item = sheet.objects["Sheet"]
    item.rotation_euler = (0.0, tilt, 0.0)
    item.data.materials.append(material_of(COLOURED[name]))
    layer = sheet.view_layers[0]
    switches = [f"use_pass_{kind}_color" for kind in ("diffuse", "glossy", "transmission")]
    for switch in switches:
        setattr(layer, switch, True)
    colors = []
    for engine in ("CYCLES", "GRADUS"):
        sheet.render.engine = engine
        passes = images.render(sheet, tmp_path)
        shown = [image for key, image in passes.items() if "." not in key and ("Col" in key)]
        colors.append(np.concatenate([image[..., :3] for image in shown], axis=2).mean(axis=(0, 1)))
    for switch in switches:
        setattr(layer, switch, False)
    print(f"colour of {name}: {colors}")
    assert colors[0].max() > 0.1
    assert colors[1] == pytest.approx(colors[0], rel=0.04 if tilt > 1.0 else 0.015, abs=1e-3)


SHIFTED = (
    "diffuse",
    "glossy toon, smooth",
    "beckmann 0.2",
    "beckmann glass 0.3",
    "ashikhmin-shirley 0.2",
    "velvet 0.5",
)


@pytest.mark.parametrize("name", [*SHIFTED, *(("film on principled glass",) if VERSION >= (4, 2, 0) else ())])
def test_a6_gradients_of_closures_are_unbiased(name: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Offset paths evaluate the closure as base paths do: gradients rebuild the picture of plain paths."""
    item = sheet.objects["Sheet"]
    item.rotation_euler = (0.0, 0.6, 0.0)
    material = material_of(CASES[name])
    graph = Graph(material)
    surface = next(node for node in graph.tree.nodes if node.bl_idname.startswith("ShaderNodeBsdf"))
    bump = graph("Bump", "Normal", {"Distance": 3.0, "Height": graph("TexNoise", "Fac", {"Scale": 3.0})})
    graph.tree.links.new(bump, socket(surface.inputs, "Normal"))
    item.data.materials.append(material)
    background = next(node for node in sheet.world.node_tree.nodes if node.bl_idname == "ShaderNodeBackground")
    graph = Graph(sheet.world)
    graph.tree.links.new(
        graph("TexGradient", "Color", {"Vector": graph("TexCoord", "Generated")}), background.inputs[0]
    )
    sheet.render.engine = "GRADUS"
    plain, gradients = (
        images.render(sheet, tmp_path, samples=64, integrator=integrator, reconstruction=reconstruction)["Combined"]
        for integrator, reconstruction in (("PATH", "NONE"), ("GRADIENT", "L2"))
    )
    for name, value in SETTINGS.items():
        setattr(sheet.gradus, name, value)
    expected, found = (picture[..., 0].reshape(9, 4, 16, 4).mean(axis=(1, 3)) for picture in (plain, gradients))
    print(f"gradients: {np.abs(found - expected).mean() / expected.std():.4f}, {expected.std() / expected.mean():.3f}")
    assert expected.std() > 0.05 * expected.mean()
    assert np.abs(found - expected).mean() < 0.2 * expected.std()
