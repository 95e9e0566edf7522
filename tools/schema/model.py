"""Reads schema/*.toml into plain objects and checks them for mistakes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomllib

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "schema"

SCALARS = frozenset(("int32", "uint32", "uint64", "size", "float", "double", "bool", "text", "bytes"))
"""Types of fields besides enums and structs."""

OPTION_TYPES = frozenset(("int", "float", "bool", "text", "folder", "plain"))
"""Types of options besides enums."""

MAX_INT = 2147483647
MAX_FLOAT = 3.4e38


class SchemaError(Exception):
    """The schema has a mistake. The text names the item."""


def plain(text: str) -> str:
    """Returns a text of the schema on one line."""
    return " ".join(text.split())


@dataclass(frozen=True)
class Value:
    """A value of an enum."""

    name: str
    number: int
    doc: str
    label: str = ""


@dataclass(frozen=True)
class Enum:
    name: str
    prefix: str
    doc: str
    values: tuple[Value, ...]
    flags: bool = False
    python: str = ""  # name of the class in Python where it is another one
    bare: tuple[str, ...] = ()  # values that have no prefix in C

    def number_of(self, name: str) -> int:
        for value in self.values:
            if value.name == name:
                return value.number
        raise SchemaError(f"enum {self.name} has no value {name}")


@dataclass(frozen=True)
class Field:
    """A field of a struct. `base` is its type without [n] or *."""

    name: str
    base: str
    doc: str
    count: int = 0  # n of T[n]
    pointer: bool = False  # T*
    unit: str = ""
    length: str = ""
    nullable: bool = False


@dataclass(frozen=True)
class Struct:
    name: str
    doc: str
    fields: tuple[Field, ...]
    sized: bool = True
    archive: bool = False

    @property
    def all_fields(self) -> tuple[Field, ...]:
        """All fields, including struct_size if the struct has it."""
        return (Field("struct_size", "uint32", "sizeof this struct."), *self.fields) if self.sized else self.fields


@dataclass(frozen=True)
class Option:
    """An option of a render; see options.toml for the meaning of its fields."""

    name: str
    type: str
    doc: str
    default: Any = None
    minimum: float = 0
    maximum: float | None = None
    soft_maximum: float | None = None
    precision: int = 3
    unit: str = ""
    label: str = ""
    source: str = ""
    blender: str = ""
    host: bool = False
    sampling: bool = False
    minimum_samples: int = 0
    c_type: str = ""
    effect: str = "picture"
    shown: str = "still"
    moved: Any = None
    given: dict[str, Any] = field(default_factory=dict)

    @property
    def is_plain(self) -> bool:
        return self.type == "plain"


@dataclass(frozen=True)
class Pass:
    """A pass of the picture or of a component; see passes.toml for the meaning of its fields."""

    name: str
    number: int
    label: str
    channels: str
    switch: str
    doc: str
    kind: str = ""
    old_label: str = ""
    color: str = ""
    group: str = ""
    suffix: str | None = None


@dataclass(frozen=True)
class Switch:
    """A property of view_layer.gradus."""

    name: str
    label: str
    doc: str
    default: bool = False


FIRST_VALUE_OP = 32
"""Number of the first operation that is no closure."""

OP_LIMIT = 128
"""Numbers of operations are below this."""


@dataclass(frozen=True)
class Op:
    """An operation of the node program; see nodes.toml for the meaning of its fields."""

    name: str
    number: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    doc: str
    kind: str = "pure"  # or "context", "program", "closure"
    last_mode: int | str = 0
    floats: int = 0
    text: str = ""
    reads_ray: bool | list[str] = False
    reads_history: bool | list[str] = False

    @property
    def is_closure(self) -> bool:
        return self.kind == "closure"

    @property
    def function(self) -> str:
        """The name of the C++ function that evaluates an operation of the kinds "pure" and "context"."""
        return f"{self.name.lower()}_op"


@dataclass(frozen=True)
class Section:
    """A group of operations that gradus_nodes.h lists under one title."""

    title: str
    ops: tuple[Op, ...]


@dataclass(frozen=True)
class Family:
    """Nodes of Blender that are rendered: pairs of the shown name and the type."""

    title: str
    nodes: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Schema:
    enums: tuple[Enum, ...]
    structs: tuple[Struct, ...]
    options: tuple[Option, ...]
    passes: tuple[Pass, ...]
    component_passes: tuple[Pass, ...]
    switches: tuple[Switch, ...]
    sections: tuple[Section, ...]
    node_enums: tuple[Enum, ...]
    families: tuple[Family, ...]

    def enum(self, name: str) -> Enum:
        return _find(self.enums, name, "enum")

    def struct(self, name: str) -> Struct:
        return _find(self.structs, name, "struct")

    def has_enum(self, name: str) -> bool:
        return any(enum.name == name for enum in self.enums)

    def has_struct(self, name: str) -> bool:
        return any(struct.name == name for struct in self.structs)

    @property
    def ops(self) -> tuple[Op, ...]:
        return tuple(op for section in self.sections for op in section.ops)

    @property
    def native_options(self) -> tuple[Option, ...]:
        """Options that GradusSettings has."""
        return tuple(option for option in self.options if not option.is_plain and not option.host)


def _find(items: tuple[Any, ...], name: str, kind: str) -> Any:
    for item in items:
        if item.name == name:
            return item
    raise SchemaError(f"there is no {kind} {name}")


def parse_field(name: str, kind: str, doc: str, extra: dict[str, Any] | None = None) -> Field:
    """Returns a field of type `kind`, which is T, T[n] or T*."""
    extra = extra or {}
    base, count, pointer = kind, 0, False
    if kind.endswith("*"):
        base, pointer = kind[:-1], True
    elif kind.endswith("]"):
        base, _, number = kind[:-1].partition("[")
        count = int(number)
    unknown = extra.keys() - {"unit", "length", "nullable"}
    if unknown:
        raise SchemaError(f"field {name}: unknown {', '.join(sorted(unknown))}")
    return Field(name, base, plain(doc), count, pointer, **extra)


def _value(name: str, number: int, doc: str, label: str = "") -> Value:
    return Value(name, number, plain(doc), label or name.replace("_", " ").title())


def _values(rows: list[list[Any]], minimum_samples: int = 0) -> tuple[Value, ...]:
    number = str(minimum_samples)
    return tuple(_value(name, key, doc.replace("@minimum_samples", number), *label) for name, key, doc, *label in rows)


def _pass_values(passes: tuple[Pass, ...], count: str) -> tuple[Value, ...]:
    ordered = sorted(passes, key=lambda item: item.number)
    if [item.number for item in ordered] != list(range(len(ordered))):
        raise SchemaError("passes are not numbered from 0 on without gaps")
    values = [Value(item.name, item.number, item.doc, item.label) for item in ordered]
    return (*values, Value(count, len(ordered), "Number of passes."))


def _names(text: str) -> tuple[str, ...]:
    return tuple(plain(name) for name in text.split(",") if name.strip())


def _op(name: str, number: int, shape: str, doc: str, details: dict[str, Any] | None = None) -> Op:
    sides = shape.split("->")
    if len(sides) != 2:
        raise SchemaError(f"operation {name}: expected 'inputs -> outputs', got '{shape}'")
    inputs, outputs = map(_names, sides)
    details = dict(details or {})
    details["text"] = plain(details.get("text", ""))
    if outputs == ("closure",):
        details["kind"] = "closure"
    try:
        return Op(name, number, inputs, outputs, plain(doc), **details)
    except TypeError as error:
        raise SchemaError(f"operation {name}: {error}") from None


def _enum(row: dict[str, Any], values: tuple[Value, ...]) -> Enum:
    further = (row.get("flags", False), row.get("python", ""), tuple(row.get("bare", ())))
    return Enum(row["name"], row["prefix"], plain(row["doc"]), values, *further)


def _read(name: str) -> dict[str, Any]:
    with (FOLDER / name).open("rb") as file:
        return tomllib.load(file)


def _make(kind: type, row: dict[str, Any], names: dict[str, str] | None = None) -> Any:
    """Returns the object of a table's row. `names` has the fields of keys whose names differ."""
    fields = {(names or {}).get(key, key): value for key, value in row.items()}
    fields["doc"] = plain(fields["doc"])
    try:
        return kind(**fields)
    except TypeError as error:
        raise SchemaError(f"{row.get('name')}: {error}") from None


