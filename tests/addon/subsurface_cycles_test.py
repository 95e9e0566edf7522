"""Subsurface scattering has the values and light passes of Cycles in the same Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images
from support.nodes import new_material, show, socket

VERSION = tuple(bpy.app.version)
SINCE_4 = VERSION >= (4, 0, 0)
SINCE_5_2 = VERSION >= (5, 2, 0)
COLOR = (0.8, 0.5, 0.3, 1.0)
RADIUS = (1.0, 0.5, 0.2)
# A radius of 1 is about 13 mean free paths, except in the walk that came with 5.2.
SCALE = 2.0
METHODS = [item.identifier for item in bpy.types.ShaderNodeSubsurfaceScattering.bl_rna.properties["falloff"].enum_items]


class Graph:
    """A shorthand for building the node tree of a material."""

    def __init__(self) -> None:
        self.material = new_material()
        self.tree = self.material.node_tree

    def __call__(self, kind: str, output: str, inputs: dict[str, Any], **properties: Any) -> bpy.types.NodeSocket:
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in inputs.items():
            target = socket(node.inputs, name)
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, target)
            else:
                target.default_value = value
        return socket(node.outputs, output)


def scale_of(method: str) -> float:
    return SCALE * 0.08 if SINCE_5_2 and method == "RANDOM_WALK" else SCALE


def scattering(graph: Graph, method: str = "RANDOM_WALK", **inputs: Any) -> bpy.types.NodeSocket:
    values = {"Color": COLOR, "Radius": RADIUS, "Scale": scale_of(method)} | inputs
    return graph("SubsurfaceScattering", "BSSRDF", values, falloff=method)


def principled(graph: Graph, method: str = "RANDOM_WALK", amount: float = 1.0, **inputs: Any) -> bpy.types.NodeSocket:
    if SINCE_4:
        values = {"Base Color": COLOR, "Subsurface Weight": amount, "Subsurface Radius": RADIUS}
        values["Subsurface Scale"] = scale_of(method)
    else:
        radius = tuple(SCALE * channel for channel in RADIUS)
        values = {"Base Color": COLOR, "Subsurface": amount, "Subsurface Radius": radius, "Subsurface Color": COLOR}
    return graph("BsdfPrincipled", "BSDF", values | inputs, subsurface_method=method)


def noise(graph: Graph, output: str) -> bpy.types.NodeSocket:
    place = graph("TexCoord", "Object", {})
    return graph("TexNoise", output, {"Vector": place, "Scale": 2.0})


def bumped(graph: Graph) -> bpy.types.NodeSocket:
    return graph("Bump", "Normal", {"Distance": 0.5, "Height": noise(graph, "Fac")})


def mixed(graph: Graph) -> bpy.types.NodeSocket:
    return graph("MixShader", "Shader", {"Shader": scattering(graph), "Shader_001": principled(graph, amount=0.0)})


CASES: dict[str, Callable[[Graph], bpy.types.NodeSocket]] = {
    **{f"node {method}": lambda g, method=method: scattering(g, method) for method in METHODS},
    **{f"principled {method}": lambda g, method=method: principled(g, method) for method in METHODS},
    "half": lambda g: principled(g, amount=0.5, Roughness=0.2),
    "anisotropic": lambda g: scattering(g, Anisotropy=0.7),
    "textured": lambda g: scattering(g, Color=noise(g, "Color"), Radius=noise(g, "Color")),
    "two channels": lambda g: scattering(g, Radius=(1.0, 0.5, 0.0)),
    "bump": lambda g: scattering(g, Normal=bumped(g)),
    # Regression: walks began so far below the surface that steps of this length could not leave again.
    "short steps": lambda g: scattering(g, Radius=(1.0, 0.2, 0.1), Scale=scale_of("RANDOM_WALK") / 400.0),
    "mixed": mixed,
}
if SINCE_4:
    CASES["smooth"] = lambda g: scattering(g, Roughness=0.1, IOR=1.8)
    CASES["skin of another index"] = lambda g: principled(g, "RANDOM_WALK_SKIN", **{"Subsurface IOR": 2.0})
if SINCE_5_2:
    CASES["backward"] = lambda g: scattering(g, Anisotropy=-0.5)
    CASES["backward, legacy"] = lambda g: scattering(g, "RANDOM_WALK_LEGACY", Anisotropy=-0.5)


@pytest.fixture(scope="module")
def stage() -> bpy.types.Scene:
    """Returns a scene with a smooth sphere and a box on a diffuse floor, in the light of a sun and a grey world."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    bpy.ops.mesh.primitive_uv_sphere_add(location=(-1.2, 0.0, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(1.2, 0.2, -0.1), rotation=(0.0, 0.0, 0.5))
    bpy.ops.mesh.primitive_plane_add(size=12.0, location=(0.0, 0.0, -1.05))
    bpy.context.object.name = "Floor"
    floor = Graph()
    show(floor.material, floor("BsdfDiffuse", "BSDF", {"Color": (0.4, 0.4, 0.4, 1.0)}))
    bpy.context.object.data.materials.append(floor.material)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0.6, 0.9, 0.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.5, -6.0, 1.5), (1.33, 0.0, 0.08)
    for item in (sun, camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.3)
    return scene


