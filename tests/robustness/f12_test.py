"""What a user does first: F12 in a window, a look at the picture that grows there, and Escape."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from support import window

pytestmark = pytest.mark.application

# A green, glowing cube before a red world: no other part of Blender's window has these colours.
SCENE = """
import bpy

def emission(tree, kind, color):
    tree.nodes.clear()
    shader = tree.nodes.new(kind)
    shader.inputs["Color"].default_value = color
    output = tree.nodes.new("ShaderNodeOutputWorld" if kind == "ShaderNodeBackground" else "ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])

scene = bpy.context.scene
scene.render.engine = "GRADUS"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 240, 100
scene.view_settings.view_transform = "Standard"
scene.gradus.samples = SAMPLES
scene.gradus.noise_threshold = 0
scene.world.use_nodes = True
emission(scene.world.node_tree, "ShaderNodeBackground", (1, 0, 0, 1))
material = bpy.data.materials.new("glow")
material.use_nodes = True
emission(material.node_tree, "ShaderNodeEmission", (0, 1, 0, 1))
bpy.data.objects["Cube"].data.materials.clear()
bpy.data.objects["Cube"].data.materials.append(material)
preferences = bpy.context.preferences.view
preferences.render_display_type, preferences.show_splash = "AREA", False

def tell(text):
    def handler(*_):
        print(text, flush=True)
    return handler

bpy.app.handlers.render_init.append(tell("RENDER-STARTED"))
bpy.app.handlers.render_complete.append(tell("RENDER-COMPLETE"))
bpy.app.handlers.render_cancel.append(tell("RENDER-CANCELLED"))
bpy.app.timers.register(tell("WINDOW-READY"), first_interval=1.0)
"""


@pytest.fixture(autouse=True)
def tools() -> None:
    if not all(shutil.which(name) for name in ("Xvfb", "xdotool", "import")):
        pytest.skip("needs the packages of tools/setup/debian-window.txt")


def shares(path: Path) -> tuple[float, float]:
    """Shares of the screen that are pure red and pure green."""
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = np.asarray(image.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)[..., :3]
    image.close()
    red = (pixels[..., 0] > 0.9) & (pixels[..., 1] < 0.1) & (pixels[..., 2] < 0.1)
    green = (pixels[..., 1] > 0.9) & (pixels[..., 0] < 0.1) & (pixels[..., 2] < 0.1)
    return float(red.mean()), float(green.mean())


def wait_for_picture(blender: window.Window) -> tuple[float, float]:
    """The window shows the result soon after the render has ended, or while it goes on."""
    for _ in range(40):
        red, green = shares(blender.screenshot())
        if red > 0.02 and green > 0.002:
            return red, green
    raise AssertionError(f"no picture on the screen: red {red:.4f}, green {green:.4f}\n{blender.log}")


def test_shows_the_picture() -> None:
    with window.blender(SCENE.replace("SAMPLES", "8")) as blender:
        blender.wait_for("WINDOW-READY")
        assert max(shares(blender.screenshot())) < 1e-4
        blender.press("F12")
        blender.wait_for("RENDER-COMPLETE")
        red, green = wait_for_picture(blender)
        assert red > 3 * green  # the cube covers about an eighth of the frame
        assert "Error" not in blender.log


# A room around the camera, lit by a lamp: noise everywhere, until it is reconstructed. What Escape leaves becomes a file.
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
    """Mean difference between neighbours, relative to the mean."""
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
    with window.blender(SCENE.replace("SAMPLES", "1000000")) as blender:
        blender.wait_for("WINDOW-READY")
        blender.press("F12")
        blender.wait_for("RENDER-STARTED")
        wait_for_picture(blender)  # while it samples
        assert "RENDER-COMPLETE" not in blender.log
        blender.press("Escape")
        blender.wait_for("RENDER-CANCELLED", limit=3)
        wait_for_picture(blender)  # what there was stays