def load() -> Schema:
    """Reads and checks the whole schema. Raises SchemaError."""
    tables = _read("passes.toml")
    passes = tuple(_make(Pass, row) for row in tables["pass"])
    component_passes = tuple(_make(Pass, row) for row in tables["component_pass"])
    switches = tuple(_make(Switch, row) for row in tables["switch"])
    made = {"Pass": _pass_values(passes, "COUNT"), "ComponentPass": _pass_values(component_passes, "PASS_COUNT")}
    options = tuple(_make(Option, row, {"from": "source"}) for row in _read("options.toml")["option"])
    minimum_samples = {option.type: option.minimum_samples for option in options}
    enums = []
    for row in _read("enums.toml")["enum"]:
        values = made[row["name"]] if "from" in row else _values(row["values"], minimum_samples.get(row["name"], 0))
        enums.append(_enum(row, values))
    structs = []
    for row in _read("structs.toml")["struct"]:
        fields = settings_fields(options) if "from" in row else tuple(parse_field(*item) for item in row["fields"])
        flags = (row.get("sized", True), row.get("archive", False))
        structs.append(Struct(row["name"], plain(row["doc"]), fields, *flags))
    nodes = _read("nodes.toml")
    sections = tuple(Section(plain(row["title"]), tuple(_op(*op) for op in row["ops"])) for row in nodes["section"])
    node_enums = tuple(_enum(row, _values(row["values"])) for row in nodes["enum"])
    families = tuple(Family(row["title"], tuple(map(tuple, row["nodes"]))) for row in nodes["family"])
    pictures = (passes, component_passes, switches)
    schema = Schema(tuple(enums), tuple(structs), options, *pictures, sections, node_enums, families)
    check(schema)
    return schema