def use_material(scene: bpy.types.Scene, material: bpy.types.Material) -> None:
    for item in scene.objects:
        if item.type == "MESH" and item.name != "Floor":
            item.data.materials.clear()
            item.data.materials.append(material)


def passes_of(scene: bpy.types.Scene, folder: Path, engine: str, samples: int, **settings: Any) -> images.Passes:
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.sample_clamp_indirect, cycles.max_bounces, cycles.diffuse_bounces = 0.0, 4, 4
    cycles.blur_glossy = 0.0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    settings = {"integrator": "PATH", "reconstruction": "NONE"} | settings
    settings |= {"samples": samples, "pixel_filter": "BOX", "filter_width": 1.0}
    settings |= {"max_bounces": 4, "diffuse_bounces": 4}
    return images.render(scene, folder, **settings)


def blocks(image: np.ndarray) -> np.ndarray:
    """Returns means of blocks of 4×4 pixels."""
    return image.reshape(9, 4, 16, 4, 3).mean(axis=(1, 3))


def pass_of(passes: images.Passes, *names: str) -> np.ndarray:
    """Returns a pass, whose name changed in 5.0."""
    return next(passes[name] for name in names if name in passes)[..., :3]


def compare(expected: np.ndarray, found: np.ndarray, tolerance: float = 0.01) -> None:
    """Compares two noisy pictures, as a whole and by blocks."""
    expected, found = expected[..., :3], found[..., :3]
    scale = expected.mean(axis=(0, 1))
    assert scale.min() > 0.02
    error = np.abs(found.mean(axis=(0, 1)) / scale - 1.0)
    difference = np.abs(blocks(expected) - blocks(found)) / scale
    print(f"  mean off by {error}, blocks by {difference.mean():.4f}, at most {difference.max():.3f}")
    assert error.max() < tolerance
    assert difference.mean() < 0.03


@pytest.mark.parametrize("name", CASES)
def test_a9_subsurface(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    graph = Graph()
    show(graph.material, CASES[name](graph))
    use_material(stage, graph.material)
    expected, found = (passes_of(stage, tmp_path, engine, 256)["Combined"] for engine in ("CYCLES", "GRADUS"))
    # Before 4.0 Cycles darkens diffuse bumps by another formula.
    compare(expected, found, 0.02 if name == "bump" and not SINCE_4 else 0.01)


@pytest.mark.parametrize("amount", [1.0, 0.5])
def test_a9_light_passes_of_subsurface(amount: float, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Light that leaves an object is diffuse: direct at the first exit, indirect behind it."""
    graph = Graph()
    show(graph.material, principled(graph, amount=amount))
    use_material(stage, graph.material)
    layer = stage.view_layers[0]
    switches = ("use_pass_diffuse_direct", "use_pass_diffuse_indirect", "use_pass_diffuse_color")
    for name in switches:
        setattr(layer, name, True)
    expected, found = (passes_of(stage, tmp_path, engine, 256) for engine in ("CYCLES", "GRADUS"))
    for name in switches:
        setattr(layer, name, False)
    for names in (("DiffDir", "Diffuse Direct"), ("DiffInd", "Diffuse Indirect"), ("DiffCol", "Diffuse Color")):
        mean, value = pass_of(expected, *names).mean(axis=(0, 1)), pass_of(found, *names).mean(axis=(0, 1))
        print(f"  {names[1]}: {mean}, off by {value / mean - 1.0}")
        assert np.abs(value / mean - 1.0).max() < 0.02


@pytest.mark.parametrize("method", METHODS)
def test_b7_gradients_of_subsurface(method: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    """Gradient-domain path tracing has the mean of Cycles, with less noise than path tracing."""
    graph = Graph()
    show(graph.material, scattering(graph, method))
    use_material(stage, graph.material)
    expected = passes_of(stage, tmp_path, "CYCLES", 256)["Combined"][..., :3]
    plain = passes_of(stage, tmp_path, "GRADUS", 64)["Combined"][..., :3]
    found = passes_of(stage, tmp_path, "GRADUS", 64, integrator="GRADIENT", reconstruction="L2")["Combined"][..., :3]
    mean = expected.mean(axis=(0, 1))
    assert np.abs(found.mean(axis=(0, 1)) / mean - 1.0).max() < 0.015
    error, noise = (np.square(image - expected).mean() for image in (found, plain))
    print(f"  squared error {error:.3g} instead of {noise:.3g}")
    assert error < noise
