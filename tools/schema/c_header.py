"""gradus.h: its template with the structs and enums of the schema."""

from __future__ import annotations

import re
import textwrap

from model import FOLDER, Enum, Field, Schema, SchemaError, Struct, plain

WIDTH = 120

C_TYPES = {
    "int32": "int32_t",
    "uint32": "uint32_t",
    "uint64": "uint64_t",
    "size": "size_t",
    "float": "float",
    "double": "double",
    "bool": "uint32_t",
    "text": "const char*",
    "bytes": "const void*",
    "char": "char",
}


def comment(text: str) -> list[str]:
    """Returns `text` as the lines of a C comment."""
    lines = textwrap.wrap(text, WIDTH - 6, break_long_words=False, break_on_hyphens=False)
    lines = ["/* " + lines[0], *(" * " + line for line in lines[1:])]
    lines[-1] += " */"
    return lines


def rows(items: list[tuple[str, str]]) -> list[str]:
    """Returns the lines of declarations with aligned comments beside them."""
    column = max(len(declaration) for declaration, _ in items) + 1
    result = []
    for declaration, text in items:
        lines = textwrap.wrap(text, WIDTH - column - 6, break_long_words=False, break_on_hyphens=False)
        for i, line in enumerate(lines):
            start = declaration.ljust(column) + "/* " if i == 0 else " " * column + "   "
            result.append(start + line + (" */" if i == len(lines) - 1 else ""))
    return result


def c_type(schema: Schema, item: Field) -> str:
    if schema.has_enum(item.base):
        return "uint32_t"
    return C_TYPES.get(item.base, f"Gradus{item.base}")


def declaration(schema: Schema, item: Field) -> str:
    kind = c_type(schema, item)
    if item.pointer:
        kind = "const char* const*" if item.base == "text" else f"const {kind}*"
    return f"{kind} {item.name}" + (f"[{item.count}]" if item.count else "")


def field_comment(schema: Schema, item: Field) -> str:
    text = f"Gradus{item.base}: {item.doc}" if schema.has_enum(item.base) else item.doc
    return f"{text} [{item.unit}]" if item.unit else text


def struct(schema: Schema, item: Struct) -> list[str]:
    name = f"Gradus{item.name}"
    lines = [(f"  {declaration(schema, part)};", field_comment(schema, part)) for part in item.all_fields]
    return [*comment(item.doc), f"typedef struct {name} {{", *rows(lines), f"}} {name};"]


def value_name(item: Enum, name: str) -> str:
    """Returns the name of a value in C."""
    return f"GRADUS_{name}" if name in item.bare else f"GRADUS_{item.prefix}{name}"


def enum(item: Enum) -> list[str]:
    name = f"Gradus{item.name}"
    last = item.values[-1]
    lines = [(f"  {value_name(item, v.name)} = {v.number}{'' if v is last else ','}", v.doc) for v in item.values]
    return [*comment(item.doc), f"typedef enum {name} {{", *rows(lines), f"}} {name};"]


def header(schema: Schema, note: str) -> str:
    """Returns the text of gradus.h.

    Raises SchemaError unless the template declares each struct and enum once and in the order of the schema.
    """
    lines: list[str] = []
    declared: dict[str, list[str]] = {"struct": [], "enum": []}
    for line in (FOLDER / "gradus.h.in").read_text(encoding="utf-8").splitlines():
        marker = re.fullmatch(r"@(struct|enum) (\w+)", line)
        if marker:
            declared[marker[1]].append(marker[2])
            lines += struct(schema, schema.struct(marker[2])) if marker[1] == "struct" else enum(schema.enum(marker[2]))
        else:
            lines.append(line.replace("@generated", note))
    for kind, items in (("struct", schema.structs), ("enum", schema.enums)):
        if declared[kind] != [item.name for item in items]:
            raise SchemaError(f"gradus.h.in does not declare each {kind} of the schema once and in its order")
    return "\n".join(lines) + "\n"


def functions() -> list[tuple[str, str, list[str]]]:
    """Returns result, name and arguments of each function that the template declares."""
    text = re.sub(r"/\*.*?\*/", "", (FOLDER / "gradus.h.in").read_text(encoding="utf-8"), flags=re.S)
    result = []
    for kind, name, arguments in re.findall(r"GRADUS_API\s+([\w\s*]+?)\s*\b(gradus_\w+)\((.*?)\);", text, re.S):
        items = [] if arguments == "void" else arguments.split(",")
        result.append((kind, name, [plain(item) for item in items]))
    return result
