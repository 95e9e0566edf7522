"""Threads of the viewport without a window, by a library in Python."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from gradus import native, viewport


class FakeLibrary:
    """Calls `during` within one of its functions."""

    def __init__(self, name: str, during: Callable[[], None]) -> None:
        self.calls: list[str] = []
        self._name, self._during = name, during

    def _call(self, name: str) -> None:
        self.calls.append(name)
        if name == self._name:
            self._during()

    def scene_commit(self, *_: Any) -> None:
        self._call("commit")

    def render_start(self, _scene: int, _settings: Any, handle: Any) -> None:
        self._call("start")
        ctypes.cast(handle, ctypes.POINTER(ctypes.c_uint64))[0] = 7

    def render_cancel(self, render: int) -> None:
        assert render == 7
        self._call("cancel")

    def render_read_pass(self, render: int, plane: int, _pixels: Any, count: int) -> None:
        assert (render, plane, count) == (7, native.Pass.COMBINED, 4 * 30 * 20)
        self._call("read")


def interrupted_during(name: str) -> FakeLibrary:
    view = viewport.View.__new__(viewport.View)
    view.cancel, view.render, view.worker, view.error = ctypes.c_int32(0), 0, None, None
    view.settings, view.region = native.Settings(), (10, 10, 40, 30)
    library = FakeLibrary(name, view.interrupt)
    view.session = SimpleNamespace(library=library, scene=1)
    view._work(0)
    return library


@pytest.mark.parametrize(("name", "calls"), [("commit", ["commit"]), ("start", ["commit", "start", "cancel"])])
def test_k4_a_cancel_before_the_render_has_a_handle_is_not_lost(name: str, calls: list[str]) -> None:
    """Regression: the render continued after the edit that had cancelled it."""
    assert interrupted_during(name).calls == calls


def test_a_first_image_is_requested_at_once() -> None:
    """Without the request, the first image would come after the first sample of all pixels."""
    assert interrupted_during("nothing").calls == ["commit", "start", "read"]
