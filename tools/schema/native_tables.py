"""The generated tables of native/src/schema: layouts, archive records, options, numbers of AUTO, passes."""

from __future__ import annotations

import json
import re
import textwrap

from c_header import value_name
from model import MAX_FLOAT, MAX_INT, Enum, Field, Option, Pass, Schema, SchemaError, Struct


def _file(note: str, purpose: str, includes: list[str], namespace: str, body: list[str], guard: bool = False) -> str:
    """Returns a C++ file. Its tables are not formatted by clang-format."""
    lines = [f"// {purpose}", f"// {note}", *(["#pragma once"] if guard else []), "", *includes, ""]
    lines += ["// clang-format off", f"namespace {namespace} {{", *body, f"}}  // namespace {namespace}"]
    return "\n".join([*lines, "// clang-format on", ""])


def layout(schema: Schema, note: str) -> str:
    """Returns layout_table.cpp, the data of gradus_struct_layout and gradus_abi_hash."""
    body = ["namespace {", "", "#define FIELD(type, field) {#field, offsetof(type, field), sizeof(type::field)}", ""]
    for item in schema.structs:
        body.append(f"constexpr FieldLayout k{item.name}Fields[] = {{")
        body += [f"    FIELD(Gradus{item.name}, {part.name})," for part in item.all_fields]
        body += ["};", ""]
    for item in schema.enums:
        body.append(f"constexpr int64_t k{item.name}Values[] = {{")
        body += [*(f"    {value_name(item, value.name)}," for value in item.values), "};", ""]
    body.append("constexpr StructLayout kStructs[] = {")
    body += [f'    {{"{item.name}", sizeof(Gradus{item.name}), k{item.name}Fields}},' for item in schema.structs]
    body += ["};", "", "constexpr EnumLayout kEnums[] = {"]
    body += [*(f'    {{"{item.name}", k{item.name}Values}},' for item in schema.enums), "};", "", "}  // namespace", ""]
    body += ["std::span<const StructLayout> struct_layouts() { return kStructs; }"]
    body += ["std::span<const EnumLayout> enum_layouts() { return kEnums; }", ""]
    includes = ['#include "schema/layout.h"', "", '#include "gradus/gradus.h"']
    return _file(
        note, "Layouts of the public structs and values of the public enums.", includes, "gradus::schema", body
    )


def _factor(text: str, struct: str, owner: str) -> str:
    """Returns a factor of a length in C++.

    It is a number, a field or elements(domain); `owner.` stands for the struct that contains `struct`.
    """
    holder = owner if text.startswith("owner.") else struct
    name = text.removeprefix("owner.")
    elements = re.fullmatch(r"elements\((\w+)\)", name)
    if elements:
        return f"geometry::domain_size({holder}, {struct}.{elements[1]})"
    return f"uint64_t{{{name}}}" if name.isdigit() else f"{holder}.{name}"


def length(item: Field, struct: str = "s", owner: str = "") -> str:
    """Returns the number of elements of an array as a 64-bit expression in C++."""
    if not item.length:
        raise SchemaError(f"the array {item.name} of an archived struct has no length")
    factors = [_factor(text.strip(), struct, owner) for text in item.length.split("*")]
    if len(factors) > 1 and not factors[0].startswith("uint64_t"):
        factors[0] = f"uint64_t{{{factors[0]}}}"
    return " * ".join(factors)


def _is_struct(schema: Schema, item: Field) -> bool:
    return schema.has_struct(item.base)


def _values(item: Struct) -> list[str]:
    """Returns the statements that visit the numbers of a struct."""
    parts = [f for f in item.fields if not f.pointer and f.base not in ("text", "bytes") and f.name != "reserved"]
    return [f"  a.{'values' if part.count else 'value'}(s.{part.name});" for part in parts]


def _texts(item: Struct) -> list[str]:
    lines = []
    for part in item.fields:
        if part.base != "text" or part.pointer:
            continue
        if part.nullable:
            lines += [f"  uint32_t has_{part.name} = s.{part.name} != nullptr;", f"  a.value(has_{part.name});"]
            lines.append(f"  if (has_{part.name} != 0) a.text(s.{part.name});")
        else:
            lines.append(f"  a.text(s.{part.name});")
    return lines


def _array(schema: Schema, part: Field) -> list[str]:
    if part.base == "bytes":
        return [
            f"  const char* {part.name} = static_cast<const char*>(s.{part.name});",
            f"  a.array({part.name}, {length(part)});",
            f"  s.{part.name} = {part.name};",
        ]
    if part.base == "text":
        return [f"  a.texts(s.{part.name}, {length(part)});"]
    if not _is_struct(schema, part):
        return [f"  a.array(s.{part.name}, {length(part)});"]
    lines = [f"  a.structs(s.{part.name}, {length(part)});"]
    owned = [inner for inner in schema.struct(part.base).fields if "owner." in inner.length]
    if owned:
        lines.append(f"  for (uint64_t i = 0; i < {length(part)}; ++i) {{")
        lines.append(f"    auto& item = const_cast<Gradus{part.base}&>(s.{part.name}[i]);")
        lines += [f"    a.array(item.{inner.name}, {length(inner, 'item', 's')});" for inner in owned]
        lines.append("  }")
    return lines


def _arrays(schema: Schema, item: Struct) -> list[str]:
    lines = []
    for part in item.fields:
        if (part.pointer or part.base == "bytes") and "owner." not in part.length:
            lines += _array(schema, part)
    return lines


