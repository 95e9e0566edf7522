"""Materials, worlds and node trees of lights as node programs, and the images that they use."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from .. import compat, native
from . import image as images
from .keys import KeyTable
from .properties import MISSING, Color, find_color
from .report import Warnings
from .target import Target

_MAXIMUM_TEXT = 16 << 20  # bytes; what is named as a text file may be anything


class Resources:
    """Provides the keys of images and the content of files for the translation of nodes."""

    def __init__(
        self,
        target: Target,
        keys: KeyTable,
        depsgraph: Any,
        size: tuple[int, int],
        abspath: Callable[..., str],
        warnings: Warnings,
    ) -> None:
        self._target = target
        self._depsgraph = depsgraph
        self._keys = keys
        self._abspath = abspath
        self._warnings = warnings
        self.frame = depsgraph.scene_eval.frame_current
        self.pixel = (1.0 / size[0], 1.0 / size[1])
        """Width and height of a pixel as a share of the frame."""
        self.aovs: dict[str, int] = {}
        """The index + 1 of the channels of AOVs, by name."""

    def image(self, image: Any, image_user: Any = None, is_boxed: bool = False) -> int:
        """Returns the key of an image at the rendered frame. Sets the native image if it is new or has changed.

        is_boxed: whether it is projected from the sides of a box.
        """
        if image is None:
            return 0
        number = images.number_of_frame(image, image_user, self.frame)
        if warning := images.warning(image, number, self._abspath):
            self.warn(warning)
        is_boxed &= image.source == "TILED"
        key = self._keys.key((image.as_pointer(), number, is_boxed))
        signature = images.signature(image, number, self._abspath)
        if signature is not None and not self._keys.changed(key, signature):
            return key
        state = images.image_state(image, number, self._abspath, is_boxed)
        if signature is not None or self._keys.changed(key, images.content(state)):
            struct, _keep = images.fill_image(state)
            self._target.set_image(key, struct)
        return key

    def text(self, path: str, owner: Any) -> str | None:
        """Returns the content of a text file, or None if it cannot be read. owner: the data-block that names it."""
        found = self._abspath(path, library=owner.library)
        try:
            if not os.path.isfile(found):
                return None  # opening a pipe would wait for its other end
            with open(found, "rb") as file:
                return file.read(_MAXIMUM_TEXT).decode("utf-8", "replace")
        except (OSError, ValueError):
            return None

    def view_layer_color(self, name: str) -> Color:
        """Returns a property of the view layer, the scene or the world."""
        scene = self._depsgraph.scene_eval
        return find_color((self._depsgraph.view_layer_eval, scene, scene.world), name) or MISSING

    def scene_time(self) -> tuple[float, float]:
        """Returns the time of the scene in seconds and in frames."""
        scene = self._depsgraph.scene_eval
        frame = scene.frame_current_final
        return frame * scene.render.fps_base / scene.render.fps, frame

    def content(self, key: int) -> Any:
        """Returns a value that is equal for images of equal content."""
        return self._keys.content(key)

    def warn(self, text: str) -> None:
        self._warnings.add(text)


class Materials:
    """Node programs of materials. Each is translated once per sync."""

    def __init__(
        self, target: Target, keys: KeyTable, resources: Resources, poll: Callable[[], None], warnings: Warnings
    ) -> None:
        self._target = target
        self._keys = keys
        self._resources = resources
        self._poll = poll
        self._warnings = warnings
        self._done: dict[tuple[str, int], int] = {}
        self._programs: dict[int, Any] = {}  # by key
        self.attribute_names: set[str] = set()
        self.instance_attribute_names: set[str] = set()
        self.reads_edges = False
        self._names_of: dict[tuple[int, ...], list[str]] = {}

    def key(self, block: Any, kind: str = "MATERIAL") -> int:
        """Returns the key of a material (kind MATERIAL), world (WORLD) or light (LIGHT).

        Returns 0 for None: the default grey material, or a black world.
        """
        if block is None:
            return 0
        pointer = block.original.as_pointer()
        token = (kind, pointer)
        key = self._done.get(token)
        if key is None:
            self._poll()
            key = self._done[token] = self._keys.key(token)
            self._translate(key, block, kind)
        return key

    def content(self, key: int) -> tuple[Any, ...] | None:
        """Returns a value that is equal for materials of this sync of equal content, or None for key 0."""
        program = self._programs.get(key)
        return program.content(self._resources.content) if program is not None else None

    def surface_keys(self, materials: tuple[Any, ...]) -> tuple[int, ...]:
        """Returns the keys of a surface's material slots.

        A surface without slots is treated like one with an empty slot.
        """
        if compat.default_surface_is_principled():
            return tuple(self.key(material) or self._default_surface() for material in materials or (None,))
        return tuple(self.key(material) for material in materials)

    def instance_attributes_of(self, keys: tuple[int, ...]) -> list[str]:
        """Returns the names of the attributes that materials read from their instances."""
        if keys not in self._names_of:
            programs = (self._programs[key] for key in keys if key in self._programs)
            self._names_of[keys] = sorted(set().union(*(program.instance_attribute_names for program in programs)))
        return self._names_of[keys]

    def _default_surface(self) -> int:
        token = ("DEFAULT", 0)
        key = self._done.get(token)
        if key is None:
            from .. import nodes

            key = self._done[token] = self._keys.key(token)
            self._set(key, nodes.default_surface())
        return key

    def _translate(self, key: int, block: Any, kind: str) -> None:
        from .. import nodes  # imported with the first material, because the package is large

        self._set(key, nodes.translate(block, kind, self._resources))

    def _set(self, key: int, program: Any) -> None:
        self._programs[key] = program
        for text in program.warnings:
            self._warnings.add(text)
        self.attribute_names.update(program.attribute_names)
        self.instance_attribute_names.update(program.instance_attribute_names)
        self.reads_edges |= program.reads_edges
        if self._keys.changed(key, program.content()):
            struct, _keep = program.to_native(native)
            self._target.set_material(key, struct)
