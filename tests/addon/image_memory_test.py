"""Images of bytes stay bytes in memory, and files of tiles and lower resolutions are read as others are."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio
from support import images, recording
from support.memory import MEGABYTE
from support.nodes import Graph, new_material, show

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
from worker_process import peak_bytes, reset_peak  # noqa: E402

SIDE = 8192  # texels per side of the large image, which has 192 MB in bytes


def add_picture(scene: bpy.types.Scene, file: Path, count: int = 1) -> None:
    """Adds planes side by side that show a file, each by a material and an image of its own."""
    images.prepare(scene)
    recording.add_camera(type="ORTHO", ortho_scale=2.0 * count)
    for index in range(count):
        surface = new_material("Picture")
        graph = Graph(surface)
        show(surface, graph("TexImage", "Color", image=bpy.data.images.load(str(file))))
        mesh = recording.grid(1, 2.0, "Plane")
        mesh.materials.append(surface)
        recording.add(mesh, "Plane", (2.0 * index - (count - 1), 0.0, 0.0))


def blocks() -> oiio.ImageBuf:
    """Returns an image of 32×16 blocks of random colours."""
    colors = np.random.default_rng(1).random((16, 32, 3)).astype(np.float32)
    image = oiio.ImageBuf(oiio.ImageSpec(512, 256, 3, "uint8"))
    image.set_pixels(image.roi, np.kron(colors, np.ones((16, 16, 1), np.float32)))
    return image


def test_files_of_tiles_and_lower_resolutions_are_read(scene: bpy.types.Scene, tmp_path: Path) -> None:
    image = blocks()
    assert image.write(str(tmp_path / "blocks.png"))
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, image, str(tmp_path / "blocks.tx"))
    add_picture(scene, tmp_path / "blocks.png")
    settings = {"samples": 16, "reconstruction": "NONE", "integrator": "PATH"}
    expected = images.render(scene, tmp_path, **settings)["ViewLayer.Combined"]
    bpy.data.images["blocks.png"].filepath = str(tmp_path / "blocks.tx")
    found = images.render(scene, tmp_path, **settings)["ViewLayer.Combined"]
    assert expected[..., :3].std() > 0.1
    np.testing.assert_array_equal(found, expected)


def test_a_large_image_of_bytes_takes_its_bytes_once(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: each of two images of the same file took them."""
    file = tmp_path / "large.png"
    pixels = np.full((SIDE, SIDE, 3), 80, np.uint8)
    pixels[..., 0] = np.arange(SIDE) % 256
    image = oiio.ImageBuf(oiio.ImageSpec(SIDE, SIDE, 3, "uint8"))
    image.set_pixels(image.roi, pixels)
    assert image.write(str(file))
    del image, pixels
    add_picture(scene, file, count=2)
    reset_peak()
    before = peak_bytes()
    picture = images.render(scene, tmp_path, samples=4)["ViewLayer.Combined"]
    assert picture[..., 0].mean() > 0.1
    assert peak_bytes() - before < 300 * MEGABYTE
