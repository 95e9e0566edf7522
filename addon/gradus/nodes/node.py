"""What a translator sees: one node, the output that is asked for, and its inputs as values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import convert
from .ops import Op
from .program import COLOR, FLOAT, NO_NORMAL, SHADER, VECTOR, Program, Value, constant_float
from .tree import find_socket

if TYPE_CHECKING:
    from .walker import Walker


class NodeView:
    """A node on its way of groups. Inputs are found by identifier, older and newer ones as aliases."""

    def __init__(self, walker: Walker, node: Any, socket: Any, path: tuple[Any, ...]) -> None:
        self.walker = walker
        self.node = node
        self.socket = socket
        self.path = path

    @property
    def program(self) -> Program:
        return self.walker.program

    @property
    def version(self) -> tuple[int, ...]:
        return self.walker.version

    @property
    def output(self) -> str:
        """Identifier of the output that is asked for."""
        return self.socket.identifier

    def find(self, *identifiers: str) -> Any:
        return find_socket(self.node.inputs, *identifiers)

    def has(self, *identifiers: str) -> bool:
        return self.find(*identifiers) is not None

    def is_linked(self, *identifiers: str) -> bool:
        socket = self.find(*identifiers)
        return socket is not None and self.walker.linked(socket, self.path) is not None

    def value(self, *identifiers: str, default: float = 0.0) -> Value:
        """An input in its own kind; a constant float where the node has no such input."""
        socket = self.find(*identifiers)
        return constant_float(default) if socket is None else self.walker.input(socket, self.path)

    def linked(self, *identifiers: str) -> Value | None:
        """What is linked to an input, as a vector; None where nothing is."""
        socket = self.find(*identifiers)
        value = self.walker.linked(socket, self.path) if socket is not None else None
        return None if value is None else convert.convert(self.program, value, VECTOR)

    def direction(self, *identifiers: str) -> Value:
        """A normal or tangent: zero, meaning the surface's own, where nothing is linked."""
        return self.linked(*identifiers) or NO_NORMAL

    def add(
        self,
        op: Op,
        inputs: tuple[Value, ...] = (),
        mode: int = 0,
        floats: tuple[float, ...] = (),
        resource: int = 0,
        *,
        kind: str = COLOR,
        output: int = 0,
    ) -> Value:
        """A node of the program; the value of one of its outputs."""
        return Value(kind, node=self.program.add(op, inputs, mode, floats, resource), output=output)

    def add_float(self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0, **rest: Any) -> Value:
        return self.add(op, inputs, mode, kind=FLOAT, **rest)

    def add_vector(self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0, **rest: Any) -> Value:
        return self.add(op, inputs, mode, kind=VECTOR, **rest)

    def add_closure(self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0) -> Value:
        return self.add(op, inputs, mode, kind=SHADER)

    def math(self, operation: int, a: Value, b: Value) -> Value:
        return self.add_float(Op.MATH, (a, b), operation)

    def clamped(self, value: Value) -> Value:
        """A float kept in 0…1."""
        if value.is_constant:
            return constant_float(min(max(value.constant[0], 0.0), 1.0))
        return Value(value.kind, node=self.program.add(Op.CLAMP, (value, constant_float(0.0), constant_float(1.0))))

    def name_resource(self, name: str) -> int:
        return self.program.name_index(name)

    def warn_replaced(self, text: str) -> None:
        """One warning that names material and node; its pixels count as replaced."""
        self.program.uses_fallback = True
        self.program.warn(f"{self.program.name}: node '{self.node.name}' ({self.node.bl_label}) {text}")
