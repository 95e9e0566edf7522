"""Blender's OpenColorIO as the library calls it, and what happens without it."""

from __future__ import annotations

import ctypes
import sys
from types import SimpleNamespace
from typing import Any

import bpy
import pytest
from gradus import color, compat, native, store

HAS_HOST_COLORS = bpy.app.version >= (4, 5, 0)


@pytest.fixture
def colors() -> color.HostColors:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    found = color.host_colors(compat.bundled_python_packages())
    if found is None:
        pytest.skip("this Blender brings no PyOpenColorIO along")
    return found


class Library:
    """Takes the conversions that are set."""

    def __init__(self) -> None:
        self.conversions: dict[str, Any] = {}

    def device_set_color_space(self, _device: int, name: bytes, convert: Any, _context: None) -> None:
        self.conversions[name.decode()] = convert

    def convert(self, name: str, *rgba: float) -> list[float]:
        pixels = (ctypes.c_float * len(rgba))(*rgba)
        self.conversions[name](None, ctypes.addressof(pixels), len(rgba) // 4)
        return list(pixels)


def test_hosts_with_python_colours() -> None:
    assert (color.host_colors(compat.bundled_python_packages()) is not None) == HAS_HOST_COLORS


def test_spaces_are_converted_by_blender_s_configuration(colors: color.HostColors) -> None:
    library = Library()
    colors.define(library, 1, ["sRGB", "ACEScg", "no such space"])
    assert sorted(library.conversions) == ["ACEScg", "sRGB"]
    grey = ((0.5 + 0.055) / 1.055) ** 2.4
    assert library.convert("sRGB", 0.5, 0.0, 1.0, 0.25) == pytest.approx([grey, 0.0, 1.0, 0.25], abs=1e-4)
    # The red primary of ACEScg in linear Rec. 709, twice, and beyond 1.
    assert library.convert("ACEScg", *(4.0, 0.0, 0.0, 1.0) * 2)[4] == pytest.approx(4.0 * 1.7050, abs=1e-2)


def test_spaces_are_defined_once(colors: color.HostColors) -> None:
    library = Library()
    colors.define(library, 1, ["sRGB"])
    first = library.conversions.pop("sRGB")
    colors.define(library, 1, ["sRGB"])
    assert first is not None and library.conversions == {}


class BrokenConfig:
    """A configuration whose conversions fail when they see pixels."""

    def getColorSpace(self, name: str) -> str:  # noqa: N802
        return name

    def getProcessor(self, _source: str, _target: str) -> BrokenConfig:  # noqa: N802
        return self

    def getDefaultCPUProcessor(self) -> BrokenConfig:  # noqa: N802
        return self

    def apply(self, _image: object) -> None:
        raise MemoryError("no room for a table")


def test_a_conversion_that_fails_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The exception ended in the function that the library calls, and images stayed unconverted without a word."""
    ocio = SimpleNamespace(Exception=RuntimeError, PackedImageDesc=lambda *_: None)
    broken = color.HostColors(ocio, BrokenConfig())
    library = native.load()
    store.clear()
    monkeypatch.setattr(color, "host_colors", lambda _: broken)
    session = store.acquire(store.Key(store.FINAL, "Scene", "ViewLayer", 0))
    broken.define(library, session.device, ["Broken"])
    (text,) = session.take_new_warnings([])
    assert "Broken" in text and "no room for a table" in text
    assert session.device_warnings() == [text]  # so that a strict render refuses it
    assert session.take_new_warnings([]) == []
    store.clear()


def test_the_working_space_is_rec709_by_default(colors: color.HostColors) -> None:
    assert colors.working_space() is None


def test_the_luminance_of_a_working_space(colors: color.HostColors) -> None:
    if not hasattr(bpy.data, "colorspace"):
        pytest.skip("this Blender has no working spaces")
    bpy.ops.wm.set_working_color_space(working_space="Linear Rec.2020", convert_colors=False)
    space = colors.working_space()
    assert space is not None
    assert space.luminance == pytest.approx((0.2627, 0.6780, 0.0593), abs=1e-4)  # ITU-R BT.2020
    assert [sum(row) for row in space.from_rec709] == pytest.approx([1.0, 1.0, 1.0], abs=1e-4)


def test_a_session_follows_the_working_space(scene: bpy.types.Scene) -> None:
    if not hasattr(bpy.data, "colorspace"):
        pytest.skip("this Blender has no working spaces")
    key = store.Key(store.FINAL, scene.name, "ViewLayer", 0)
    first = store.acquire(key)
    assert store.acquire(key) is first
    bpy.ops.wm.set_working_color_space(working_space="ACEScg", convert_colors=False)
    assert store.acquire(key).device != first.device
    store.clear()


@pytest.mark.parametrize("config", [SimpleNamespace(hasRole=lambda _: False), None])
def test_without_a_configuration_the_library_reads_it(monkeypatch: pytest.MonkeyPatch, config: Any) -> None:
    """A process of its own OpenColorIO would have an empty configuration."""
    monkeypatch.setitem(sys.modules, "PyOpenColorIO", SimpleNamespace(GetCurrentConfig=lambda: config))
    assert color.host_colors("") is None


def test_the_device_has_no_warnings_about_blender_s_configuration() -> None:
    library = native.load()
    store.clear()
    assert library.take_device_warnings(store.device(library)) == []
