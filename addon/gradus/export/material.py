"""Materials, worlds and light trees as node programs; and what those programs ask of the exporter."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .. import compat, native
from . import image as images
from .keys import KeyTable
from .report import Warnings
from .target import Target


class Resources:
    """What the node translation asks for: keys of images."""

    def __init__(self, target: Target, keys: KeyTable, frame: int, abspath: Callable[..., str], warnings: Warnings) -> None:
        self._target = target
        self._keys = keys
        self._abspath = abspath
        self._warnings = warnings
        self.frame = frame

    def image(self, image: Any, image_user: Any = None) -> int:
        """The key of an image at the rendered frame; sets it if it is new or has changed."""
        if image is None:
            return 0
        signature = images.signature(image, image_user, self.frame, self._abspath)
        file = signature[1] if signature is not None and image.source == "SEQUENCE" else ""
        key = self._keys.key((image.as_pointer(), file))
        if signature is not None and not self._keys.changed(key, signature):
            return key
        state = images.image_state(image, image_user, self.frame, self._abspath)
        if signature is not None or self._keys.changed(key, images.content(state)):
            struct, _keep = images.fill_image(state)
            self._target.set_image(key, struct)
        return key

    def warn(self, text: str) -> None:
        self._warnings.add(text)


class Materials:
    """Programs by material, each translated once a sync."""

    def __init__(self, target: Target, keys: KeyTable, resources: Resources, poll: Callable[[], None], warnings: Warnings) -> None:
        self._target = target
        self._keys = keys
        self._resources = resources
        self._poll = poll
        self._warnings = warnings
        self._done: dict[tuple[str, int], int] = {}
        self.attribute_names: set[str] = set()

    def key(self, block: Any, kind: str = "MATERIAL") -> int:
        """The key of a material (kind MATERIAL), world (WORLD) or light (LIGHT); 0 for None: the default grey, or black."""
        if block is None:
            return 0
        pointer = block.original.as_pointer()
        place = (kind, pointer)
        key = self._done.get(place)
        if key is None:
            self._poll()
            key = self._done[place] = self._keys.key(place)
            self._translate(key, block, kind)
        return key

    def surface_keys(self, materials: tuple[Any, ...]) -> tuple[int, ...]:
        """The keys of a surface's slots. Without slots it is as with an empty one."""
        if compat.default_surface_is_principled():
            return tuple(self.key(material) or self._default_surface() for material in materials or (None,))
        return tuple(self.key(material) for material in materials)

    def _default_surface(self) -> int:
        place = ("DEFAULT", 0)
        key = self._done.get(place)
        if key is None:
            from .. import nodes

            key = self._done[place] = self._keys.key(place)
            self._set(key, nodes.default_surface())
        return key

    def _translate(self, key: int, block: Any, kind: str) -> None:
        from .. import nodes  # the translation is large: loaded with the first material

        self._set(key, nodes.translate(block, kind, self._resources))

    def _set(self, key: int, program: Any) -> None:
        for text in program.warnings:
            self._warnings.add(text)
        self.attribute_names.update(program.attribute_names)
        if self._keys.changed(key, program.content()):
            struct, _keep = program.to_native(native)
            self._target.set_material(key, struct)
