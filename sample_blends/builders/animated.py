"""Things that move: a short animation, and a still whose compositor uses the vectors."""

from __future__ import annotations

import math

import bpy

from . import boxes, common

FRAMES = 24


def _waving_flag(cloth: bpy.types.Material) -> None:
    """A strip that waves by a shape key: deformation, not a transform."""
    columns = 24
    vertices = [(0.05 * i, 0.0, 0.35 * j) for i in range(columns + 1) for j in (0, 1)]
    faces = [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(columns)]
    flag = common.mesh_object("Flag", vertices, faces, cloth, smooth=True)
    flag.location = (-1.15, 0.75, 1.1)
    flag.shape_key_add(name="Basis")
    wave = flag.shape_key_add(name="Wave")
    for index, point in enumerate(wave.data):
        column = index // 2
        point.co.y += 0.22 * math.sin(column * 0.55) * column / columns
    for frame, value in ((1, 0.0), (12, 1.0), (24, 0.0)):
        wave.value = value
        wave.keyframe_insert("value", frame=frame)


def _scene() -> None:
    scene = common.settings(640, 360)
    scene.frame_start, scene.frame_end = 1, FRAMES
    common.world((0.03, 0.035, 0.04), 1.0)
    white = common.diffuse("White", (0.7, 0.7, 0.68))
    walls = {
        "floor": white,
        "ceiling": white,
        "back": white,
        "left": common.diffuse("Left", (0.5, 0.2, 0.1)),
        "right": common.diffuse("Right", (0.1, 0.25, 0.45)),
    }
    boxes.room(3.2, 2.4, 2.0, walls)
    common.area_lamp("Key", (0.2, -0.2, 1.98), (0, 0, 0), (0.9, 0.6), 55.0, (1.0, 0.94, 0.86))
    ball = common.sphere("Ball", (-1.0, -0.35, 0.3), 0.3, common.principled("Ball", (0.8, 0.25, 0.1), 0.3))
    common.key(ball, "location", [(1, (-1.0, -0.35, 0.3)), (FRAMES, (0.9, -0.35, 0.3))])
    mirror = common.principled("Mirror", (0.95, 0.95, 0.95), 0.02, 1.0)
    block = common.box("Block", (0.75, 0.55, 0.5), (0.5, 0.5, 1.0), mirror)
    common.key(block, "rotation_euler", [(1, (0, 0, 0.2)), (FRAMES, (0, 0, 1.4))])
    _waving_flag(common.principled("Cloth", (0.15, 0.45, 0.3), 0.8))


def animated() -> None:
    """A rolling ball, a turning mirror, a waving flag; the camera moves along."""
    _scene()
    camera = common.camera((-0.3, -3.6, 1.1), (0, 0, 0.8), lens=32)
    common.key(camera, "location", [(1, (-0.3, -3.6, 1.1)), (FRAMES, (0.3, -3.5, 1.15))])


def compositor() -> None:
    """Vector Blur, Denoise and Mix over the render, and a background."""
    _scene()
    common.camera((0.0, -3.6, 1.1), (0, 0, 0.8), lens=32)
    scene = bpy.context.scene
    scene.frame_set(12)
    layer = scene.view_layers[0]
    layer.use_pass_vector = layer.use_pass_z = layer.use_pass_mist = True
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 2.5, 4.0
    for owner in (getattr(layer, "gradus", None), layer.cycles):
        for name in ("use_pass_denoising", "denoising_store_passes"):
            if hasattr(owner, name):
                setattr(owner, name, True)
    layer.update_render_passes()
    scene.use_nodes = True
    _compositing_tree(scene.node_tree)


def _compositing_tree(tree: bpy.types.NodeTree) -> None:
    """Render -> Denoise -> Vector Blur -> mix with a background by Mist -> Composite. By name: the order of sockets differs by version."""
    tree.nodes.clear()
    render = tree.nodes.new("CompositorNodeRLayers")
    denoise = tree.nodes.new("CompositorNodeDenoise")
    blur = tree.nodes.new("CompositorNodeVecBlur")
    blur.factor, blur.samples = 0.5, 32
    background = tree.nodes.new("CompositorNodeRGB")
    background.outputs[0].default_value = (0.25, 0.32, 0.45, 1.0)
    mix = tree.nodes.new("CompositorNodeMixRGB")
    output = tree.nodes.new("CompositorNodeComposite")
    links = [
        (render, "Image", denoise, "Image"),
        (render, "Denoising Normal", denoise, "Normal"),
        (render, "Denoising Albedo", denoise, "Albedo"),
        (denoise, "Image", blur, "Image"),
        (render, "Depth", blur, "Z"),
        (render, "Vector", blur, "Speed"),
    ]
    for source, out, target, into in links:
        if out in source.outputs and into in target.inputs:
            tree.links.new(source.outputs[out], target.inputs[into])
    tree.links.new(render.outputs["Mist"], mix.inputs[0])
    tree.links.new(blur.outputs["Image"], mix.inputs[1])
    tree.links.new(background.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs["Image"], output.inputs["Image"])
    for column, node in enumerate((render, denoise, blur, background, mix, output)):
        node.location = (220 * column, 0)
