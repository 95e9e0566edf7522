"""The interface of translators to a node, and their registry by bl_idname."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from . import convert
from .ops import Op
from .program import COLOR, FLOAT, NO_NORMAL, SHADER, VECTOR, Program, Value, constant_float
from .tree import find_socket

if TYPE_CHECKING:
    from .walker import Walker


class NodeView:
    """A node inside a path of groups, and the output to translate.

    Inputs are found by identifier. Several identifiers are alternatives of different versions of Blender.
    """

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
        """The identifier of the output to translate."""
        return self.socket.identifier

    def find(self, *identifiers: str) -> Any:
        return find_socket(self.node.inputs, *identifiers)

    def has(self, *identifiers: str) -> bool:
        return self.find(*identifiers) is not None

    def is_linked(self, *identifiers: str) -> bool:
        socket = self.find(*identifiers)
        return socket is not None and self.walker.linked(socket, self.path) is not None

    def value(self, *identifiers: str, default: float = 0.0) -> Value:
        """Returns the value of an input, or the constant `default` if the node has no such input."""
        socket = self.find(*identifiers)
        return constant_float(default) if socket is None else self.walker.input(socket, self.path)

    def linked(self, *identifiers: str) -> Value | None:
        """Returns what is linked to an input as a vector, or None."""
        socket = self.find(*identifiers)
        value = self.walker.linked(socket, self.path) if socket is not None else None
        return None if value is None else convert.convert(self.program, value, VECTOR)

    def direction(self, *identifiers: str) -> Value:
        """Returns a normal or tangent. Without a link it is zero, which stands for that of the surface."""
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
        """Adds a node to the program. Returns the value of one of its outputs."""
        return Value(kind, node=self.program.add(op, inputs, mode, floats, resource), output=output)

    def add_float(self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0, **options: Any) -> Value:
        return self.add(op, inputs, mode, kind=FLOAT, **options)

    def add_vector(self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0, **options: Any) -> Value:
        return self.add(op, inputs, mode, kind=VECTOR, **options)

    def add_closure(self, op: Op, inputs: tuple[Value, ...] = (), mode: int = 0) -> Value:
        return self.add(op, inputs, mode, kind=SHADER)

    def math(self, operation: int, a: Value, b: Value) -> Value:
        return self.add_float(Op.MATH, (a, b), operation)

    def clamped(self, value: Value) -> Value:
        """Returns a float clamped to 0…1."""
        if value.is_constant:
            return constant_float(min(max(value.constant[0], 0.0), 1.0))
        return Value(value.kind, node=self.program.add(Op.CLAMP, (value, constant_float(0.0), constant_float(1.0))))

    def name_resource(self, name: str) -> int:
        return self.program.name_index(name)

    def instance_attribute(self, name: str, *, kind: str, output: int) -> Value:
        """Adds a read of an attribute of the instance. `name` has a prefix of attribute_names.py."""
        resource = self.program.instance_name_index(name)
        return self.add(Op.INSTANCE_ATTRIBUTE, resource=resource, kind=kind, output=output)

    def warn_replaced(self, text: str) -> None:
        """Adds a warning with the names of material and node. Pass Fallback marks the pixels of the material."""
        self.program.uses_fallback = True
        self.program.warn(f"{self.program.name}: node '{self.node.name}' ({self.node.bl_label}) {text}")


# ------------------------------------------------------------------------------------------------ registry

Translator = Callable[[NodeView], "Value | None"]

_translators: dict[str, Translator] = {}


def translator(*bl_idnames: str) -> Callable[[Translator], Translator]:
    """Registers a function that returns the value of the output `view.output`.

    The function may return None, which is treated like a missing link.
    """

    def register(function: Translator) -> Translator:
        for name in bl_idnames:
            _translators[name] = function
        return function

    return register


def find_translator(bl_idname: str) -> Translator | None:
    return _translators.get(bl_idname)
