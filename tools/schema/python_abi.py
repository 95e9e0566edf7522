"""abi.py: the structs, enums and functions of gradus.h as ctypes declarations."""

from __future__ import annotations

import re

from c_header import functions
from model import Enum, Field, Schema, SchemaError, Struct

C_TYPES = {
    "int32": "c_int32",
    "uint32": "c_uint32",
    "uint64": "c_uint64",
    "size": "c_size_t",
    "float": "c_float",
    "double": "c_double",
    "bool": "c_uint32",
    "text": "c_char_p",
    "bytes": "c_void_p",
    "char": "c_char",
}
ARGUMENTS = {
    "uint32_t": "c_uint32",
    "int32_t": "c_int32",
    "uint64_t": "c_uint64",
    "size_t": "c_size_t",
    "float": "c_float",
    "double": "c_double",
    "GradusError": "c_int",
    "GradusConvertColors": "ConvertColors",
}
HANDLES = ("Device", "Scene", "Render", "Sequence", "Film")

HEAD = '''"""The structs, enums and functions of gradus.h as ctypes declarations, by the header's names without prefix.

{note}

Only declarations: native.py loads the library and calls it.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p
from enum import IntEnum, IntFlag
from typing import Any

VERSION = {version}

ConvertColors = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)
"""A function that converts colours: its context, the address of the pixels and their number."""
'''

STRUCT = '''

class Struct(ctypes.Structure):
    """Base of all structs: fills struct_size, without which the library refuses the struct."""

    _fields_: list[tuple[str, Any]] = []

    def __init__(self, *args: Any, **fields: Any) -> None:
        super().__init__(*args, **fields)
        if not args and self._fields_ and self._fields_[0][0] == "struct_size":
            self.struct_size = ctypes.sizeof(self)
'''

TAIL = '''
"""(restype, argtypes) of every function of the header."""

RETURNS_CODE = frozenset(name for name, row in FUNCTIONS.items() if row[0] is c_int and name != "gradus_error")
"""Functions that return a GradusError that says whether they failed; gradus_error returns the thread's first one."""


def layout_text() -> str:
    """The text that the ABI hash is formed of (see gradus_abi_hash in gradus.h)."""
    parts = []
    for struct in STRUCTS:
        offsets = ",".join(str(getattr(struct, field[0]).offset) for field in struct._fields_)
        parts.append(f"{struct.__name__}:{ctypes.sizeof(struct)}:{offsets};")
    for enum in ENUMS:
        parts.append(f"{enum.__name__}:{','.join(str(int(value)) for value in enum.__members__.values())};")
    return "".join(parts)


def layout_hash(text: str | None = None) -> int:
    """FNV-1a, 64 bit (Fowler, Noll, Vo), of `text` or of layout_text()."""
    value = 0xCBF29CE484222325
    for byte in (layout_text() if text is None else text).encode("ascii"):
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value
'''


def docstring(text: str, indent: str) -> list[str]:
    """Returns `text` as a docstring, on one line if it fits."""
    one = f'{indent}"""{text}"""'
    if len(one) <= 120:
        return [one]
    lines, rest = [], f'"""{text}'
    while len(indent + rest) > 117:
        cut = rest.rindex(" ", 0, 120 - len(indent))
        lines.append(indent + rest[:cut])
        rest = rest[cut + 1 :]
    return [*lines, indent + rest, f'{indent}"""']


def enum_class(item: Enum) -> list[str]:
    base = "IntFlag" if item.flags else "IntEnum"
    values = [f"    {value.name} = {value.number}" for value in item.values]
    return ["", "", f"class {item.python or item.name}({base}):", *docstring(item.doc, "    "), "", *values]


def field_type(schema: Schema, item: Field) -> str:
    kind = "c_uint32" if schema.has_enum(item.base) else C_TYPES.get(item.base, item.base)
    if item.pointer:
        return f"POINTER({kind})"
    return f"{kind} * {item.count}" if item.count else kind


def struct_class(schema: Schema, item: Struct) -> list[str]:
    lines = ["", "", f"class {item.name}(Struct):", *docstring(item.doc, "    "), "", "    _fields_ = ["]
    return [*lines, *(f'        ("{part.name}", {field_type(schema, part)}),' for part in item.all_fields), "    ]"]


def argument_type(schema: Schema, text: str) -> str:
    """Returns the ctypes type of a declaration such as `const char* const* names`."""
    match = re.fullmatch(r"(\w+)([* ]*)(\w*)", re.sub(r"\b(const|volatile) ?", "", text).strip())
    if not match:
        raise SchemaError(f"gradus.h.in: no type is known for '{text}'")
    name, stars = match[1], match[2].count("*")
    if name in {"char", "void"}:
        kind, stars = f"c_{name}_p", stars - 1
    elif name in ARGUMENTS:
        kind = ARGUMENTS[name]
    elif name.removeprefix("Gradus") in HANDLES or schema.has_struct(name.removeprefix("Gradus")):
        kind = name.removeprefix("Gradus")
    else:
        raise SchemaError(f"gradus.h.in: no type is known for '{text}'")
    for _ in range(stars):
        kind = f"POINTER({kind})"
    return kind


def function_rows(schema: Schema) -> list[str]:
    lines = []
    for result, name, arguments in functions():
        types = ", ".join(argument_type(schema, argument) for argument in arguments)
        row = f'    "{name}": ({argument_type(schema, result)}, [{types}]),'
        if len(row) > 120:
            lines += [f'    "{name}": (', f"        {argument_type(schema, result)},", f"        [{types}],", "    ),"]
        else:
            lines.append(row)
    return lines


def module(schema: Schema, note: str, version: tuple[int, int, int]) -> str:
    """Returns the text of abi.py."""
    lines = HEAD.format(note=note, version=version).splitlines()
    for item in schema.enums:
        lines += enum_class(item)
    lines += STRUCT.splitlines()
    for item in schema.structs:
        lines += struct_class(schema, item)
    lines += ["", "", "STRUCTS: tuple[type[Struct], ...] = (", *(f"    {item.name}," for item in schema.structs)]
    lines += [")", "", "ENUMS: tuple[type[IntEnum] | type[IntFlag], ...] = ("]
    lines += [*(f"    {item.name}," for item in schema.enums), ")", ""]
    lines += [" = ".join(HANDLES) + " = c_uint64  # handles are values, never addresses", ""]
    lines += ["FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {", *function_rows(schema), "}"]
    return "\n".join(lines) + TAIL
