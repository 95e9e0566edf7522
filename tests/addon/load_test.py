"""Loading and unloading of the add-on and the library."""

from __future__ import annotations

import ctypes
import json
import os
import re
import subprocess
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest


def test_register_twice(addon: object) -> None:
    for _ in range(2):
        addon.unregister()
        assert not hasattr(bpy.types.Scene, "gradus")
        addon.register()
        assert hasattr(bpy.types.Scene, "gradus")


def test_an_engine_that_outlives_blenders_types_does_not_look_for_them(
    addon: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    from gradus import engine

    freed = []
    monkeypatch.setattr(engine, "bpy", None)
    monkeypatch.setattr(engine, "_parent_del", None)
    job = SimpleNamespace(free=lambda: freed.append(True))
    engine.GradusRenderEngine.__del__(SimpleNamespace(job=job))
    assert freed == [True]


def test_version_is_reported(library: ctypes.CDLL) -> None:
    version = library.gradus_version()
    text = library.gradus_version_text().decode()
    assert text.startswith(f"{version // 10000}.{version // 100 % 100}.{version % 100} ")


def test_h4_exports_are_those_of_the_header(library_path: Path) -> None:
    header = (library_path.parents[3] / "native" / "include" / "gradus" / "gradus.h").read_text()
    declared = set(re.findall(r"^GRADUS_API [^;(]*?\b(gradus_\w+)\(", header, re.M))
    lines = subprocess.run(
        ["nm", "-D", "--defined-only", library_path], check=True, capture_output=True, text=True
    ).stdout.splitlines()
    exported = {line.split()[-1].partition("@")[0] for line in lines}
    assert "gradus_version" in declared
    assert exported == declared


def test_h4_soname_changes_with_the_layout(library: ctypes.CDLL, library_path: Path) -> None:
    """The layout of the last release, which is in abi_golden.json, must not change unless the soname does.

    After raising SOVERSION in native/CMakeLists.txt (or before the first release), run this file with
    GRADUS_UPDATE_GOLDEN=1 make test-addon TESTS=tests/addon/load_test.py.
    """
    golden = Path(__file__).with_name("abi_golden.json")
    dynamic = subprocess.run(["readelf", "-d", library_path], check=True, capture_output=True, text=True).stdout
    library.gradus_abi_hash.restype = ctypes.c_uint64
    found = {
        "layout": f"{library.gradus_abi_hash():016x}",
        "soname": re.search(r"\(SONAME\).*\[(.*)\]", dynamic).group(1),
    }
    if os.environ.get("GRADUS_UPDATE_GOLDEN"):
        golden.write_text(json.dumps(found) + "\n")
    assert found == json.loads(golden.read_text())
