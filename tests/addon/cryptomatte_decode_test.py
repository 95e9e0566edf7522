"""Cryptomattes are decoded by Blender's compositor and by another program, as those of Cycles are."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import compositing, images, recording
from support.nodes import new_material, output_of

SIDE, SAMPLES = 64, 64
NAMES = ("Floor", "Half", "Veil ü", "Turning")  # of objects; each has a material of its own


def add_plane(name: str, size: float, place: tuple[float, float, float], alpha: float = 1.0) -> bpy.types.Object:
    surface = new_material(f"{name} surface")
    tree = surface.node_tree
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    principled.inputs["Alpha"].default_value = alpha
    tree.links.new(principled.outputs[0], output_of(surface).inputs["Surface"])
    mesh = recording.grid(1, size, name)
    mesh.materials.append(surface)
    return recording.add(mesh, name, place)


@pytest.fixture
def blurred(scene: bpy.types.Scene) -> bpy.types.Scene:
    """A scene with transparent planes, a plane that turns by 90 degrees a frame, and depth of field, in two layers."""
    camera = recording.add_camera(lens=50.0)
    camera.location.z = 6.0
    camera.data.dof.use_dof, camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = True, 3.0, 0.5
    render = scene.render
    render.resolution_x = render.resolution_y = SIDE
    render.use_motion_blur, render.motion_blur_shutter = True, 0.5
    add_plane("Floor", 3.0, (0, 0, 0))
    add_plane("Half", 1.0, (-0.7, 0.7, 0.5), 0.6)
    add_plane("Veil ü", 1.0, (0.7, 0.7, 0.5), 0.2)
    turning = add_plane("Turning", 1.2, (0.0, -0.6, 1.0))
    for frame, angle in ((0, 0.0), (2, np.pi)):
        turning.rotation_euler.z = angle
        turning.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_set(1)
    hidden = scene.view_layers.new("Without Half")
    folder = bpy.data.collections.new("Half alone")
    scene.collection.children.link(folder)
    half = bpy.data.objects["Half"]
    folder.objects.link(half)
    for collection in list(half.users_collection):
        if collection is not folder:
            collection.objects.unlink(half)
    hidden.layer_collection.children["Half alone"].exclude = True
    for layer in scene.view_layers:
        layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_material = True
        layer.pass_cryptomatte_depth = 6
    return scene


def choose_engine(scene: bpy.types.Scene, engine: str) -> None:
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = SAMPLES, False, False
    settings = scene.gradus
    settings.samples, settings.reconstruction, settings.integrator, settings.denoiser = SAMPLES, "NONE", "PATH", "NONE"


def assert_masks_agree(ours: np.ndarray, theirs: np.ndarray, name: str) -> None:
    assert theirs.mean() > 0.01, name
    assert np.abs(ours - theirs).mean() < 0.1 * theirs.mean(), name
    assert abs(ours.mean() / theirs.mean() - 1.0) < 0.02, name


def test_another_program_decodes_the_masks_of_cycles(blurred: bpy.types.Scene, tmp_path: Path) -> None:
    """Masks are compared by the names of layers and kinds."""
    cryptomatte_api = pytest.importorskip("cryptomatte_api", reason="is there for the Python of Blender 4.5 alone")
    masks = {}
    for engine in ("CYCLES", "GRADUS"):
        choose_engine(blurred, engine)
        images.use_exr(blurred, tmp_path / f"{engine}.exr")
        bpy.ops.render.render(write_still=True, scene=blurred.name)
        mattes = cryptomatte_api.Cryptomatte.load(str(tmp_path / f"{engine}.exr"))
        masks[engine] = {matte.metadata().name(): matte.masks() for matte in mattes}
    names = {f"{layer.name}.Crypto{kind}" for layer in blurred.view_layers for kind in ("Object", "Material")}
    assert set(masks["GRADUS"]) == set(masks["CYCLES"]) == names
    for matte in sorted(names):
        for name in (f"{obj} surface" if matte.endswith("Material") else obj for obj in NAMES):
            ours, theirs = masks["GRADUS"][matte].get(name), masks["CYCLES"][matte].get(name)
            if name.startswith("Half") and matte.startswith("Without"):
                assert ours is None or not ours.any(), matte
            else:
                assert ours is not None and theirs is not None, (matte, name)
                assert_masks_agree(ours, theirs, f"{matte} {name}")


def test_the_node_of_blender_decodes_the_masks_of_cycles(blurred: bpy.types.Scene, tmp_path: Path) -> None:
    tree, _, output = compositing.new_tree(blurred)
    node = tree.nodes.new("CompositorNodeCryptomatteV2")
    tree.links.new(node.outputs["Matte"], output)
    blurred.render.use_compositing = True
    mattes = {}
    for engine in ("CYCLES", "GRADUS"):
        choose_engine(blurred, engine)
        for name in NAMES:
            node.source, node.scene, node.layer_name = "RENDER", blurred, "ViewLayer.CryptoObject"
            node.matte_id = name
            mattes[engine, name] = images.render(blurred, tmp_path)["Composite.Combined"][..., 0]
    for name in NAMES:
        assert_masks_agree(mattes["GRADUS", name], mattes["CYCLES", name], name)
