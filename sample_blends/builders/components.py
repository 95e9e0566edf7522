"""A picture in parts: an animation with a rolling mirror ball, glass and a moving lamp, and a compositor that works on its components."""

from __future__ import annotations

import bpy

from . import boxes, common

FRAMES = 24
COMPONENTS = ("Emission", "Diffuse", "Reflection", "Transmission", "Residual")
WARM = (1.6, 0.9, 0.5, 1.0)
"""By which the compositor grades the reflection."""


def _tiles(u: float, v: float) -> common.Color:
    """Tiles of two colours with dark joints, each a little different: what moves over them is seen to move."""
    column, row = int(u * 8), int(v * 8)
    if min(u * 8 - column, v * 8 - row) < 0.06:
        return 0.16, 0.15, 0.14
    shade = 0.05 * ((column * 7 + row * 13) % 5)
    return (0.78 - shade, 0.72 - shade, 0.62 - shade) if (column + row) % 2 else (0.35 + shade, 0.22 + shade, 0.17 + shade)


def _scene() -> None:
    scene = common.settings(320, 180, samples=32, bounces=8)
    scene.frame_start, scene.frame_end = 1, FRAMES
    common.world((0.05, 0.06, 0.08), 1.0)
    tiles = common.textured("Tiles", common.image("Tiles", 256, 256, _tiles), roughness=0.7)
    white = common.diffuse("White", (0.72, 0.71, 0.68))
    walls = {"floor": tiles, "ceiling": white, "back": white}
    walls |= {"left": common.diffuse("Left", (0.6, 0.25, 0.1)), "right": common.diffuse("Right", (0.12, 0.28, 0.5))}
    boxes.room(3.6, 3.0, 2.2, walls)
    _still_life()
    _what_moves()
    common.camera((0.0, -4.2, 1.35), (0.0, 0.0, 0.6), lens=38)


def _still_life() -> None:
    """A glass ball, a glass slab, and something that shines by itself."""
    common.sphere("Glass", (0.95, -0.55, 0.32), 0.32, common.glass("Glass"))
    common.box("Slab", (-0.75, -0.45, 0.45), (0.7, 0.08, 0.9), common.glass("Slab", (0.9, 1.0, 0.96)), turn=20)
    common.sphere("Lantern", (0.2, -0.95, 0.1), 0.1, common.emission("Lantern", (1.0, 0.6, 0.25), 6.0), segments=24)


def _what_moves() -> None:
    """The mirror ball rolls to the right, a box slides by behind the slab, the lamp swings to the left: shadows go elsewhere."""
    mirror = common.principled("Mirror", (0.95, 0.95, 0.96), 0.02, 1.0)
    ball = common.sphere("Mirror Ball", (-0.3, 0.15, 0.42), 0.42, mirror, segments=64)
    common.key(ball, "location", [(1, (-0.3, 0.15, 0.42)), (FRAMES, (0.5, 0.15, 0.42))])
    box = common.box("Box", (-1.25, 0.35, 0.35), (0.4, 0.4, 0.7), common.diffuse("Yellow", (0.7, 0.5, 0.1)), turn=-15)
    common.key(box, "location", [(1, (-1.25, 0.35, 0.35)), (FRAMES, (-0.25, 0.35, 0.35))])
    lamp = common.area_lamp("Lamp", (0.9, -0.6, 2.1), (0.0, 0.0, 0.3), (0.35, 0.35), 70.0, (1.0, 0.95, 0.88))
    common.key(lamp, "location", [(1, (0.9, -0.6, 2.1)), (FRAMES, (-0.9, -0.6, 2.1))])


def mirror_and_glass() -> None:
    """Each frame in parts, with their motion."""
    _scene()
    scene = bpy.context.scene
    scene.view_layers[0].use_pass_z = True
    _take_apart(scene)


def compositor() -> None:
    """The reflection graded alone, each component blurred by its own motion and depth, and the sum."""
    _scene()
    scene = bpy.context.scene
    scene.frame_set(FRAMES // 2)
    _take_apart(scene)
    if hasattr(scene, "gradus"):
        scene.view_layers[0].gradus.use_pass_component_depth = True
    scene.use_nodes = True
    scene.view_layers[0].update_render_passes()
    _compositing_tree(scene.node_tree)


def _take_apart(scene: bpy.types.Scene) -> None:
    if hasattr(scene, "gradus"):
        scene.gradus.use_decomposition = True
        scene.view_layers[0].gradus.use_pass_component_motion = True


def _compositing_tree(tree: bpy.types.NodeTree) -> None:
    """Render -> (grade) -> Vector Blur for each component -> sum -> Composite. By name: the order of sockets differs by version."""
    tree.nodes.clear()
    render = tree.nodes.new("CompositorNodeRLayers")
    total = None
    for place, name in enumerate(COMPONENTS):
        picture = render.outputs[f"Path {name}"]
        if name == "Reflection":
            picture = _mixed(tree, "Grade", "MULTIPLY", picture, None, (250, -220 * place))
        part = _blurred(tree, f"Blur {name}", render, name, picture, (450, -220 * place))
        total = part if total is None else _mixed(tree, f"Add {name}", "ADD", total, part, (650 + 170 * place, -220 * place))
    output = tree.nodes.new("CompositorNodeComposite")
    output.location = (1550, -880)
    tree.links.new(total, output.inputs["Image"])


def _blurred(
    tree: bpy.types.NodeTree, name: str, render: bpy.types.Node, component: str, picture: bpy.types.NodeSocket, place: tuple[float, float]
) -> bpy.types.NodeSocket:
    blur = tree.nodes.new("CompositorNodeVecBlur")
    blur.name = blur.label = name
    blur.factor, blur.samples, blur.location = 0.5, 32, place
    tree.links.new(picture, blur.inputs["Image"])
    # Of what the component shows: by the render's depth all that a mirror shows would be as near as the mirror.
    tree.links.new(render.outputs[f"Path {component} Depth"], blur.inputs["Z"])
    tree.links.new(render.outputs[f"Path {component} Motion"], blur.inputs["Speed"])
    return blur.outputs["Image"]


def _mixed(
    tree: bpy.types.NodeTree, name: str, kind: str, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket | None,
    place: tuple[float, float],
) -> bpy.types.NodeSocket:  # fmt: skip
    """Without a second picture it is the colour WARM."""
    mix = tree.nodes.new("CompositorNodeMixRGB")
    mix.name = mix.label = name
    mix.blend_type, mix.location = kind, place
    mix.inputs[0].default_value = 1.0
    tree.links.new(first, mix.inputs[1])
    if second is None:
        mix.inputs[2].default_value = WARM
    else:
        tree.links.new(second, mix.inputs[2])
    return mix.outputs["Image"]
