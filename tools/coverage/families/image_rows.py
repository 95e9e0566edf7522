"""Rows of images: colour spaces, alpha modes, kinds of pixels, sources and file formats."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .. import rna, stages
from ..row import Family, Row

KINDS = {"8 bit": {}, "float": {"is_float": True}, "data": {"is_data": True}}


def rows() -> Iterator[Row]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    image = bpy.data.images.new("Probe", 4, 4)
    for name, settings in KINDS.items():
        family = Family("Images", f"Image {name}", partial(stage, settings))
        yield from family.rows((f".alpha_mode={value}", partial(_set, value)) for value in ALPHA_MODES)
        yield from family.rows(of_color_spaces(image))
    generated = Family("Images", "Image generated", stage_generated)
    yield from generated.rows(rna.changes(image, [name for name in rna.names(image) if "generated" not in name]))
    files = Family("Images", "Image file", partial(stage, {}))
    formats = rna.enum_values(bpy.context.scene.render.image_settings, "file_format")
    for kind in formats:
        if not rna.matches(kind, ("*MULTILAYER*", "AVI*", "FFMPEG")):
            for depth in depths(kind):
                yield files.row(f" {kind} {depth} bit", partial(load_file, kind, depth))
    yield files.row(" of several tiles", use_tiles)
    yield files.row(" missing", lose_file)


ALPHA_MODES = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")


def of_color_spaces(image: Any) -> Iterator[tuple[str, rna.Change]]:
    settings = image.colorspace_settings
    for value in rna.enum_values(settings, "name"):
        yield f".colorspace_settings.name={value}", partial(_set_space, value)


def _set(value: str, image: Any) -> None:
    image.alpha_mode = value


def _set_space(value: str, image: Any) -> None:
    image.colorspace_settings.name = value


def stage(settings: dict[str, Any]) -> Any:
    image = stages.pattern_image(**settings)
    show(image)
    return image


def show(image: Any) -> None:
    block = bpy.data.materials.new("Shown")
    tree, output = stages.empty_tree(block, "ShaderNodeOutputMaterial")
    texture, shader = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeEmission")
    texture.image = image
    place = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs["UV"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
    tree.links.new(texture.outputs["Alpha"], shader.inputs["Strength"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    stages.mesh("PLANE", block, scale=(2.4, 1.9, 1.0))
    stages.black_world()
    stages.camera((0.0, 0.0, 5.0), type="ORTHO", ortho_scale=5.0)


def stage_generated() -> Any:
    image = bpy.data.images.new("Generated", 24, 24, alpha=True)
    image.generated_color = (0.4, 0.6, 0.2, 0.7)
    show(image)
    return image


def depths(kind: str) -> list[str]:
    """Returns the depths of a file format that this Blender can write."""
    settings = bpy.context.scene.render.image_settings
    try:
        settings.file_format = kind
    except TypeError:
        return []
    found = []
    for depth in ("8", "10", "12", "16", "32"):
        try:
            settings.color_depth = depth
        except TypeError:
            continue
        found.append(depth)
    return found


def load_file(kind: str, depth: str, image: Any) -> None:
    """Replaces the image by a file of a format with the same pixels."""
    scene = bpy.context.scene
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_depth = kind, depth
    if kind not in {"JPEG", "BMP", "HDR", "CINEON"}:
        settings.color_mode = "RGBA"
    path = Path(tempfile.mkdtemp(prefix="gradus-coverage-")) / f"image.{kind.lower()}"
    image.save_render(str(path), scene=scene)
    replace(image, bpy.data.images.load(str(path)))


def replace(image: Any, other: Any) -> None:
    for material in bpy.data.materials:
        for node in material.node_tree.nodes:
            if getattr(node, "image", None) == image:
                node.image = other


def use_tiles(image: Any) -> None:
    folder = Path(tempfile.mkdtemp(prefix="gradus-coverage-"))
    for number in (1001, 1002):
        tile = bpy.data.images.new("tile", 8, 8)
        tile.pixels.foreach_set(np.tile(np.array([0.2, 0.5, number - 1001.0, 1.0], np.float32), 64))
        tile.filepath_raw, tile.file_format = str(folder / f"image.{number}.png"), "PNG"
        tile.save()
    other = bpy.data.images.load(str(folder / "image.1001.png"))
    other.source = "TILED"
    replace(image, other)


def lose_file(image: Any) -> None:
    other = bpy.data.images.new("lost", 4, 4)
    other.source, other.filepath = "FILE", "//there-is-no-such-file.png"
    replace(image, other)
