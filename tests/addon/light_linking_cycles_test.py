"""Light and shadow linking light what Cycles lights in the same Blender, and shade it alike."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images
from support.nodes import Graph, shader_material, show, socket

if bpy.app.version < (4, 0, 0):
    pytest.skip("light linking came with 4.0", allow_module_level=True)


def material(kind: str, **inputs: Any) -> bpy.types.Material:
    return shader_material(kind, {"Color": (0.8, 0.8, 0.8, 1.0)} | inputs)


def half_transparent() -> bpy.types.Material:
    found = material("BsdfDiffuse")
    graph = Graph(found)
    diffuse = next(node for node in found.node_tree.nodes if node.bl_idname == "ShaderNodeBsdfDiffuse")
    clear = graph("BsdfTransparent", "BSDF", {"Color": (0.9, 0.5, 0.2, 1.0)})
    show(found, graph("MixShader", "Shader", {"Shader": diffuse.outputs[0], "Shader_001": clear}))
    return found


@pytest.fixture
def stage() -> bpy.types.Scene:
    """Returns a floor with a sphere, a cube and a glossy wall."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    for name, add, settings, look in (
        ("Ball", bpy.ops.mesh.primitive_uv_sphere_add, {"location": (-1.3, 0, 0)}, "BsdfDiffuse"),
        ("Cube", bpy.ops.mesh.primitive_cube_add, {"size": 1.4, "location": (1.2, 0.2, -0.3)}, "BsdfDiffuse"),
        ("Floor", bpy.ops.mesh.primitive_plane_add, {"size": 12.0, "location": (0, 0, -1.0)}, "BsdfDiffuse"),
        ("Wall", bpy.ops.mesh.primitive_plane_add, {"size": 5, "location": (0, 2, 0.5), "rotation": (1.4, 0, 0)}, ""),
    ):
        add(**settings)
        bpy.context.object.name = name
        gloss = material("BsdfDiffuse") if look else material("BsdfAnisotropic", Roughness=0.5)
        bpy.context.object.data.materials.append(gloss)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.3, -6.5, 2.5), (1.2, 0.0, 0.05)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.1, 0.1, 0.1)
    return scene


def lamp(scene: bpy.types.Scene, kind: str, **settings: Any) -> bpy.types.Object:
    data = bpy.data.lights.new("Lamp", kind)
    for name, value in {"energy": 4.0 if kind == "SUN" else 250.0, **settings}.items():
        setattr(data, name, value)
    obj = bpy.data.objects.new("Lamp", data)
    obj.location, obj.rotation_euler = (0.2, -0.5, 3.0), (0.3, 0.2, 0.0)
    scene.collection.objects.link(obj)
    return obj


def panel(strength: float = 12.0) -> bpy.types.Object:
    """Adds an emissive square above the objects."""
    bpy.ops.mesh.primitive_plane_add(size=1.2, location=(0.0, 0.3, 2.6), rotation=(0.2, 0.1, 0.0))
    bpy.context.object.data.materials.append(material("Emission", Strength=strength))
    return bpy.context.object


def roof(look: bpy.types.Material | None = None) -> bpy.types.Object:
    """Adds a plate between the light and the objects."""
    bpy.ops.mesh.primitive_plane_add(size=1.6, location=(0.6, 0.0, 1.4))
    bpy.context.object.name = "Roof"
    bpy.context.object.data.materials.append(look or material("BsdfDiffuse"))
    return bpy.context.object


def collection(*names: str, exclude: tuple[str, ...] = (), **children: tuple[str, ...]) -> bpy.types.Collection:
    """Returns a collection of objects, with child collections that it excludes if their name begins with "not_"."""
    made = bpy.data.collections.new("Linked")
    for name in names + exclude:
        made.objects.link(bpy.data.objects[name])
    for obj, entry in zip(made.objects, made.collection_objects, strict=True):
        entry.light_linking.link_state = "EXCLUDE" if obj.name in exclude else "INCLUDE"
    for name, members in children.items():
        child = bpy.data.collections.new(name)
        for member in members:
            child.objects.link(bpy.data.objects[member])
        made.children.link(child)
        made.collection_children[-1].light_linking.link_state = "EXCLUDE" if name.startswith("not_") else "INCLUDE"
    return made


def lights(emitter: bpy.types.Object, *names: str, **settings: Any) -> None:
    emitter.light_linking.receiver_collection = collection(*names, **settings)


def is_blocked_by(emitter: bpy.types.Object, *names: str, **settings: Any) -> None:
    emitter.light_linking.blocker_collection = collection(*names, **settings)


