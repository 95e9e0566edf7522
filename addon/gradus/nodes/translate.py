"""Translates a material, world or light to its program."""

from __future__ import annotations

import sys
from typing import Any

from ..abi import ShadingNormals
from . import inlining
from .aovs import aov_outputs
from .displacement import set_displacement
from .light_paths import warn_of_emission
from .ops import Op
from .program import SHADER, Program, constant_color, constant_float
from .tree import find_socket
from .walker import Walker

# The translation of a chain of nodes is recursive, with about four nested calls per node.
_RECURSION_LIMIT = 20000

_KINDS = {"MATERIAL": "SURFACE", "SURFACE": "SURFACE", "WORLD": "WORLD", "LIGHT": "LIGHT"}


def host_version() -> tuple[int, ...]:
    import bpy

    return tuple(bpy.app.version)


def translate(block: Any, kind: str, resources: Any, version: tuple[int, ...] | None = None) -> Program:
    """Returns the program of a material (kind SURFACE or MATERIAL), world (WORLD) or light (LIGHT).

    Does not raise for any content of a graph.
    """
    kind = _KINDS[kind]
    version = version or host_version()
    program = Program(name=block.name)
    _settings(program, block, kind, version)
    tree = _node_tree(block, version)
    if tree is None:
        program.surface = _without_nodes(program, block, kind)
        return program
    if version >= (5, 0, 0) and inlining.has_loop(tree):
        return program  # black, as in Cycles
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _RECURSION_LIMIT))
    try:
        inlined = block.inline_shader_nodes() if inlining.is_needed(block, tree) else None
        # The tree of `inlined` exists as long as `inlined` itself.
        _walk(program, block, inlined.node_tree if inlined is not None else tree, resources, version, kind)
    except Exception as error:  # noqa: BLE001  (an unexpected graph must not prevent the frame)
        _replace_all(program, kind, f"{type(error).__name__}: {error}")
    finally:
        sys.setrecursionlimit(limit)
    return program


def _replace_all(program: Program, kind: str, reason: str) -> None:
    program.warn(f"{program.name}: its nodes could not be translated and are replaced by grey ({reason})")
    program.uses_fallback = True
    op, strength_or_roughness = (Op.DIFFUSE, 0.0) if kind == "SURFACE" else (Op.EMISSION, 1.0)
    program.surface = program.add(op, (constant_color((0.8, 0.8, 0.8)), constant_float(strength_or_roughness)))


def _settings(program: Program, block: Any, kind: str, version: tuple[int, ...]) -> None:
    if kind != "SURFACE":
        return
    program.shading_normals = _shading_normals(version)
    program.pass_index = getattr(block, "pass_index", 0)
    cycles = getattr(block, "cycles", None)
    # Cycles has a Boolean in 3.4 and an enumeration later.
    is_sampled = getattr(cycles, "emission_sampling", "AUTO") != "NONE"
    program.sample_as_light = is_sampled and bool(getattr(cycles, "sample_as_light", True))
    shadow = getattr(block, "use_transparent_shadow", None)
    if shadow is None:
        shadow = getattr(cycles, "use_transparent_shadow", True)
    program.transparent_shadow = bool(shadow)


def _shading_normals(version: tuple[int, ...]) -> ShadingNormals:
    if version >= (4, 5, 0):
        return ShadingNormals.SINCE_4_5
    return ShadingNormals.SINCE_3_6 if version >= (3, 6, 0) else ShadingNormals.BEFORE_3_6


def _node_tree(block: Any, version: tuple[int, ...]) -> Any:
    """Returns the node tree, or None if nodes are disabled. From 5.0 on, they can be disabled for lights only."""
    if _is_light(block) or version < (5, 0, 0):
        return block.node_tree if block.use_nodes else None
    return block.node_tree


def _is_light(block: Any) -> bool:
    return hasattr(block, "energy")


def _without_nodes(program: Program, block: Any, kind: str) -> int:
    if kind == "SURFACE":
        return program.add(Op.DIFFUSE, (constant_color(block.diffuse_color), constant_float(0.0)))
    color = (1.0, 1.0, 1.0) if kind == "LIGHT" else block.color
    return program.add(Op.EMISSION, (constant_color(color), constant_float(1.0)))


def _output_node(tree: Any) -> Any:
    return tree.get_output_node("CYCLES") or tree.get_output_node("ALL")


def _walk(program: Program, block: Any, tree: Any, resources: Any, version: tuple[int, ...], kind: str) -> None:
    output = _output_node(tree)
    if output is None:
        return
    walker = Walker(program, resources, tree, version, kind)
    surface = find_socket(output.inputs, "Surface")
    value = walker.input(surface, ())
    if value.kind == SHADER and not value.is_constant:
        program.surface = value.node
        warn_of_emission(program, block, kind)
    program.aovs = aov_outputs(walker, resources.aovs) if resources.aovs else 0
    if _is_fed(walker, output, "Volume"):
        _warn_left_out(program, "volume")
        if kind == "SURFACE" and program.surface < 0:
            # A surface that only bounds a volume is invisible. Without this, a box of fog would be black.
            program.surface = program.add(Op.TRANSPARENT, (constant_color((1.0, 1.0, 1.0)),))
    if kind == "SURFACE":
        set_displacement(program, block, walker, find_socket(output.inputs, "Displacement"))


def _is_fed(walker: Walker, output: Any, name: str) -> bool:
    """Returns whether an input of the output node has a link."""
    socket = find_socket(output.inputs, name)
    return socket is not None and walker.tree(()).source(socket) is not None


def _warn_left_out(program: Program, what: str) -> None:
    program.warn(f"{program.name}: {what} is not supported and is left out")
    program.uses_fallback = True
