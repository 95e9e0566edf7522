"""Names outputs of the Light Path node that emission reads and Cycles evaluates in another way.

Where Cycles samples a light, it shades it as if no kind of ray saw it. It weights this with rays that find the light by
its own probabilities, so that no other engine can have the same picture.
"""

from __future__ import annotations

from typing import Any

from .ops import LightPath, Op
from .program import Program

_NAMES = {
    LightPath.DIFFUSE: "Is Diffuse Ray",
    LightPath.GLOSSY: "Is Glossy Ray",
    LightPath.REFLECTION: "Is Reflection Ray",
    LightPath.TRANSMISSION: "Is Transmission Ray",
    LightPath.LENGTH: "Ray Length",
    LightPath.DEPTH: "Ray Depth",
    LightPath.DIFFUSE_DEPTH: "Diffuse Depth",
    LightPath.GLOSSY_DEPTH: "Glossy Depth",
    LightPath.TRANSPARENT_DEPTH: "Transparent Depth",
    LightPath.TRANSMISSION_DEPTH: "Transmission Depth",
}

# What differs depends on what emits: a light has neither kinds nor lengths of its own in both engines. Where Cycles
# samples a light, it does not count the transparent surfaces before it.
_DEPTHS = {
    LightPath.DEPTH,
    LightPath.DIFFUSE_DEPTH,
    LightPath.GLOSSY_DEPTH,
    LightPath.TRANSPARENT_DEPTH,
    LightPath.TRANSMISSION_DEPTH,
}
_DIFFERENT = {"SURFACE": set(_NAMES) - {LightPath.DEPTH}, "WORLD": set(_NAMES), "LIGHT": _DEPTHS}

_EMISSION_OF_PRINCIPLED = 17
"""Index of the input of PRINCIPLED that is emitted."""


def warn_of_emission(program: Program, block: Any, kind: str) -> None:
    """Adds a warning if the emission of a sampled material, world or light depends on what Cycles does not know."""
    if not _is_sampled(program, block, kind):
        return
    modes = _Emission(program).modes(program.surface) or set()
    names = [name for mode, name in _NAMES.items() if mode in modes & _DIFFERENT[kind]]
    if names:
        program.warn(f"{program.name}: its emission depends on {', '.join(names)}, which Cycles evaluates differently")


def _is_sampled(program: Program, block: Any, kind: str) -> bool:
    if kind == "WORLD":
        return getattr(getattr(block, "cycles", None), "sampling_method", "AUTOMATIC") != "NONE"
    return program.sample_as_light


class _Emission:
    """Finds the modes of LIGHT_PATH that the emission of a program reads."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._read: dict[int, set[int]] = {}

    def modes(self, closure: int) -> set[int] | None:
        """Returns the modes that the emission of a closure reads, or None if it emits nothing."""
        if closure < 0:
            return None
        op = self._program.nodes[closure][0]
        inputs = self._inputs(closure)
        if op == Op.EMISSION:
            is_black = any(node < 0 and not any(constant[:3]) for node, constant in inputs)
            return None if is_black else self._reads(closure)
        if op == Op.PRINCIPLED:
            node, constant = inputs[_EMISSION_OF_PRINCIPLED]
            return (set() if any(constant[:3]) else None) if node < 0 else self._reads(node)
        if op not in (Op.MIX_SHADER, Op.ADD_SHADER):
            return None
        parts = [self.modes(node) for node, _ in inputs[-2:]]
        emitting = [part for part in parts if part is not None]
        if not emitting:
            return None
        weight = self._reads(inputs[0][0]) if op == Op.MIX_SHADER else set()
        return weight.union(*emitting)

    def _inputs(self, node: int) -> list[tuple[int, tuple[float, ...]]]:
        first, count = self._program.nodes[node][2:4]
        return [(source, constant) for source, _, constant in self._program.inputs[first : first + count]]

    def _reads(self, node: int) -> set[int]:
        """Returns the modes that a value reads. A negative number is a constant."""
        if node < 0:
            return set()
        if node not in self._read:
            op, mode = self._program.nodes[node][:2]
            own = {mode} if op == Op.LIGHT_PATH else set()
            self._read[node] = own.union(*(self._reads(source) for source, _ in self._inputs(node)))
        return self._read[node]
