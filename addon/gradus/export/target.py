"""The native scene for the exporter, with one method for each kind of object."""

from __future__ import annotations

import ctypes
from typing import Any


class Target:
    """Passes structs to the library, which copies their arrays before a call returns."""

    def __init__(self, library: Any, scene: int) -> None:
        self._library = library
        self._scene = scene

    def set_mesh(self, key: int, struct: Any) -> None:
        self._library.scene_set_mesh(self._scene, key, ctypes.byref(struct))

    def set_image(self, key: int, struct: Any) -> None:
        self._library.scene_set_image(self._scene, key, ctypes.byref(struct))

    def set_material(self, key: int, struct: Any) -> None:
        self._library.scene_set_material(self._scene, key, ctypes.byref(struct))

    def set_instances(self, struct: Any) -> None:
        self._library.scene_set_instances(self._scene, ctypes.byref(struct))

    def set_lights(self, records: Any, count: int) -> None:
        self._library.scene_set_lights(self._scene, records, count)

    def set_camera(self, struct: Any) -> None:
        self._library.scene_set_camera(self._scene, ctypes.byref(struct))

    def set_dicing_camera(self, struct: Any | None) -> None:
        self._library.scene_set_dicing_camera(self._scene, None if struct is None else ctypes.byref(struct))

    def set_world(self, struct: Any) -> None:
        self._library.scene_set_world(self._scene, ctypes.byref(struct))

    def set_channels(self, records: Any, count: int) -> None:
        self._library.scene_set_channels(self._scene, records, count)

    def remove(self, kind: int, key: int) -> None:
        self._library.scene_remove(self._scene, kind, key)
