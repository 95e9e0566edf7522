"""Rows of shader nodes: each value of each property, each input that varies, and each output.

A value is emitted by surfaces of several shapes, which has no noise; a shader is lit by a sun and a world. Inputs have
values other than their defaults throughout, so that all of them matter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any

import bpy

from .. import node_contexts, rna, sockets, stages
from ..row import EXACT, NOISY, Row

TITLE = "Shader nodes"

SHOWN = {"SHADER", "RGBA", "VECTOR", "VALUE", "INT", "BOOLEAN", "ROTATION", "BUNDLE"}
"""Types of outputs that a surface can show."""


@dataclass(frozen=True)
class Variation:
    """How a node is shown."""

    settings: dict[str, Any] = field(default_factory=dict)  # properties by name, those of inner structures by a.b
    change: rna.Change | None = None  # the property of the row
    given: dict[str, Any] = field(default_factory=dict)  # values of inputs by name, those that exist
    driven: str = ""  # identifier of an input that varies
    unlinked: str = ""  # identifier of an input that has no link
    output: str = ""  # identifier of the shown output
    is_muted: bool = False


def rows() -> Iterator[Row]:
    for kind in node_types():
        if kind not in node_contexts.NOT_MADE:
            yield from rows_of_node(kind)


def node_types() -> list[str]:
    """Returns the types of nodes that Blender accepts in the node tree of a material."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    tree, _ = stages.empty_tree(bpy.data.materials.new("Probe"), "ShaderNodeOutputMaterial")
    found = []
    for name in sorted(dir(bpy.types)):
        kind = getattr(bpy.types, name)
        if isinstance(kind, type) and issubclass(kind, bpy.types.Node) and not name.startswith("NodeGroup"):
            try:
                found.append(tree.nodes.new(name).bl_idname)
            except RuntimeError:  # of another kind of tree
                continue
    return found


def probe(kind: str) -> Any:
    """Returns a node in a tree of its own, to read its properties and sockets."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    tree, _ = stages.empty_tree(bpy.data.materials.new("Probe"), "ShaderNodeOutputMaterial")
    node = tree.nodes.new(kind)
    if kind in node_contexts.PREPARE:
        node_contexts.PREPARE[kind](node)
    return node


def rows_of_node(kind: str) -> Iterator[Row]:
    is_noisy(kind)  # makes a file of its own, in which `node` would not exist
    node = probe(kind)
    yield _row(kind, "", Variation(), base=Variation(is_muted=True))
    for suffix, change in property_changes(node):
        name = suffix[1:].partition("=")[0]
        base = Variation(settings=node_contexts.settings_for(kind, name), given=node_contexts.inputs_for(kind, name))
        yield _row(kind, suffix, replace(base, change=change), base)
    for socket, settings in sockets_of(node, "inputs"):
        yield from _rows_of_input(kind, socket, settings)
    outputs = list(sockets_of(node, "outputs"))
    for socket, settings in outputs[1:]:
        shown = Variation(settings=settings, output=socket.identifier)
        yield _row(kind, f".outputs[{socket.identifier}]", shown, Variation(settings=settings, is_muted=True))
    if outputs:
        yield _row(kind, ".mute", Variation(is_muted=True), Variation())


def _row(kind: str, suffix: str, variation: Variation, base: Variation) -> Row:
    samples = NOISY if is_noisy(kind) else EXACT
    name = f"{kind} {base.settings} {base.given} {base.is_muted}"
    return Row(TITLE, f"{kind}{suffix}", partial(build, kind, variation), partial(build, kind, base), name, samples)


def _rows_of_input(kind: str, socket: Any, settings: dict[str, Any]) -> Iterator[Row]:
    base = Variation(settings=settings, given=node_contexts.inputs_for(kind, socket.name))
    name = f".inputs[{socket.identifier}]"
    if socket.is_implicit:
        yield _row(kind, f"{name} unlinked", replace(base, unlinked=socket.identifier), base)
    yield _row(kind, name, replace(base, driven=socket.identifier), base)


def property_changes(node: Any) -> Iterator[tuple[str, rna.Change]]:
    """Yields the changes of a node's own properties, and of its texture mapping and curves."""
    kind = node.bl_idname
    yield from rna.changes(node, (*node_contexts.SKIPPED, "mute"), node_contexts.INNER.get(kind, ()))
    for name, value in node_contexts.STRINGS.items():
        if name in node.bl_rna.properties:
            yield f".{name}", partial(_set, name, value)
    if hasattr(node, "texture_mapping"):
        yield from rna.of_part("texture_mapping", rna.changes(node.texture_mapping))


