"""Runs in a bare Debian: installs the zip like a user and renders with it. argv: ZIP PICTURE [install | render]."""

import sys

import bpy

ZIP, PICTURE, STEP = sys.argv[-3:]


def install() -> None:
    if hasattr(bpy.ops, "extensions") and bpy.app.version >= (4, 2, 0):
        bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
    else:
        bpy.ops.preferences.addon_install(filepath=ZIP)
        bpy.ops.preferences.addon_enable(module="gradus")
    bpy.ops.wm.save_userpref()


def render() -> None:
    """Renders Blender's default scene: a cube, a light and a camera."""
    scene = bpy.context.scene
    scene.render.engine = "GRADUS"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 54, 100
    scene.gradus.samples = 8
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = PICTURE
    bpy.ops.render.render(write_still=True)


def addon_names() -> list[str]:
    return [addon.module for addon in bpy.context.preferences.addons if addon.module.endswith("gradus")]


if STEP in ("install", "both"):
    install()
if STEP in ("render", "both"):
    render()
print("ADDONS", addon_names())
print(f"IN-BARE-ROOT-FINISHED {STEP}", flush=True)
