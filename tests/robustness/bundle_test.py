"""The libraries in lib/ are complete and use no library of the host."""

from __future__ import annotations

import ctypes
import math
import os
import re
import shutil
import subprocess
from pathlib import Path

import bpy
import pytest
from gradus import native

ROOT = Path(__file__).resolve().parent.parent.parent
BASE = {
    "libc.so.6",
    "libm.so.6",
    "libdl.so.2",
    "libpthread.so.0",
    "librt.so.1",
    "libstdc++.so.6",
    "libgcc_s.so.1",
    "ld-linux-x86-64.so.2",
}
MAY_BE_SHARED = {"libtbb.so.12"}


@pytest.fixture(scope="module")
def bundle(library_path: Path) -> list[Path]:
    return sorted(library_path.parent.glob("*.so*"))


def dynamic(library: Path, tag: str) -> list[str]:
    lines = subprocess.run(["readelf", "-d", library], check=True, capture_output=True, text=True).stdout.splitlines()
    return [re.search(r"\[(.*)\]", line).group(1) for line in lines if f"({tag})" in line]


def mapped() -> set[Path]:
    lines = Path("/proc/self/maps").read_text().splitlines()
    return {Path(line.split(maxsplit=5)[5]) for line in lines if ".so" in line and "/" in line}


def test_nothing_is_needed_from_outside(bundle: list[Path]) -> None:
    names = {path.name for path in bundle}
    for library in bundle:
        missing = set(dynamic(library, "NEEDED")) - names - BASE
        assert not missing, f"{library.name} needs {missing}"
        assert dynamic(library, "RUNPATH") == ["$ORIGIN"], library.name


def test_file_names_are_sonames(bundle: list[Path]) -> None:
    for library in bundle:
        if library.name != "libgradus.so":
            assert dynamic(library, "SONAME") == [library.name]


def test_sonames_are_ours(bundle: list[Path]) -> None:
    """No soname of the bundle is that of a library of the host: mapped by this process or in Blender's folder."""
    host = {path for path in mapped() if path.parent != bundle[0].parent}
    host |= set(Path(bpy.__file__).resolve().parent.rglob("*.so*")) if getattr(bpy.app, "module", False) else set()
    sonames = {name for path in host if path.is_file() for name in dynamic(path, "SONAME")}
    assert sonames, "no library of the host was found"
    assert {path.name for path in bundle} & sonames <= MAY_BE_SHARED


def test_loading_maps_only_our_libraries(bundle: list[Path]) -> None:
    """Runs in a process of its own, in which no library was loaded before."""
    folder = bundle[0].parent
    script = f"""
import sys
sys.path[:0] = {[str(folder.parent.parent)]!r}
from gradus import native
native.load()
print(open("/proc/self/maps").read())
"""
    python = "/usr/bin/python3"
    maps = subprocess.run(
        [python, "-c", script], check=True, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": ""}
    ).stdout
    libraries = {Path(line.split(maxsplit=5)[5]) for line in maps.splitlines() if "/" in line and ".so" in line}
    known = {path.name for path in bundle}
    loaded = {path.name for path in libraries if path.parent == folder}
    assert "libgradus.so" in loaded
    # Libraries that are in the bundle were loaded from the bundle.
    plain = {name.replace("libgradus_", "lib") for name in known}
    python_own = {"libz.so.1", "libexpat.so.1"}  # the interpreter's
    strangers = {path for path in libraries if path.parent != folder and path.name in plain - python_own}
    assert not strangers


def test_flow_library_holds_opencv_and_shows_none_of_it(bundle: list[Path]) -> None:
    """Neither copy of OpenCV may bind to symbols of the other: Blender 3.4 has another one in its global scope."""
    flow = next(path for path in bundle if path.name == "libgradus_flow.so")
    symbols = subprocess.run(["nm", "-D", flow], check=True, capture_output=True, text=True).stdout.splitlines()
    defined = {line.split()[-1] for line in symbols if line.split()[-2] not in "Uwv"}
    assert defined == {"gradus_flow_interface", "gradus_flow_version", "gradus_flow_estimate"}
    assert not [line for line in symbols if "2cv" in line]
    assert not [name for name in dynamic(flow, "NEEDED") if "opencv" in name]


def test_flow_library_finds_a_shift_in_this_process(bundle: list[Path]) -> None:
    library = ctypes.CDLL(str(bundle[0].parent / "libgradus_flow.so"), mode=ctypes.RTLD_LOCAL)
    flow, width, height = (ctypes.c_float * (2 * 64 * 48))(), 64, 48

    class Images(ctypes.Structure):
        _fields_ = [
            ("width", ctypes.c_int32),
            ("height", ctypes.c_int32),
            ("start", ctypes.c_void_p),
            ("end", ctypes.c_void_p),
        ]

    def plane(shift: int) -> ctypes.Array[ctypes.c_float]:
        levels = [
            128 + 60 * math.sin(0.4 * (x - shift) + 0.1 * y) + 60 * math.sin(0.35 * y)
            for y in range(height)
            for x in range(width)
        ]
        return (ctypes.c_float * (width * height))(*levels)

    start, end, effort = plane(0), plane(2), (ctypes.c_int32 * 2)(2, 1)
    images = Images(width, height, ctypes.addressof(start), ctypes.addressof(end))
    error = ctypes.create_string_buffer(200)
    assert library.gradus_flow_estimate(ctypes.byref(images), effort, flow, error, ctypes.c_size_t(200)) == 0, (
        error.value
    )
    middle = 2 * (24 * width + 32)
    assert abs(flow[middle] - 2.0) < 0.1 and abs(flow[middle + 1]) < 0.1, flow[middle : middle + 2]


def test_flow_library_missing_is_left_out_of_the_bundle(tmp_path: Path) -> None:
    library = tmp_path / "build" / "libgradus.so"
    library.parent.mkdir()
    subprocess.run(["cc", "-shared", "-x", "c", "/dev/null", "-o", library], check=True)
    command = ["/usr/bin/python3", str(ROOT / "tools" / "bundle.py"), str(library), str(tmp_path / "lib")]
    for names in ({"libgradus.so"}, {"libgradus.so", "libgradus_flow.so"}, {"libgradus.so"}):
        if "libgradus_flow.so" in names:
            shutil.copy(library, library.parent / "libgradus_flow.so")
        else:
            (library.parent / "libgradus_flow.so").unlink(missing_ok=True)
        subprocess.run(command, check=True)
        assert {path.name for path in (tmp_path / "lib").glob("*.so*")} == names


def test_native_loads(library_path: Path) -> None:
    assert native.load(library_path)