def _set(name: str, value: Any, owner: Any) -> None:
    setattr(owner, name, value)


@dataclass(frozen=True)
class Found:
    """A socket of a node that is gone."""

    identifier: str
    name: str
    is_implicit: bool


def sockets_of(node: Any, side: str) -> Iterator[tuple[Found, dict[str, Any]]]:
    """Yields all inputs or outputs, each once, with values of the node's enumerations that enable it."""
    seen: set[str] = set()
    for settings in _configurations(node):
        present = {name: getattr(node, name) for name in settings}
        for name, value in settings.items():
            setattr(node, name, value)
        for socket in getattr(node, side):
            is_used = socket.enabled and not getattr(socket, "is_unavailable", False) and socket.type != "CUSTOM"
            if is_used and socket.identifier not in seen:
                seen.add(socket.identifier)
                yield Found(socket.identifier, socket.name, side == "inputs" and sockets.is_implicit(socket)), settings
        for name, value in present.items():
            setattr(node, name, value)


def _configurations(node: Any) -> Iterator[dict[str, Any]]:
    """Yields no change, then each value of each enumeration, then each pair of values of two enumerations."""
    own = set(node.bl_rna.properties.keys()) - set(bpy.types.Node.bl_rna.properties.keys())
    enumerations = {}
    for name in sorted(own):
        prop = node.bl_rna.properties[name]
        if prop.type == "ENUM" and not prop.is_readonly and not prop.is_enum_flag:
            enumerations[name] = rna.enum_values(node, name)
    yield {}
    for name, values in enumerations.items():
        for value in values:
            yield {name: value}
    for first in enumerations:
        for second in enumerations:
            if first < second and len(enumerations[first]) * len(enumerations[second]) <= 60:
                for a in enumerations[first]:
                    for b in enumerations[second]:
                        yield {first: a, second: b}


def is_shader(node: Any) -> bool:
    return any(socket.type == "SHADER" and socket.enabled for socket in node.outputs)


@cache
def is_noisy(kind: str) -> bool:
    """Returns whether pictures of a node have noise: shaders and lights do, values do not."""
    if kind in node_contexts.NOISY_NODES or kind in node_contexts.LIGHT_NODES or kind == "ShaderNodeOutputMaterial":
        return True
    return is_shader(probe(kind)) and kind not in {*node_contexts.WORLD_NODES, "ShaderNodeEmission"}


def build(kind: str, variation: Variation) -> None:
    """Makes the scene that shows a node."""
    node = _stage(kind)
    for path, value in variation.settings.items():
        owner, _, name = path.rpartition(".")
        setattr(getattr(node, owner) if owner else node, name, value)
    if kind in node_contexts.PREPARE:
        node_contexts.PREPARE[kind](node)
    if variation.change is not None:
        variation.change(node)
    _feed(node, variation)
    _show(node, variation.output)
    node.mute = variation.is_muted


def _stage(kind: str) -> Any:
    """Makes a scene and returns a node in the tree of its material, world or light."""
    if kind in node_contexts.WORLD_NODES:
        stages.camera((0.0, 0.0, 0.0), (0.2, 1.0, 0.35), lens=20.0)
        world = bpy.context.scene.world = bpy.data.worlds.new("World")
        tree, output = stages.empty_tree(world, "ShaderNodeOutputWorld")
    elif kind in node_contexts.LIGHT_NODES:
        stages.mesh("PLANE", stages.material(), scale=(4.0, 4.0, 1.0))
        lamp = stages.light("POINT", 200.0, location=(0.4, -0.3, 1.5), rotation_euler=(0.3, 0.2, 0.1))
        lamp.data.shadow_soft_size = 0.0
        stages.camera((0.0, -4.0, 4.0))
        stages.black_world()
        tree, output = stages.empty_tree(lamp.data, "ShaderNodeOutputLight")
    else:
        material = bpy.data.materials.new("Shown")
        tree, output = stages.empty_tree(material, "ShaderNodeOutputMaterial")
        if kind == "ShaderNodeLightPath":
            stages.room()
            bpy.data.objects["Floor"].data.materials[0] = material
        elif is_noisy_surface(tree, kind):
            stages.lit_sphere(material)
        else:
            stages.surface_of_values(material)
    return output if output.bl_idname == kind else tree.nodes.new(kind)


