"""Architecture, rule 10: what travels in lib/ is complete, and takes nothing from the host by accident."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import bpy
import pytest
from gradus import native

BASE = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libstdc++.so.6", "libgcc_s.so.1", "ld-linux-x86-64.so.2"}
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
    """Those of the host: what this process has mapped and what lies in Blender's folder."""
    host = {path for path in mapped() if path.parent != bundle[0].parent}
    host |= set(Path(bpy.__file__).resolve().parent.rglob("*.so*")) if getattr(bpy.app, "module", False) else set()
    sonames = {name for path in host if path.is_file() for name in dynamic(path, "SONAME")}
    assert sonames, "no library of the host was found"
    assert {path.name for path in bundle} & sonames <= MAY_BE_SHARED


def test_loading_maps_only_our_libraries(bundle: list[Path]) -> None:
    """In a process of its own, where nothing was loaded before."""
    folder = bundle[0].parent
    script = f"""
import sys
sys.path[:0] = {[str(folder.parent.parent)]!r}
from gradus import native
native.load()
print(open("/proc/self/maps").read())
"""
    python = "/usr/bin/python3"
    maps = subprocess.run([python, "-c", script], check=True, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": ""}).stdout
    libraries = {Path(line.split(maxsplit=5)[5]) for line in maps.splitlines() if "/" in line and ".so" in line}
    known = {path.name for path in bundle}
    loaded = {path.name for path in libraries if path.parent == folder}
    assert "libgradus.so" in loaded
    # A library of which we carry a copy came from the copy.
    plain = {name.replace("libgradus_", "lib") for name in known}
    python_own = {"libz.so.1", "libexpat.so.1"}  # the interpreter's
    strangers = {path for path in libraries if path.parent != folder and path.name in plain - python_own}
    assert not strangers


def test_native_loads(library_path: Path) -> None:
    assert native.load(library_path)
