"""A picture with colours that nothing else on the screen has, for tests that read Blender's window."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from support import window

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


LIMIT = 20.0
"""Seconds within which the window shows a picture."""


def shares(path: Path) -> tuple[float, float]:
    """Returns the shares of the screen that are pure red and pure green."""
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = np.asarray(image.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)[..., :3]
    image.close()
    red = (pixels[..., 0] > 0.9) & (pixels[..., 1] < 0.1) & (pixels[..., 2] < 0.1)
    green = (pixels[..., 1] > 0.9) & (pixels[..., 0] < 0.1) & (pixels[..., 2] < 0.1)
    return float(red.mean()), float(green.mean())


def wait_for_picture(blender: window.Window) -> tuple[float, float]:
    """Waits until the window shows the result, during the render or soon after it."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        red, green = shares(blender.screenshot())
        if red > 0.02 and green > 0.002:
            return red, green
        time.sleep(0.1)
    raise AssertionError(f"no picture on the screen: red {red:.4f}, green {green:.4f}\n{blender.log}")
