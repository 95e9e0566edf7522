"""Images of several tiles (UDIM) look as in Cycles of the same Blender, beside their tiles and with all projections."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from support import cycles, images, recording
from support.nodes import Graph, new_material, show


def tiled_image(folder: Path, numbers: tuple[int, ...]) -> bpy.types.Image:
    """Returns an image whose tiles have two colours each, on the left and on the right."""
    for number in numbers:
        tile = bpy.data.images.new("tile", 8, 8)
        pixels = np.ones((8, 8, 4), np.float32)
        pixels[..., 0], pixels[:, :4, 1], pixels[:, 4:, 1] = 0.2 * (number - 1000), 0.3, 0.8
        pixels[..., 2] = 0.9 if number > 1010 else 0.4
        tile.pixels.foreach_set(pixels.ravel())
        tile.filepath_raw, tile.file_format = str(folder / f"image.{number}.png"), "PNG"
        tile.save()
    image = bpy.data.images.load(str(folder / f"image.{numbers[0]}.png"))
    image.source = "TILED"
    assert {tile.number for tile in image.tiles} == set(numbers)
    return image


def show_tiles(scene: bpy.types.Scene, image: bpy.types.Image, corners: tuple[float, ...], **settings: str) -> None:
    """Fills the picture with a plane that shows the image between two corners (u, v, u, v)."""
    images.prepare(scene)
    material = new_material("Shown")
    graph = Graph(material)
    color = graph("TexImage", "Color", {"Vector": graph("TexCoord", "UV")}, image=image, interpolation="Closest")
    for name, value in settings.items():
        setattr(color.node, name, value)
    show(material, graph("Emission", "Emission", {"Color": color}))
    bpy.ops.mesh.primitive_plane_add(size=1.0)
    plane = bpy.context.object
    plane.scale = (64.0, 36.0, 1.0)
    plane.data.materials.append(material)
    low, high = np.array(corners, np.float32).reshape(2, 2)
    layer = plane.data.uv_layers[0].data
    places = np.empty((len(layer), 2), np.float32)
    layer.foreach_get("uv", places.ravel())
    layer.foreach_set("uv", (low + places * (high - low)).ravel())
    recording.add_camera(type="ORTHO", ortho_scale=64.0).location = (0.0, 0.0, 5.0)
    scene.world = bpy.data.worlds.new("World")


ALL = (1001, 1002, 1011)
CASES = {
    "inside": (ALL, (0.25, 0.25, 1.75, 1.75), {}),
    "left and below": (ALL, (-0.75, -0.5, 0.75, 0.5), {}),
    "left and below, clipped": (ALL, (-0.75, -0.5, 0.75, 0.5), {"extension": "CLIP"}),
    "left and below, extended": (ALL, (-0.75, -0.5, 0.75, 0.5), {"extension": "EXTEND"}),
    "farther left": (ALL, (-1.75, 0.25, 0.75, 1.75), {}),
    "sphere": (ALL, (0.0, 0.0, 2.0, 2.0), {"projection": "SPHERE"}),
    "tube": (ALL, (0.0, 0.0, 2.0, 2.0), {"projection": "TUBE"}),
    "one tile": ((1001,), (0.25, -0.5, 1.75, 1.75), {}),
    "another tile": ((1011,), (0.25, 0.25, 1.75, 1.75), {}),
    "box": (ALL, (-0.5, 0.0, 1.5, 1.5), {"projection": "BOX"}),
    "box without the first tile": ((1002, 1003), (0.25, 0.25, 2.75, 0.75), {"projection": "BOX"}),
}


@pytest.mark.parametrize("case", CASES)
def test_a9_tiles_agree(case: str, scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: coordinates below 0 missed the first tiles, and boxes had other tiles before Blender 5.2."""
    numbers, corners, settings = CASES[case]
    show_tiles(scene, tiled_image(tmp_path, numbers), corners, **settings)
    expected, found = cycles.pictures(scene, tmp_path, samples=16)
    np.testing.assert_allclose(found.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), atol=0.01)
    off = np.abs(found - expected).max(axis=-1) > 0.02
    assert off.mean() < 0.1, f"{off.mean():.0%} of the blocks, up to {np.abs(found - expected).max():.2f}"
