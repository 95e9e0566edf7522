"""L2: a file gives the same bits in other processes and folders, and for other hash seeds.

The order of objects changes only the noise.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import images
from support.application import Outcome

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "sample_blends" / "glass_and_chrome.blend"
SMALL = """
import bpy
render = bpy.context.scene.render
render.resolution_x, render.resolution_y, render.resolution_percentage = 64, 36, 100
render.image_settings.color_depth = "32"
render.image_settings.exr_codec = "ZIP"
"""


@pytest.mark.parametrize("integrator", ["PATH", "GRADIENT"])
def test_l2_runs_in_other_processes_and_folders_have_the_same_bits(
    blender: Callable[..., Outcome], tmp_path: Path, integrator: str
) -> None:
    found = []
    for name, seed in (("one", "1"), ("two folders deep/other", "2")):
        folder = tmp_path / name
        folder.mkdir(parents=True)
        copy = folder / "scene.blend"
        copy.write_bytes(SAMPLE.read_bytes())
        head = ["--python-use-system-env", "--addons", "gradus", str(copy), "-E", "GRADUS", "--python-expr", SMALL]
        tail = [
            "-o",
            f"{folder}/f_####",
            "-F",
            "OPEN_EXR",
            "-f",
            "1",
            "--",
            "--gradus-samples",
            "4",
            "--gradus-integrator",
            integrator,
        ]
        outcome = blender(*head, *tail, env={"PYTHONHASHSEED": seed})
        assert outcome.code == 0, outcome.output
        found.append(images.read(folder / "f_0001.exr"))
    assert found[0].keys() == found[1].keys()
    assert all(np.array_equal(found[0][key], found[1][key], equal_nan=True) for key in found[0])


def _still(scene: bpy.types.Scene, order: list[int]) -> None:
    """Adds three emissive and three grey cubes in a row under a light, in the given order."""
    for index in order:
        bpy.ops.mesh.primitive_cube_add(size=0.8, location=(index - 2.5, 0.0, 0.0))
        cube = bpy.context.object
        material = bpy.data.materials.new(f"M{index}")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        shader = tree.nodes.new("ShaderNodeEmission" if index % 2 else "ShaderNodeBsdfDiffuse")
        tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        cube.data.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -7.0, 2.0), (1.3, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT"))
    light.location, light.data.energy, light.data.shadow_soft_size = (0.0, -3.0, 3.0), 100.0, 0.3
    scene.collection.objects.link(light)


def test_l2_the_order_of_objects_changes_the_noise_alone(tmp_path: Path) -> None:
    seeds = 8
    runs = []
    for order in ([0, 1, 2, 3, 4, 5], [4, 1, 5, 0, 3, 2]):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        scene = bpy.context.scene
        images.prepare(scene)
        _still(scene, order)
        settings = {"samples": 16, "integrator": "PATH", "reconstruction": "NONE"}
        pictures = [images.render(scene, tmp_path, seed=seed, **settings)["Combined"][..., :3] for seed in range(seeds)]
        runs.append(np.stack(pictures).reshape(seeds, 9, 4, 16, 4, 3).mean(axis=(2, 4)))
    difference = runs[0].mean(axis=0) - runs[1].mean(axis=0)
    error = np.sqrt(sum(run.var(axis=0, ddof=1) for run in runs) / seeds)
    lit = error > 1e-6
    assert lit.mean() > 0.3
    # Student's t with 14 degrees of freedom has a variance of 14 / 12; equal bits are right, too.
    assert np.mean((difference[lit] / error[lit]) ** 2) < 1.5 * 14 / 12
    assert np.abs(difference[~lit]).max() < 1e-5
