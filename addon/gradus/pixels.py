"""Uploads pixels to Blender: a single foreach_set of one array('f') for all passes of a layer.

Blender reads an array.array as one block of memory. A ctypes array, or one call per pass, takes a hundred times as long
in some versions.
"""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Callable, Iterable
from typing import Any

from .abi import Pass
from .passes import PassInfo, Plane

FLOAT_BYTES = 4

Read = Callable[[Plane, Any, int], Any]
"""Writes a plane to a pointer to floats. The last argument is their number."""


class PassBuffer:
    """Memory for all passes of a render layer, one after another in Blender's order. It is reused between refreshes."""

    def __init__(self) -> None:
        self._values = array("f")
        self._layout: list[tuple[PassInfo | None, int, int]] = []  # pass, first float, floats
        self._names: list[str] = []  # of Blender's passes
        self.size = (0, 0)
        """Width and height in pixels."""

    def prepare(self, passes: Iterable[Any], infos: dict[str, PassInfo], width: int, height: int) -> None:
        """Lays out the buffer for `passes`, whose order Blender keeps. Passes that are not in `infos` stay 0."""
        self._layout = []
        self._names = []
        self.size = (width, height)
        total = 0
        for render_pass in passes:
            self._names.append(render_pass.name)
            count = width * height * render_pass.channels
            info = infos.get(render_pass.name)
            if info is not None and info.channels != render_pass.channels:
                info = None
            self._layout.append((info, total, count))
            total += count
        if len(self._values) != total:
            self._values = array("f", [0.0]) * total  # bytes() would allocate and touch the memory twice

    def fill(self, read: Read, only: frozenset[Pass] | None = None) -> None:
        """Calls `read` for every pass, or for those in `only`."""
        if not self._values:
            return
        memory = (ctypes.c_float * len(self._values)).from_buffer(self._values)
        base = ctypes.addressof(memory)
        for info, first, count in self._layout:
            if info is not None and (only is None or info.plane in only):
                target = ctypes.cast(base + FLOAT_BYTES * first, ctypes.POINTER(ctypes.c_float))
                read(info.plane, target, count)
        del memory

    def fits(self, result: Any) -> bool:
        """Returns whether the buffer has the size and the passes of a result."""
        names = [render_pass.name for render_pass in result.layers[0].passes]
        return self.size == (result.resolution_x, result.resolution_y) and self._names == names

    def upload(self, layer: Any) -> None:
        """Uploads the buffer to a layer.

        The size is checked here, because Blender accepts long arrays and partly copies short ones.
        """
        passes = layer.passes
        if len(passes) != len(self._layout):
            raise ValueError(f"the layer has {len(passes)} passes, the buffer {len(self._layout)}")
        passes.foreach_set("rect", self._values)

    def __len__(self) -> int:
        return len(self._values)
