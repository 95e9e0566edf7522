"""H1, H2: the ctypes declarations against the header, and both against the library."""

from __future__ import annotations

import ctypes
import re
from ctypes import POINTER, byref, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p
from pathlib import Path
from typing import Any

import pytest
from gradus import abi, native

HEADER = Path(__file__).resolve().parents[2] / "native" / "include" / "gradus" / "gradus.h"
SCALARS = {
    "uint32_t": c_uint32,
    "int32_t": c_int32,
    "uint64_t": c_uint64,
    "float": c_float,
    "double": c_double,
    "size_t": c_size_t,
    "GradusError": c_int,
    "GradusDevice": c_uint64,
    "GradusScene": c_uint64,
    "GradusRender": c_uint64,
    "GradusFrame": c_uint64,
}


def header_text() -> str:
    text = re.sub(r"/\*.*?\*/", "", HEADER.read_text(), flags=re.S)
    return re.sub(r"^#.*$", "", text, flags=re.M)


def ctype_of(declaration: str) -> Any:
    """The ctypes type that a declaration of the header asks for: `const float* const* name[3]` and the like."""
    plain = re.sub(r"\b(const|volatile)\b", " ", declaration)
    match = re.fullmatch(r"\s*(\w+)\s*([*\s]*)(\w*)\s*(?:\[(\d+)\])?\s*", plain)
    assert match, declaration
    name, stars, _, count = match.group(1), match.group(2).count("*"), match.group(3), match.group(4)
    if name == "char" and count:
        kind: Any = c_char
    elif name in ("char", "void"):
        kind = {"char": c_char_p, "void": c_void_p}[name]
        stars -= 1
    else:
        kind = SCALARS[name] if name in SCALARS else getattr(abi, name.removeprefix("Gradus"))
    for _ in range(stars):
        kind = POINTER(kind)
    return kind * int(count) if count else kind


def same_type(one: Any, other: Any) -> bool:
    if one is other:
        return True
    if hasattr(one, "_length_") and hasattr(other, "_length_"):
        return one._length_ == other._length_ and same_type(one._type_, other._type_)
    return hasattr(one, "contents") and hasattr(other, "contents") and same_type(one._type_, other._type_)


STRUCTS = {m[0]: m[1] for m in re.findall(r"typedef struct Gradus(\w+) \{(.*?)\} Gradus\w+;", header_text(), re.S)}
ENUMS = {m[0]: m[1] for m in re.findall(r"typedef enum Gradus(\w+) \{(.*?)\}", header_text(), re.S)}
FUNCTIONS = re.findall(r"GRADUS_API\s+([\w\s*]+?)\s*\b(gradus_\w+)\((.*?)\);", header_text(), re.S)


def test_h1_all_structs_are_declared_in_order() -> None:
    assert [kind.__name__ for kind in abi.STRUCTS] == list(STRUCTS)
    assert [kind.__name__ for kind in abi.ENUMS] == list(ENUMS)


@pytest.mark.parametrize("name", list(STRUCTS))
def test_h1_struct_fields(name: str) -> None:
    declared = getattr(abi, name)._fields_
    expected = [line.strip() for line in STRUCTS[name].split(";") if line.strip()]
    assert [field[0] for field in declared] == [re.search(r"(\w+)\s*(\[\d+\])?$", line).group(1) for line in expected]
    for (field, kind), line in zip(declared, expected, strict=True):
        assert same_type(kind, ctype_of(line)), f"{name}.{field}: {line}"


@pytest.mark.parametrize("name", list(ENUMS))
def test_h1_enum_values(name: str) -> None:
    value, expected = -1, []
    for entry in filter(None, (part.strip() for part in ENUMS[name].split(","))):
        label, _, number = entry.partition("=")
        value = int(number) if number else value + 1
        expected.append((label.strip(), value))
    members = list(getattr(abi, name).__members__.items())
    assert [value for _, value in expected] == [int(value) for _, value in members]
    for (label, _), (member, _) in zip(expected, members, strict=True):
        assert label.endswith(f"_{member}")


@pytest.mark.parametrize("name", list(STRUCTS))
def test_h1_struct_layout(name: str) -> None:
    library = native.load()
    size, count = c_size_t(), c_size_t()
    offsets = (c_size_t * 64)()
    library.struct_layout(name.encode(), byref(size), offsets, len(offsets), byref(count))
    kind = getattr(abi, name)
    assert size.value == ctypes.sizeof(kind)
    assert list(offsets[: count.value]) == [getattr(kind, field[0]).offset for field in kind._fields_]


def test_h1_hash_is_the_library_s() -> None:
    assert native.load().abi_hash() == abi.layout_hash()


def test_h1_hash_sees_a_moved_field() -> None:
    text = abi.layout_text()
    assert abi.layout_hash(text.replace("DeviceSettings:24:0,4,8,16;", "DeviceSettings:24:0,4,16,8;")) != abi.layout_hash(text)
    assert abi.layout_hash("a") == 0xAF63DC4C8601EC8C  # published test value of FNV-1a


def test_h2_every_function_is_declared() -> None:
    assert list(abi.FUNCTIONS) == [name for _, name, _ in FUNCTIONS]


@pytest.mark.parametrize("function", FUNCTIONS, ids=[name for _, name, _ in FUNCTIONS])
def test_h2_argtypes(function: tuple[str, str, str]) -> None:
    result, name, arguments = function
    restype, argtypes = abi.FUNCTIONS[name]
    assert same_type(restype, ctype_of(result))
    expected = [] if arguments.strip() in ("", "void") else [ctype_of(argument) for argument in arguments.split(",")]
    assert len(argtypes) == len(expected)
    for declared, wanted in zip(argtypes, expected, strict=True):
        assert same_type(declared, wanted)


def test_h2_bound_functions_carry_their_types() -> None:
    library = native.load()
    for name, (restype, argtypes) in abi.FUNCTIONS.items():
        function = getattr(library, name.removeprefix("gradus_"))
        assert function.argtypes == argtypes
        assert function.restype is restype


def test_h3_older_and_newer_callers() -> None:
    """struct_size first: a newer caller's larger struct is refused with a code, not read."""
    library = native.load()
    settings = native.Settings()
    library.settings_default(byref(settings))
    settings.struct_size = ctypes.sizeof(settings) + 8
    with pytest.raises(native.GradusError) as caught:
        library.settings_default(byref(settings))
    assert caught.value.code == native.Error.INVALID_ARGUMENT
    settings.struct_size = native.Settings.passes.offset
    library.settings_default(byref(settings))
    assert settings.samples == 64


def test_an_unknown_function_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError):
        native.load().no_such_function  # noqa: B018
