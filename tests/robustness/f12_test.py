"""F12 in a window: the picture while it is rendered, and Escape."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from support import glow, window

pytestmark = pytest.mark.application


@pytest.fixture(autouse=True)
def tools() -> None:
    if not all(shutil.which(name) for name in ("Xvfb", "xdotool", "import")):
        pytest.skip("needs the packages of tools/setup/debian-window.txt")


def test_shows_the_picture() -> None:
    with window.blender(glow.SCENE.replace("SAMPLES", "8")) as blender:
        blender.wait_for("WINDOW-READY")
        assert max(glow.shares(blender.screenshot())) < 1e-4
        blender.press("F12")
        blender.wait_for("RENDER-COMPLETE")
        red, green = glow.wait_for_picture(blender)
        assert red > 3 * green  # the cube covers about an eighth of the frame
        assert "Error" not in blender.log


# A room around the camera, lit by a light: there is noise everywhere until the picture is reconstructed. The picture
# that Escape leaves is saved to a file.
ROOM = """
import bpy

scene = bpy.context.scene
scene.render.engine = "GRADUS"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 240, 100
scene.gradus.samples, scene.gradus.noise_threshold = 1000000, 0
bpy.ops.mesh.primitive_cube_add(size=30)
scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
scene.render.image_settings.color_depth = "32"
preferences = bpy.context.preferences.view
preferences.render_display_type, preferences.show_splash = "AREA", False

def save():
    bpy.data.images["Render Result"].save_render("FILE")
    print("SAVED", flush=True)

def cancelled(*_):
    bpy.app.timers.register(save, first_interval=0.5)

def ready():
    print("WINDOW-READY", flush=True)

bpy.app.handlers.render_init.append(lambda *_: print("RENDER-STARTED", flush=True))
bpy.app.handlers.render_cancel.append(cancelled)
bpy.app.timers.register(ready, first_interval=1.0)
"""


def roughness(path: Path, layer: str) -> float:
    """Returns the mean difference between neighbouring pixels, relative to the mean."""
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = np.asarray(image.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)
    green = pixels[..., list(spec.channelnames).index(f"ViewLayer.{layer}.G")]
    image.close()
    return float(np.abs(np.diff(green, axis=1)).mean() / green.mean())


def test_shows_a_reconstruction_while_it_samples(tmp_path: Path) -> None:
    result = tmp_path / "result.exr"
    with window.blender(ROOM.replace("FILE", str(result))) as blender:
        blender.wait_for("WINDOW-READY")
        blender.press("F12")
        blender.wait_for("RENDER-STARTED")
        time.sleep(6)  # some samples
        blender.press("Escape")
        blender.wait_for("SAVED", limit=10)
        assert "Error" not in blender.log
    assert roughness(result, "Combined") < 0.7 * roughness(result, "Noisy Image")


def test_grows_on_screen_and_escape_ends_it() -> None:
    with window.blender(glow.SCENE.replace("SAMPLES", "1000000")) as blender:
        blender.wait_for("WINDOW-READY")
        blender.press("F12")
        blender.wait_for("RENDER-STARTED")
        glow.wait_for_picture(blender)  # while it samples
        assert "RENDER-COMPLETE" not in blender.log
        blender.press("Escape")
        blender.wait_for("RENDER-CANCELLED", limit=3)
        glow.wait_for_picture(blender)  # the shown picture stays
