"""AOV Output nodes: values of a material that passes of the view layer show."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .ops import Op
from .program import SHADER, Value
from .walker import Path, Walker


def aov_outputs(walker: Walker, aovs: dict[str, int]) -> int:
    """Translates the AOV outputs of a tree and of its groups. Returns the index + 1 of the node that joins them, or 0.

    aovs: the index + 1 of each AOV's channel, by name. Outputs to other names have no effect, as in Cycles.
    """
    program = walker.program
    joined: Value | None = None
    for node, path in _outputs(walker, ()):
        channel = aovs.get(_name(node))
        if channel is None:
            continue
        inputs = tuple(walker.input(node.inputs[name], path) for name in ("Color", "Value"))
        output = Value(SHADER, node=program.add(Op.AOV, inputs, channel - 1))
        joined = output if joined is None else Value(SHADER, node=program.add(Op.ADD_SHADER, (joined, output)))
    return joined.node + 1 if joined is not None else 0


def _name(node: Any) -> str:
    return getattr(node, "aov_name", node.name)  # a property of its own from 4.1 on


def _outputs(walker: Walker, path: Path) -> Iterator[tuple[Any, Path]]:
    for node in walker.tree(path).node_tree.nodes:
        if node.mute:
            continue
        if node.bl_idname == "ShaderNodeOutputAOV":
            yield node, path
        elif node.type == "GROUP" and node.node_tree not in (None, *(group.node_tree for group in path)):
            yield from _outputs(walker, (*path, node))