def instanced(scene: bpy.types.Scene) -> None:
    """Replaces the ball by an instance of a collection, whose instancer is linked in place of the ball."""
    ball, hidden = bpy.data.objects["Ball"], bpy.data.collections.new("Hidden")
    scene.collection.objects.unlink(ball)
    hidden.objects.link(ball)
    instancer = bpy.data.objects.new("Instancer", None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", hidden
    scene.collection.objects.link(instancer)
    lights(lamp(scene, "AREA", size=1.0), "Instancer")


def several(scene: bpy.types.Scene) -> None:
    """Adds lights with various links, among them some that share a collection."""
    shared = collection("Ball", "Floor")
    for place, color in (((-2.0, -1.0, 2.0), (1.0, 0.3, 0.3)), ((2.0, -1.0, 2.0), (0.3, 1.0, 0.3))):
        light = lamp(scene, "POINT", color=color, energy=120.0, shadow_soft_size=0.2)
        light.location, light.light_linking.receiver_collection = place, shared
    lights(lamp(scene, "SPOT", color=(0.4, 0.4, 1.0), spot_size=2.0), "Cube", "Wall")
    lamp(scene, "SUN", energy=0.5, angle=0.1)
    lights(panel(5.0), exclude=("Cube",))


def both(scene: bpy.types.Scene) -> None:
    roof()
    light = lamp(scene, "AREA", size=1.0)
    lights(light, exclude=("Cube",))
    is_blocked_by(light, "Cube", "Ball")


def on(kind: str, link: Callable[..., None], *names: str, **links: Any) -> Callable[[bpy.types.Scene], None]:
    """Returns a function that adds a roof and a linked light."""

    def build(scene: bpy.types.Scene) -> None:
        roof(half_transparent() if links.pop("transparent", False) else None)
        size = {"AREA": {"size": 1.0}, "SUN": {"angle": 0.3}, "POINT": {"shadow_soft_size": 0.3}}
        link(panel() if kind == "MESH" else lamp(scene, kind, **size[kind]), *names, **links)

    return build


def rough_glass(scene: bpy.types.Scene) -> None:
    """The ball does not block the light, but hides it from rays that BSDF sampling sends through it."""
    bpy.data.objects["Ball"].active_material = material("BsdfGlass", Roughness=0.3)
    light = lamp(scene, "AREA", size=1.0)
    lights(light, "Floor", "Ball")
    is_blocked_by(light, "Cube")


CASES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "receivers of an area light": on("AREA", lights, "Ball", "Wall"),
    "receivers of a sun": on("SUN", lights, "Cube", "Floor"),
    "receivers of a mesh": on("MESH", lights, "Cube", "Wall"),
    "excluded receivers": on("POINT", lights, exclude=("Floor", "Roof")),
    "no receivers": on("POINT", lights),
    "child collections": on("AREA", lights, "Ball", not_these=("Floor",), these=("Cube", "Wall")),
    "blockers of an area light": on("AREA", is_blocked_by, "Ball"),
    "blockers of a sun": on("SUN", is_blocked_by, "Cube"),
    "blockers of a point light": on("POINT", is_blocked_by, "Ball", "Floor"),
    "blockers of a mesh": on("MESH", is_blocked_by, "Ball", "Cube"),
    "excluded blockers": on("AREA", is_blocked_by, exclude=("Roof",)),
    "transparent blocker": on("AREA", is_blocked_by, "Roof", transparent=True),
    "transparent and no blocker": on("AREA", is_blocked_by, "Cube", transparent=True),
    "instancer": instanced,
    "several": several,
    "both": both,
    "rough glass": rough_glass,
}


def picture(scene: bpy.types.Scene, folder: Path, engine: str, bounces: int = 2, **settings: Any) -> np.ndarray:
    """Renders an image and returns means of blocks of 4×4 pixels."""
    samples = 128
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.sample_clamp_indirect, cycles.blur_glossy, cycles.max_bounces = 0.0, 0.0, bounces
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    settings = {"integrator": "PATH", "reconstruction": "NONE"} | settings
    settings |= {"samples": samples, "pixel_filter": "BOX", "filter_width": 1.0, "max_bounces": bounces}
    image = images.render(scene, folder, **settings)["Combined"][..., :3]
    return image.reshape(9, 4, 16, 4, 3).mean(axis=(1, 3))


def compare(expected: np.ndarray, found: np.ndarray) -> None:
    scale = expected.mean(axis=(0, 1))
    error = np.abs(found.mean(axis=(0, 1)) / scale - 1.0)
    difference = np.abs(expected - found) / scale
    print(f"  mean off by {error.max():.4f}, blocks by {difference.mean():.4f}, at most {difference.max():.3f}")
    assert error.max() < 0.01
    assert difference.mean() < 0.03


@pytest.mark.parametrize("name", CASES)
def test_light_linking(name: str, stage: bpy.types.Scene, tmp_path: Path) -> None:
    CASES[name](stage)
    compare(*(picture(stage, tmp_path, engine) for engine in ("CYCLES", "GRADUS")))


@pytest.mark.parametrize("kind", ["AREA", "MESH"])
def test_light_is_seen_in_a_mirror_behind_what_does_not_block_it(
    kind: str, stage: bpy.types.Scene, tmp_path: Path
) -> None:
    wall = bpy.data.objects["Wall"].active_material
    gloss = next(node for node in wall.node_tree.nodes if node.bl_idname == "ShaderNodeBsdfAnisotropic")
    socket(gloss.inputs, "Roughness").default_value = 0.0
    on(kind, is_blocked_by, "Ball")(stage)
    compare(*(picture(stage, tmp_path, engine, 0) for engine in ("CYCLES", "GRADUS")))
