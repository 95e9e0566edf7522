"""Colour spaces, converted by the OpenColorIO of Blender itself, as Cycles does.

The library's own OpenColorIO refuses configurations that are newer than itself, and does not see the working space of
a file. PyOpenColorIO, which Blender brings along, shares the current configuration with Blender. The library calls it
back while it decodes images.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from . import native

Matrix = tuple[tuple[float, float, float], ...]

_REC709_TO_ACES: Matrix = (
    (0.4396329819, 0.3829886981, 0.1773783199),
    (0.0897764430, 0.8134394287, 0.0967841284),
    (0.0175411704, 0.1115465500, 0.8709122797),
)
"""Linear Rec. 709 to ACES2065-1, with the adaptation of white by Bradford's matrix."""
_Y_OF_ACES = (0.337369, 0.729522, -0.066890)
"""The CIE Y of the primaries of ACES2065-1 adapted to D65, as Cycles has it."""
_SAME = 1e-3
"""Largest difference of a matrix from the identity that rounding explains."""


@dataclass(frozen=True)
class WorkingSpace:
    """The space of a render, if it is not linear Rec. 709."""

    from_rec709: Matrix
    luminance: tuple[float, float, float]


class HostColors:
    """The current OpenColorIO configuration of Blender."""

    def __init__(self, ocio: Any, config: Any) -> None:
        self._ocio = ocio
        self._config = config
        self._conversions: dict[str, Any] = {}
        """Functions that the library calls, by colour space. They must live as long as the device."""
        self._failures: dict[str, str] = {}
        """What conversions failed with and was not taken yet, by colour space."""

    def define(self, library: Any, device: int, names: Iterable[str]) -> None:
        """Defines colour spaces on the device that are not defined yet: some take a tenth of a second.

        The library warns of those that are still missing.
        """
        for name in sorted(set(names) - self._conversions.keys()):
            self._conversions[name] = self._conversion(name)
            if self._conversions[name] is not None:
                library.device_set_color_space(device, native.text(name), self._conversions[name], None)

    def take_warnings(self) -> list[str]:
        """Returns a warning for each colour space of which a conversion failed since the last call."""
        failures, self._failures = self._failures, {}
        return [
            f"colour: Blender cannot convert {name} to scene-linear, so that images keep values of that space: {reason}"
            for name, reason in failures.items()
        ]

    def working_space(self) -> WorkingSpace | None:
        """Returns the working space, or None if it is linear Rec. 709, or the configuration does not tell."""
        if not self._config.hasRole("aces_interchange"):
            return None
        columns = self._map("aces_interchange", "scene_linear", zip(*_REC709_TO_ACES, strict=True))
        if columns is None or all(abs(columns[c][r] - (r == c)) < _SAME for r in range(3) for c in range(3)):
            return None
        primaries = self._map("scene_linear", "aces_interchange", ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
        luminance = (sum(y * value for y, value in zip(_Y_OF_ACES, primary, strict=True)) for primary in primaries)
        return WorkingSpace(tuple(zip(*columns, strict=True)), tuple(luminance))

    def _map(self, source: str, target: str, colors: Iterable[Iterable[float]]) -> list[tuple[float, ...]] | None:
        """Returns colours in another space, or None if there is no conversion."""
        processor = self._processor(source, target)
        if processor is None:
            return None
        return [tuple(processor.applyRGB(list(map(float, color)))) for color in colors]

    def _processor(self, source: str, target: str) -> Any:
        try:
            return self._config.getProcessor(source, target).getDefaultCPUProcessor()
        except self._ocio.Exception:
            return None

    def _conversion(self, name: str) -> Any:
        """Returns a function that converts a colour space to scene-linear, or None if there is no such conversion.

        The library cannot receive its exceptions. The pixels of a call that fails keep their values: a row or some
        65,536 pixels of an image, or all images of the space if it is the call by which the library finds out what the
        space is. take_warnings() names the space.
        """
        processor = self._processor(name, "scene_linear") if self._config.getColorSpace(name) is not None else None
        if processor is None:
            return None

        def convert(_context: int, address: int, count: int) -> None:
            try:
                pixels = (ctypes.c_float * (4 * count)).from_address(address)
                processor.apply(self._ocio.PackedImageDesc(pixels, count, 1, 4))
            except BaseException as error:  # ctypes would print it and go on
                self._failures[name] = str(error) or type(error).__name__

        return native.ConvertColors(convert)


def host_colors(packages: str) -> HostColors | None:
    """Returns the colour management of the running Blender, or None if Python cannot reach it.

    packages: the folder of PyOpenColorIO, or "" if it is on the path.
    """
    if packages and packages not in sys.path:
        sys.path.append(packages)
    try:
        import PyOpenColorIO as ocio

        config = ocio.GetCurrentConfig()
        return HostColors(ocio, config) if config.hasRole("scene_linear") else None
    except Exception:  # the library then reads the configuration, or falls back to sRGB and warns
        return None
