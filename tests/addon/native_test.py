"""Libraries that cannot be used, and buffers that cannot be passed to the library."""

from __future__ import annotations

import ctypes
import gc
import shutil
import subprocess
from array import array
from ctypes import byref
from pathlib import Path

import pytest
from gradus import abi, native
from support import one_ray


def message(path: Path) -> str:
    with pytest.raises(native.GradusError) as caught:
        native.Library(path)
    assert caught.value.code == native.Error.UNSUPPORTED
    return caught.value.text


def stand_in(tmp_path: Path, source: str) -> Path:
    if shutil.which("cc") is None:
        pytest.skip("needs a C compiler")
    (tmp_path / "a.c").write_text(source)
    path = tmp_path / "libother.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", path, tmp_path / "a.c"], check=True)
    return path


def test_h5_missing(tmp_path: Path) -> None:
    assert "not found" in message(tmp_path / "libgradus.so")


def test_h5_wrong_architecture(tmp_path: Path) -> None:
    path = tmp_path / "libgradus.so"
    path.write_bytes(b"\x7fELF\x01\x01\x01" + bytes(57))  # a 32-bit file
    assert "cannot be loaded" in message(path)


def test_h5_something_else(tmp_path: Path) -> None:
    assert "not a Gradus library" in message(stand_in(tmp_path, "int other(void) { return 1; }"))


def test_h5_old_version(tmp_path: Path) -> None:
    source = "unsigned gradus_version(void) { return 7; }\nunsigned long gradus_abi_hash(void) { return 0; }"
    text = message(stand_in(tmp_path, source))
    assert "version 0.0.7" in text
    assert ".".join(map(str, abi.VERSION)) in text


def test_h5_other_layout_names_both(tmp_path: Path) -> None:
    version = abi.VERSION[0] * 10000 + abi.VERSION[1] * 100 + abi.VERSION[2]
    version_function = f"unsigned gradus_version(void) {{ return {version}; }}"
    source = f"{version_function}\nunsigned long gradus_abi_hash(void) {{ return 0x1234; }}"
    text = message(stand_in(tmp_path, source))
    assert "0000000000001234" in text
    assert f"{abi.layout_hash():016x}" in text


@pytest.mark.parametrize(
    ("flags", "missing"),
    [("sse4_2 avx", "avx2 and fma"), ("avx avx2", "fma"), ("avx avx2 fma", ""), (None, ""), ("", "avx2 and fma")],
)
def test_an_older_processor_gets_a_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, flags: str | None, missing: str
) -> None:
    """A processor without the needed features gives an error. If the system does not list features, none is missing.

    Regression: loading the library ended Blender with an illegal instruction.
    """
    info = tmp_path / "cpuinfo"
    info.write_text(
        "processor\t: 0\nmodel name\t: old avx2 fma\n" + (f"flags\t\t: fpu {flags}\n" if flags is not None else "")
    )
    monkeypatch.setattr(native, "CPU_INFO", info)
    path = native.library_path()
    if missing:
        assert message(path) == f"this processor lacks {missing}, which the library needs: {path}"
    else:
        native.Library(path)


def test_environment_wins_over_preference(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(native.ENVIRONMENT_VARIABLE, raising=False)
    monkeypatch.setattr(native, "preferred_path", "/preferred.so")
    assert native.library_path() == Path("/preferred.so")
    monkeypatch.setenv(native.ENVIRONMENT_VARIABLE, "/environment.so")
    assert native.library_path() == Path("/environment.so")


def test_h7_one_load_per_process() -> None:
    assert native.load() is native.load()


def test_h6_pointer_keeps_the_buffer_alive() -> None:
    pointer = native.pointer(array("f", [1.0, 2.0, 3.0]))
    gc.collect()
    assert pointer[2] == 3.0


def test_h6_pointer_in_a_struct_keeps_the_buffer_alive() -> None:
    attributes = native.struct_array(native.Attribute, [native.Attribute(data=native.pointer(array("f", [7.0])))])
    mesh = native.Mesh(attributes=attributes)
    del attributes
    gc.collect()
    assert mesh.attributes[0].data[0] == 7.0
    assert mesh.attributes[0].struct_size == ctypes.sizeof(native.Attribute)


@pytest.mark.parametrize(
    "value", [array("d", [1.0]), [1.0], b"abcd", memoryview(array("f", [1, 2, 3, 4]))[::2], memoryview(b"abcd")]
)
def test_h6_wrong_buffers_are_refused(value: object) -> None:
    with pytest.raises(TypeError):
        native.pointer(value)


def test_h6_wrong_item_type_is_refused_by_the_field() -> None:
    with pytest.raises(TypeError):
        native.Mesh(positions=native.pointer(array("i", [1])))


@pytest.mark.parametrize("value", [None, array("f")])
def test_h6_empty_is_null(value: array | None) -> None:
    assert native.pointer(value) is None


def test_text_keeps_undecodable_bytes() -> None:
    assert native.text(b"\xff/a".decode("utf-8", "surrogateescape")) == b"\xff/a"
    assert native.text(None) is None


def test_name_is_valid_utf8() -> None:
    assert native.name(b"\xff/\xc3\xa4".decode("utf-8", "surrogateescape")) == "?/\u00e4".encode()
    assert native.name(None) is None


def test_error_has_code_and_text() -> None:
    library = native.load()
    with pytest.raises(native.GradusError) as caught:
        library.scene_release(12345)
    assert caught.value.code != native.Error.OK
    assert caught.value.text
    assert library.take_error() == ""


def test_waiting_for_a_running_render_raises_nothing() -> None:
    """Regression: "still running" was reported as an error, and a real error with the same code was taken for it."""
    library = native.load()
    device, render = ctypes.c_uint64(), ctypes.c_uint64()
    library.device_create(byref(one_ray.struct(native.DeviceSettings, threads=1)), byref(device))
    scene = one_ray.triangle_scene(library, device.value)
    settings = one_ray.struct(native.Settings)
    library.settings_default(byref(settings))
    settings.samples = 1 << 20
    settings.noise_threshold = 0.0
    library.render_start(scene, byref(settings), byref(render))
    assert library.render_wait(render.value, 0.0) == native.Error.TIMEOUT
    assert library.take_error() == ""
    library.render_cancel(render.value)
    with pytest.raises(native.GradusError) as caught:
        library.render_wait(render.value, -1.0)
    assert caught.value.code == native.Error.CANCELLED
    library.render_release(render.value)
    library.scene_release(scene)
    library.device_release(device.value)
