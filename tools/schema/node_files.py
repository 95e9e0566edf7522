"""gradus_nodes.h, ops.py and the tables of native/src/shading: the operations of the node program and their modes."""

from __future__ import annotations

import re
import textwrap

from c_header import WIDTH, enum
from model import FIRST_VALUE_OP, FOLDER, OP_LIMIT, Op, Schema, SchemaError
from python_abi import enum_class

NAMES = 18  # columns for the names of operations in the header's comment


def describe(op: Op) -> list[str]:
    """Returns an operation as lines of the header's comment."""
    shape = f"{', '.join(op.inputs) or '-'} -> {', '.join(op.outputs)}"
    text = f"{shape}: {op.doc} {op.text}".strip()
    start, indent = f" *   {op.name.ljust(NAMES)}", f" *   {' ' * NAMES}  "
    return textwrap.wrap(text, WIDTH, initial_indent=start, subsequent_indent=indent, break_on_hyphens=False)


def prose(schema: Schema) -> list[str]:
    """Returns all operations as lines of a comment."""
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
    """Returns the text of gradus_nodes.h. Raises SchemaError unless the template declares each enum once."""
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
    """Returns the text of ops.py."""
    lines = ['"""Operations of the node program and their modes, as in gradus_nodes.h.', "", note, '"""', ""]
    lines += ["from __future__ import annotations", "", "from enum import IntEnum", "", "", "class Op(IntEnum):"]
    lines += ['    """Operation of a node."""', "", *(f"    {op.name} = {op.number}" for op in schema.ops)]
    for item in schema.node_enums:
        lines += enum_class(item)
    lines += ["", "", "INPUTS = {", *(f"    Op.{op.name}: {len(op.inputs)}," for op in schema.ops), "}"]
    lines += ['"""Number of inputs."""', "", "OUTPUTS = {"]
    lines += [*(f"    Op.{op.name}: {len(op.outputs)}," for op in schema.ops), "}", '"""Number of outputs."""', ""]
    return "\n".join(lines)


PURE = "const OpArgs& args, Vec4* out"
CONTEXT = "const ResourceArgs& args, const ShadeContext& context, Vec4* out"


def functions(schema: Schema, note: str) -> str:
    """Returns the text of op_functions.h, which declares the functions that evaluate operations."""
    lines = [
        "// The functions of the operations in gradus_nodes.h. Each writes all outputs of its operation to `out`.",
        f"// {note}",
        "#pragma once",
        "",
        '#include "shading/ops.h"',
        "",
        "namespace gradus::shading {",
        "",
        "// Pure operations, whose result depends on their inputs alone.",
        *(f"void {op.function}({PURE});" for op in schema.ops if op.kind == "pure"),
        "",
        "// Operations that depend on the point, the ray, the object or an image.",
        *(f"void {op.function}({CONTEXT});" for op in schema.ops if op.kind == "context"),
        "",
        "}  // namespace gradus::shading",
        "",
    ]
    return "\n".join(lines)


def _modes(member: str, modes: bool | list[str]) -> list[str]:
    """Returns the assignment of a set of modes; a member that no line assigns is empty."""
    if isinstance(modes, bool):
        return [f"  {member} = kAllModes;"] if modes else []
    line = f"  {member} = modes({{{', '.join(modes)}}});"
    if len(line) <= WIDTH:
        return [line]
    start, values = line.split("{")
    return [start, *textwrap.wrap("{" + values, WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 7)]


def _row(op: Op) -> list[str]:
    values = [f'"{op.name}"', f"OpKind::{op.kind.title()}", len(op.inputs), len(op.outputs), op.floats, op.last_mode]
    entry = f"table[GRADUS_OP_{op.name}]"
    row = f"  {entry} = {{{', '.join(map(str, values))}}};"
    return [row, *_modes(f"{entry}.ray_modes", op.reads_ray), *_modes(f"{entry}.history_modes", op.reads_history)]


def _switch(schema: Schema, kind: str, arguments: str) -> list[str]:
    """Returns the body of a function that calls the function of operation `op` and returns whether it exists."""
    lines = ["  switch (op) {"]
    for op in schema.ops:
        if op.kind == kind:
            lines += [f"    case GRADUS_OP_{op.name}:", f"      {op.function}({arguments});", "      return true;"]
    return [*lines, "    default:", "      return false;", "  }"]


def op_table(schema: Schema, note: str) -> str:
    """Returns the text of op_table.cpp: the table of operations, and the functions that dispatch to them."""
    inputs, outputs = max(len(op.inputs) for op in schema.ops), max(len(op.outputs) for op in schema.ops)
    lines = [
        "// The table of the operations of gradus_nodes.h, and the choice of the function that evaluates one.",
        f"// {note}",
        "#include <initializer_list>",
        "",
        '#include "shading/op_functions.h"',
        '#include "shading/op_info.h"',
        '#include "shading/program.h"',
        "",
        "namespace gradus::shading {",
        "namespace {",
        "",
        f"static_assert(kFirstValueOp == {FIRST_VALUE_OP} && GRADUS_OP_LIMIT == {OP_LIMIT});",
        f"static_assert(kMaxInputs >= {inputs} && kMaxOutputs >= {outputs});",
        "",
        "constexpr ModeSet modes(std::initializer_list<uint32_t> list) {",
        "  ModeSet set = 0;",
        "  for (const uint32_t mode : list) set |= ModeSet{1} << mode;",
        "  return set;",
        "}",
        "",
        "constexpr std::array<OpInfo, GRADUS_OP_LIMIT> make_table() {",
        "  std::array<OpInfo, GRADUS_OP_LIMIT> table{};",
        *(line for op in schema.ops for line in _row(op)),
        "  return table;",
        "}",
        "",
        "}  // namespace",
        "",
        "extern constexpr std::array<OpInfo, GRADUS_OP_LIMIT> kOpTable = make_table();",
        "",
        f"bool evaluate_pure(uint32_t op, {PURE}) {{",
        *_switch(schema, "pure", "args, out"),
        "}",
        "",
        f"bool evaluate_context(uint32_t op, {CONTEXT}) {{",
        *_switch(schema, "context", "args, context, out"),
        "}",
        "",
        "}  // namespace gradus::shading",
        "",
    ]
    return "\n".join(lines)
