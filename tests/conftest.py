"""Fixtures and marks of all tests. They run in Blender 3.4, in the bpy modules, and in plain Python (tools/test.py).

Fixtures: `host_version`, `library`, `scene`, `render`, `exports`, `lines`, `blender`; the add-on is registered
throughout. Temporary folders are pytest's `tmp_path`.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support import application

try:
    import bpy
except ImportError:  # plain Python, for test files that do not import bpy
    bpy = None

ROOT = Path(__file__).resolve().parent.parent


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves out the tests of another host or of the long run. The fixture `blender` gives the mark "application"."""
    is_module = bpy is not None and getattr(bpy.app, "module", False)
    out = []
    for item in items:
        if "blender" in getattr(item, "fixturenames", ()):
            item.add_marker("application")
        wrong_host = item.get_closest_marker("application" if is_module else "module")
        if wrong_host or (item.get_closest_marker("full") and os.environ.get("GRADUS_TEST_FULL") != "1"):
            out.append(item)
    items[:] = [item for item in items if item not in out]
    config.hook.pytest_deselected(items=out)


@pytest.fixture(scope="session", autouse=True)
def addon() -> Iterator[object]:
    """Registers the add-on once for each test file. In plain Python it is only imported."""
    import gradus

    if bpy is None:
        yield gradus
        return
    gradus.register()
    yield gradus
    gradus.unregister()


@pytest.fixture(scope="session")
def host_version() -> tuple[int, int, int]:
    return tuple(bpy.app.version)


@pytest.fixture(scope="session")
def library_path() -> Path:
    return ROOT / "addon" / "gradus" / "lib" / "libgradus.so"


@pytest.fixture(scope="session")
def library(library_path: Path) -> ctypes.CDLL:
    """Returns the library loaded by ctypes without the add-on's declarations."""
    library = ctypes.CDLL(str(library_path))
    library.gradus_version.restype = ctypes.c_uint32
    library.gradus_version_text.restype = ctypes.c_char_p
    return library


@pytest.fixture
def scene() -> object:
    """Returns an empty scene in an empty file: 64×36 pixels, 4 samples, view transform Standard, engine Gradus."""
    from support import images

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    return scene


@pytest.fixture
def render(tmp_path: Path) -> Callable[..., dict]:
    """Returns a function that renders the passes of a frame: render(scene, frame=1, **settings).

    See support/images.py.
    """
    from support import images

    return lambda scene, **settings: images.render(scene, tmp_path, **settings)


@pytest.fixture
def exports(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Returns the exports that follow; see support/exports.py."""
    from support.exports import Exports

    return Exports(monkeypatch)


@pytest.fixture
def lines(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[], list[dict[str, Any]]]:
    """Returns a function that returns the stats of all delivered frames in order."""
    path = tmp_path / "stats.jsonl"
    monkeypatch.setattr(sys, "argv", ["blender", "--", "--gradus-stats", str(path)])
    return lambda: [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


@pytest.fixture
def blender() -> Callable[..., application.Outcome]:
    """Returns a function that runs the Blender application: blender(*arguments, limit=120, env={}).

    See support/application.py.
    """
    return application.run
