"""gradus_nodes.h and ops.py: the operations of the node program and their modes."""

from __future__ import annotations

import re
import textwrap

from c_header import WIDTH, enum
from model import FOLDER, Op, Schema, SchemaError
from python_abi import enum_class

NAMES = 18  # columns for the names of operations in the header's comment


def describe(op: Op) -> list[str]:
    """An operation as lines of the header's comment."""
    shape = f"{', '.join(op.inputs) or '-'} -> {', '.join(op.outputs)}"
    text = f"{shape}: {op.doc} {op.parameters}".strip()
    start, indent = f" *   {op.name.ljust(NAMES)}", f" *   {' ' * NAMES}  "
    return textwrap.wrap(text, WIDTH, initial_indent=start, subsequent_indent=indent, break_on_hyphens=False)


def prose(schema: Schema) -> list[str]:
    """All operations as lines of a comment."""
    lines: list[str] = []
    for section in schema.sections:
        lines += [*([" *"] if lines else []), f" * {section.title}"]
        for op in section.ops:
            lines += describe(op)
    return lines


def table(schema: Schema) -> list[str]:
    rows = []
    for op in schema.ops:
        rows.append(f"  X({op.name}, {op.number}, {len(op.inputs)}, {len(op.outputs)}, {int(op.is_closure)})")
    return ["#define GRADUS_OPS(X) \\", *(row + " \\" for row in rows[:-1]), rows[-1]]


def header(schema: Schema, note: str) -> str:
    """The text of gradus_nodes.h. Each enum has to be declared once."""
    lines: list[str] = []
    enums = {item.name: item for item in schema.node_enums}
    for line in (FOLDER / "gradus_nodes.h.in").read_text(encoding="utf-8").splitlines():
        marker = re.fullmatch(r"@enum (\w+)", line)
        if marker and marker[1] not in enums:
            raise SchemaError(f"gradus_nodes.h.in declares {marker[1]} twice, or nodes.toml has no such enum")
        if marker:
            lines += enum(enums.pop(marker[1]))
        elif line in ("@ops", "@table"):
            lines += prose(schema) if line == "@ops" else table(schema)
        else:
            lines.append(line.replace("@generated", note))
    if enums:
        raise SchemaError(f"gradus_nodes.h.in does not declare {', '.join(enums)}")
    return "\n".join(lines) + "\n"


def module(schema: Schema, note: str) -> str:
    """The text of ops.py."""
    lines = ['"""Operations of the node program and their modes, as in gradus_nodes.h.', "", note, '"""', ""]
    lines += ["from __future__ import annotations", "", "from enum import IntEnum", "", "", "class Op(IntEnum):"]
    lines += ['    """Operation of a node."""', "", *(f"    {op.name} = {op.number}" for op in schema.ops)]
    for item in schema.node_enums:
        lines += enum_class(item)
    lines += ["", "", "INPUTS = {", *(f"    Op.{op.name}: {len(op.inputs)}," for op in schema.ops), "}"]
    lines += ['"""Number of inputs."""', "", "OUTPUTS = {"]
    lines += [*(f"    Op.{op.name}: {len(op.outputs)}," for op in schema.ops), "}", '"""Number of outputs."""', ""]
    return "\n".join(lines)
