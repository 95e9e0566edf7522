"""H1, H2, H3: the ctypes declarations agree with the library."""

from __future__ import annotations

import ctypes
from ctypes import byref

import pytest
from gradus import abi, native


def test_h1_hash_is_the_library_s() -> None:
    assert native.load().abi_hash() == abi.layout_hash()


def test_h1_hash_sees_a_moved_field() -> None:
    text = abi.layout_text()
    assert abi.layout_hash(
        text.replace("DeviceSettings:24:0,4,8,16;", "DeviceSettings:24:0,4,16,8;")
    ) != abi.layout_hash(text)
    assert abi.layout_hash("a") == 0xAF63DC4C8601EC8C  # published test value of FNV-1a


def test_h2_bound_functions_carry_their_types() -> None:
    library = native.load()
    for name, (restype, argtypes) in abi.FUNCTIONS.items():
        function = getattr(library, name.removeprefix("gradus_"))
        assert function.argtypes == argtypes
        assert function.restype is restype


def test_h3_older_and_newer_callers() -> None:
    """The library reads struct_size first, so that it refuses a newer caller's larger struct with a code."""
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
