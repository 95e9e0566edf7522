"""Images of which a pixel covers many texels look as in Cycles of the same Blender, which looks up single texels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import pytest
from support import cycles, images, recording
from support.nodes import Graph, new_material, show

# Half the side of the image in texels. The picture has 64×36 pixels, so that most look-ups have a lower resolution.
HALF = 256


def large_image(color_space: str = "sRGB") -> bpy.types.Image:
    """Fine stripes of strong contrast over soft waves, with an alpha that varies."""
    image = bpy.data.images.new("Large", 2 * HALF, 2 * HALF, alpha=True)
    y, x = np.mgrid[0 : 2 * HALF, 0 : 2 * HALF]
    pixels = np.empty((2 * HALF, 2 * HALF, 4), dtype=np.float32)
    pixels[..., 0] = x % 2
    pixels[..., 1] = 0.5 + 0.4 * np.sin(x / HALF * 9.0)
    pixels[..., 2] = 0.5 + 0.4 * np.cos(y / HALF * 7.0)
    pixels[..., 3] = np.where((x // 64 + y // 64) % 3 == 0, y % 2, 1)
    image.colorspace_settings.name = color_space  # first, because Blender then drops the pixels
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def scaled(graph: Graph, coordinates: str) -> bpy.types.NodeSocket:
    return graph("Mapping", "Vector", {"Vector": graph("TexCoord", coordinates), "Scale": (1.3, 1.3, 1.3)})


CASES: dict[str, Callable[[Graph], bpy.types.NodeSocket]] = {
    "colour": lambda g: g("TexImage", "Color", image=large_image()),
    "data": lambda g: g("TexImage", "Color", image=large_image("Non-Color")),
    "alpha": lambda g: g("TexImage", "Alpha", image=large_image()),
    "cubic": lambda g: g("TexImage", "Color", image=large_image(), interpolation="Cubic"),
    "scaled": lambda g: g("TexImage", "Color", {"Vector": scaled(g, "UV")}, image=large_image()),
    "generated": lambda g: g("TexImage", "Color", {"Vector": scaled(g, "Generated")}, image=large_image()),
    "box": lambda g: g(
        "TexImage",
        "Color",
        {"Vector": scaled(g, "Object")},
        image=large_image(),
        projection="BOX",
        projection_blend=0.2,
    ),
}


def build(scene: bpy.types.Scene, output: Callable[[Graph], bpy.types.NodeSocket]) -> None:
    """Makes a floor that shows the image, and a wall that shows its light."""
    images.prepare(scene)
    textured, white = new_material("Textured"), new_material("White")
    for material, color in ((textured, output), (white, None)):
        graph = Graph(material)
        inputs = {"Color": color(graph) if color else (0.8, 0.8, 0.8, 1.0)}
        show(material, graph("BsdfDiffuse", "BSDF", inputs))
    for shown, location, turn in ((textured, (0.0, 0.0, 0.0), 0.0), (white, (0.0, 2.0, 2.0), np.pi / 2)):
        bpy.ops.mesh.primitive_plane_add(size=4.0, location=location, rotation=(turn, 0.0, 0.0))
        bpy.context.object.data.materials.append(shown)
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.05, 0.05, 0.05)
    recording.add(bpy.data.lights.new("Light", "SUN"), "Light", (0.0, 0.0, 3.0)).rotation_euler = (0.3, 0.2, 0.0)
    camera = recording.add(bpy.data.cameras.new("Camera"), "Camera", (0.0, -6.0, 4.0))
    camera.rotation_euler = (1.0, 0.0, 0.0)
    scene.camera = camera


@pytest.mark.parametrize("case", CASES)
def test_a9_large_images_agree(case: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    build(scene, CASES[case])
    expected, found = cycles.pictures(scene, tmp_path, samples=256)
    assert expected[:4].std() > 0.05, "the image does not show"
    np.testing.assert_allclose(found.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=0.01)
    off = np.abs(found - expected) > 0.02 + 0.03 * expected
    assert off.mean() < 0.03, f"{off.mean():.3f} of the blocks, up to {np.abs(found - expected).max():.3f}"


def noise(scene: bpy.types.Scene, folder: Path) -> float:
    """Returns the root mean square difference of the red of two pictures of few samples."""
    red = [cycles.picture(scene, folder, "GRADUS", 4, seed=seed)[..., 0] for seed in (1, 2)]
    return float(np.sqrt(np.mean((red[0] - red[1]) ** 2)))


def test_a9_large_images_are_averaged_where_coordinates_are_known(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """A lower resolution removes the noise of the stripes. Behind other nodes images have their full resolution."""
    build(scene, CASES["colour"])
    averaged = noise(scene, tmp_path)
    tree = bpy.data.materials["Textured"].node_tree
    texture = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeTexImage")
    graph = Graph(bpy.data.materials["Textured"])
    same = graph("VectorMath", "Vector", {"Vector": graph("TexCoord", "UV")}, operation="ABSOLUTE")
    tree.links.new(same, texture.inputs["Vector"])
    assert averaged < 0.5 * noise(scene, tmp_path)