def is_noisy_surface(tree: Any, kind: str) -> bool:
    if kind == "ShaderNodeOutputMaterial":
        return True
    node = tree.nodes.new(kind)
    found = is_shader(node) and kind != "ShaderNodeEmission"
    tree.nodes.remove(node)
    return found


def _feed(node: Any, variation: Variation) -> None:
    """Gives the inputs values. Of a node that is no shader the first input varies."""
    patterns = sockets.Patterns(node.id_data)
    is_in_light = node.bl_idname in node_contexts.LIGHT_NODES
    is_value = bool(node.outputs) and not is_shader(node)
    first = True
    for index, socket in enumerate(node.inputs):
        if not socket.enabled or socket.type == "CUSTOM":
            continue
        if is_in_light and socket.type == "VALUE":  # a light has one place, over which nothing varies
            sockets.set_constant(socket, index + (socket.identifier == variation.driven))
        elif socket.identifier == variation.driven:
            patterns.drive(socket, turned=True)
        elif socket.identifier == variation.unlinked:
            pass
        elif socket.type == "SHADER":
            patterns_for_shader(node.id_data, socket, index)
        elif socket.name in variation.given:
            sockets.set_value(socket, variation.given[socket.name])
        elif is_value and first and socket.type in {"VALUE", "VECTOR", "RGBA"} and not sockets.is_direction(socket):
            patterns.drive(socket)
        elif is_value or socket.type == "RGBA":
            sockets.set_constant(socket, index)
        first = False


def patterns_for_shader(tree: Any, socket: Any, index: int) -> None:
    """Links a shader to the input of a node, and nothing to other inputs than Surface of an output node."""
    if "Output" in socket.node.bl_idname and socket.name != "Surface":
        return
    kind = "Emission" if socket.node.bl_idname == "ShaderNodeOutputLight" else "BsdfDiffuse"
    node = tree.nodes.new(f"ShaderNode{'Background' if 'World' in socket.node.bl_idname else kind}")
    node.inputs[0].default_value = ((0.8, 0.4, 0.2, 1.0), (0.2, 0.4, 0.8, 1.0), (0.3, 0.7, 0.3, 1.0))[index % 3]
    tree.links.new(node.outputs[0], socket)


def _show(node: Any, identifier: str) -> None:
    """Links an output, the first one by default, to the output of the tree; a value by way of emission."""
    usable = [socket for socket in node.outputs if socket.enabled and socket.type in SHOWN]
    if not usable:
        return
    source = next((socket for socket in usable if socket.identifier == identifier), usable[0])
    tree = node.id_data
    end = next(item for item in tree.nodes if item.bl_idname.startswith("ShaderNodeOutput"))
    if source.name == "Displacement":
        tree.links.new(source, end.inputs["Displacement"])
        source = tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"]
    if source.type == "BUNDLE":
        parts = tree.nodes.new("NodeSeparateBundle")
        node_contexts.PREPARE[parts.bl_idname](parts)
        tree.links.new(source, parts.inputs["Bundle"])
        source = parts.outputs[sockets.ITEM]
    if source.type != "SHADER":
        is_world = end.bl_idname == "ShaderNodeOutputWorld"
        is_strength = end.bl_idname == "ShaderNodeOutputLight"
        shader = tree.nodes.new("ShaderNodeBackground" if is_world else "ShaderNodeEmission")
        tree.links.new(source, shader.inputs["Strength" if is_strength else "Color"])
        source = shader.outputs[0]
    is_volume = source.name == "Volume" or node.bl_idname.startswith("ShaderNodeVolume")
    tree.links.new(source, end.inputs["Volume" if is_volume else "Surface"])