def archive(schema: Schema, note: str) -> str:
    """Returns archive_records.h, which has one visit() for each struct of the scene calls."""
    body = [""]
    for item in schema.structs:
        if item.archive:
            body += ["template <class Archive>", f"void visit(Archive& a, Gradus{item.name}& s) {{"]
            body += ["  s.struct_size = sizeof(s);"] if item.sized else []
            body += [*_values(item), *_texts(item), *_arrays(schema, item), "}", ""]
    purpose = "visit() for every struct of the scene calls; see api/archive.h. A change needs another kSceneFormat."
    includes = ['#include "geometry/mesh.h"', '#include "gradus/gradus.h"']
    return _file(note, purpose, includes, "gradus::api", body, guard=True)


def _limit(option: Option) -> float:
    if option.maximum is not None:
        return option.maximum
    return {"float": MAX_FLOAT, "bool": 1}.get(option.type, MAX_INT)


OPTION_TYPES = {"int": "INT", "float": "FLOAT", "bool": "BOOL", "text": "TEXT"}


def _number(value: float) -> str:
    return repr(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(value)


def _option(schema: Schema, option: Option) -> str:
    low, high, default, choices = option.minimum, _limit(option), option.default, "{}"
    if option.type not in OPTION_TYPES:
        kind = schema.enum(option.type)
        numbers = [value.number for value in kind.values]
        low, high, default, choices = min(numbers), max(numbers), kind.number_of(option.default), f"k{kind.name}Choices"
    if option.type == "text":
        default = 0
    numbers = f"{_number(float(default))}, {_number(low)}, {_number(high)}"
    sampling = "true" if option.sampling else "false"
    kind = f"GRADUS_OPTION_{OPTION_TYPES.get(option.type, 'ENUM')}"
    row = f"    OPTION({option.name}, {kind}, {numbers}, {choices}, {sampling},"
    return "\n".join([row, *_literal(_doc(schema, option), "           ")]) + "),"


def _literal(text: str, indent: str) -> list[str]:
    """Returns `text` as string literals, one on each line."""
    lines = textwrap.wrap(text, 105, drop_whitespace=False, break_long_words=False, break_on_hyphens=False)
    return [indent + json.dumps(line, ensure_ascii=False) for line in lines]


def _doc(schema: Schema, option: Option) -> str:
    """Returns the description of an option at run time, with the values of an enum."""
    if option.type in OPTION_TYPES:
        return option.doc
    values = [f"{value.name.lower()}: {value.doc}" for value in schema.enum(option.type).values]
    return " ".join([option.doc, *values])


def _choices(item: Enum) -> list[str]:
    rows = [f'    {{"{value.name.lower()}", {value_name(item, value.name)}}},' for value in item.values]
    return [f"constexpr Choice k{item.name}Choices[] = {{", *rows, "};", ""]


def options(schema: Schema, note: str) -> str:
    """Returns option_table.cpp, the options of GradusSettings."""
    kinds = [option.type for option in schema.native_options if option.type not in OPTION_TYPES]
    body = ["namespace {", ""]
    for name in dict.fromkeys(kinds):
        body += _choices(schema.enum(name))
    body += ["#define OPTION(field, type, value, low, high, choices, sampling, doc) \\"]
    body += ["  {#field, type, offsetof(GradusSettings, field), value, low, high, choices, sampling, doc}", ""]
    body += ["constexpr Option kOptions[] = {", *(_option(schema, item) for item in schema.native_options), "};"]
    body += ["", "}  // namespace", "", "std::span<const Option> options() { return kOptions; }", ""]
    return _file(note, "The options of GradusSettings.", ['#include "schema/options.h"'], "gradus::schema", body)


def automatic(schema: Schema, note: str) -> str:
    """Returns automatic.h, the numbers by which AUTO is decided."""
    body = [""]
    for option in schema.options:
        if option.minimum_samples:
            body.append(f"// Samples per pixel from which AUTO of the option {option.name} does something.")
            name = option.name.title().replace("_", "")
            body.append(f"inline constexpr uint32_t k{name}MinimumSamples = {option.minimum_samples};")
    purpose = "The numbers by which AUTO is decided; see output/options.h."
    return _file(note, purpose, ["#include <cstdint>"], "gradus::schema", [*body, ""], guard=True)


def _pass(item: Pass) -> str:
    color = f"GRADUS_PASS_{item.color}" if item.color else "GRADUS_PASS_COUNT"
    kind = f"PassKind::{item.kind.title()}"
    return f'    {{GRADUS_PASS_{item.name}, "{item.label}", "{item.channels}", {kind}, {color}}},'


def _component_pass(item: Pass) -> str:
    return f'    {{GRADUS_COMPONENT_{item.name}, "{item.label}", "{item.channels}"}},'


def passes(schema: Schema, note: str) -> str:
    """Returns pass_rows.cpp, the passes in the order of their numbers."""
    body = ["namespace {", "", "constexpr PassInfo kPasses[] = {"]
    body += [_pass(item) for item in sorted(schema.passes, key=lambda item: item.number)]
    body += ["};", "", "constexpr ComponentPassInfo kComponentPasses[] = {"]
    body += [_component_pass(item) for item in sorted(schema.component_passes, key=lambda item: item.number)]
    body += ["};", "", "}  // namespace", "", "std::span<const PassInfo> all_passes() { return kPasses; }"]
    body += ["std::span<const ComponentPassInfo> all_component_passes() { return kComponentPasses; }", ""]
    purpose = "The passes of a picture and of its components."
    return _file(note, purpose, ['#include "schema/pass_table.h"'], "gradus::schema", body)