def settings_fields(options: tuple[Option, ...]) -> tuple[Field, ...]:
    """Returns the fields of GradusSettings."""
    fields = []
    for option in options:
        extra = {"unit": option.unit} if option.unit else {}
        if option.is_plain:
            fields.append(parse_field(option.name, option.c_type, option.doc, extra))
        elif not option.host:
            kind = {"int": "int32" if option.minimum < 0 else "uint32", "text": f"char[{int(option.maximum or 0) + 1}]"}
            fields.append(parse_field(option.name, kind.get(option.type, option.type), option.doc, extra))
    return tuple(fields)


def check(schema: Schema) -> None:
    """Raises SchemaError for items that are unknown, duplicate or have invalid numbers."""
    for struct in schema.structs:
        for item in struct.fields:
            _check_type(schema, item)
    for option in schema.options:
        if option.type not in OPTION_TYPES:
            schema.enum(option.type).number_of(option.default)
        if not option.is_plain and option.moved in (None, option.default):
            raise SchemaError(f"option {option.name} names no other value than its default in `moved`")
        if option.source == "panel" and not option.host:
            raise SchemaError(f"option {option.name} is one of GradusSettings and thus of the command line")
    _check_ops(schema)
    pictures = (schema.passes, schema.component_passes, schema.switches)
    tables = (schema.enums, schema.structs, schema.options, *pictures, schema.ops, schema.node_enums)
    tables += tuple(item.values for item in (*schema.enums, *schema.node_enums))
    for items in tables:
        names = [item.name for item in items]
        for name in names:
            if names.count(name) > 1:
                raise SchemaError(f"{name} is defined twice")
    switches = {switch.name for switch in schema.switches}
    for item in (*schema.passes, *schema.component_passes):
        if item.switch.startswith("gradus.") and item.switch.removeprefix("gradus.") not in switches:
            raise SchemaError(f"pass {item.name}: there is no switch {item.switch}")


def _check_ops(schema: Schema) -> None:
    numbers = [op.number for op in schema.ops]
    for op in schema.ops:
        if op.kind not in ("pure", "context", "program", "closure"):
            raise SchemaError(f"operation {op.name} has the unknown kind {op.kind}")
        allowed = range(FIRST_VALUE_OP) if op.is_closure else range(FIRST_VALUE_OP, OP_LIMIT)
        if op.number not in allowed:
            raise SchemaError(f"operation {op.name} has a number outside {allowed.start}…{allowed.stop - 1}")
        if numbers.count(op.number) > 1:
            raise SchemaError(f"the number {op.number} of {op.name} is used twice")
        if op.reads_ray and op.kind in ("pure", "closure"):
            raise SchemaError(f"operation {op.name} is not of the kind that can read the ray")
        if op.reads_history and not op.reads_ray:
            raise SchemaError(f"operation {op.name} reads the history of a ray, but not the ray")


def _check_type(schema: Schema, item: Field) -> None:
    known = item.base in SCALARS or schema.has_enum(item.base) or (schema.has_struct(item.base) and item.pointer)
    if not known and not (item.base == "char" and item.count):
        raise SchemaError(f"field {item.name} has the unknown type {item.base}")
