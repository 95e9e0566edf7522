"""Colour spaces of Blender's configuration, baked where the library cannot read the configuration.

The library's OpenColorIO 2.1 refuses configurations of profile 2.4 (Blender 5.0), which Blender's own PyOpenColorIO
reads. A colour space is passed to the device as a curve over [0, 1] and a matrix to scene-linear, if these describe it
exactly.
"""

from __future__ import annotations

import ctypes
import re
import sys
from array import array
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from . import native

CURVE_SAMPLES = 1024
TOLERANCE = 2e-3
"""Maximum difference, relative to 1, between a colour space and its curve and matrix, on saturated and dark probes."""
READABLE_PROFILE = (2, 1)
PROBES = ((0.2, 0.5, 0.9), (0.9, 0.1, 0.3), (0.02, 0.6, 0.05), (0.7, 0.7, 0.1))

Convert = Callable[[array], None]
"""Converts RGB triples in an array('f') to scene-linear, in place."""
CurveAndMatrix = tuple[array, list[float]]


def profile_of(text: str) -> tuple[int, int]:
    """Returns the profile (major, minor) of an OpenColorIO configuration, by default (1, 0)."""
    match = re.search(r"^ocio_profile_version:\s*(\d+)(?:\.(\d+))?", text, re.MULTILINE)
    return (int(match.group(1)), int(match.group(2) or 0)) if match else (1, 0)


def needs_baking(config_path: str) -> bool:
    try:
        with open(config_path, encoding="utf-8", errors="replace") as file:
            return profile_of(file.read(65536)) > READABLE_PROFILE
    except OSError:
        return False


def curve_and_matrix(convert: Convert) -> CurveAndMatrix | None:
    """Returns the curve and row-major matrix that equal `convert`, or None if there are none.

    The curve maps CURVE_SAMPLES encoded values to linear ones and is empty for a linear space. White fixes the scale:
    with the matrix M and the curve c, convert(t, t, t) = M · (c(t), c(t), c(t)), and c(1) = 1.
    """
    corners = array("f", (1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0))
    convert(corners)
    matrix = [corners[3 * column + row] for row in range(3) for column in range(3)]
    row_sums = [sum(matrix[3 * row : 3 * row + 3]) for row in range(3)]
    if max(map(abs, corners[9:])) > TOLERANCE or min(map(abs, row_sums)) < 1e-6:
        return None
    curve = _curve(convert, row_sums)
    probes = array("f", (value for probe in PROBES for value in probe))
    convert(probes)
    for index, probe in enumerate(PROBES):
        linear = [_look_up(curve, value) for value in probe]
        for row in range(3):
            got = sum(matrix[3 * row + column] * linear[column] for column in range(3))
            if not abs(got - probes[3 * index + row]) <= TOLERANCE:
                return None
    return array("f") if _is_identity(curve) else curve, matrix


def _curve(convert: Convert, row_sums: Sequence[float]) -> array:
    grays = array("f", (index / (CURVE_SAMPLES - 1) for index in range(CURVE_SAMPLES) for _ in range(3)))
    convert(grays)
    means = (sum(grays[3 * index + row] / row_sums[row] for row in range(3)) / 3.0 for index in range(CURVE_SAMPLES))
    return array("f", means)


def _look_up(curve: array, value: float) -> float:
    position = min(max(value, 0.0), 1.0) * (len(curve) - 1)
    index = min(int(position), len(curve) - 2)
    fraction = position - index
    return curve[index] * (1.0 - fraction) + curve[index + 1] * fraction


def _is_identity(curve: array) -> bool:
    last = len(curve) - 1
    return all(abs(value - index / last) <= 1e-6 for index, value in enumerate(curve))


class Baker:
    """Bakes colour spaces of one configuration when an image first uses them. Baking all of them would take seconds."""

    def __init__(self, ocio: Any, config: Any) -> None:
        self._ocio = ocio
        self._config = config
        self._known: set[str] = set()

    def bake(self, name: str) -> CurveAndMatrix | None:
        """Returns a colour space, or None if it is unknown or cannot be described by a curve and a matrix."""
        space = self._config.getColorSpace(name)
        if space is None:
            return None
        try:
            linear = self._config.getColorSpace("scene_linear")
            processor = self._config.getProcessor(space, linear).getDefaultCPUProcessor()
        except self._ocio.Exception:
            return None
        return curve_and_matrix(lambda rgb: processor.apply(self._ocio.PackedImageDesc(rgb, len(rgb) // 3, 1, 3)))

    def define(self, library: Any, device: int, names: Iterable[str]) -> None:
        """Defines colour spaces on the device that are not defined yet.

        The library warns of those that are still missing.
        """
        for name in sorted(set(names) - self._known):
            self._known.add(name)
            found = self.bake(name)
            if found is not None:
                curve, matrix = found
                space = native.ColorSpace(name=native.name(name), curve_count=len(curve), curve=native.pointer(curve))
                space.matrix[:] = matrix
                library.device_set_color_space(device, ctypes.byref(space))


def baker_for(config_path: str, packages: str) -> Baker | None:
    """Returns a baker for a configuration that the library cannot read.

    Returns None if the library can read it, or if PyOpenColorIO is missing or fails. `packages` is the folder of
    PyOpenColorIO.
    """
    if not needs_baking(config_path):
        return None
    if packages and packages not in sys.path:
        sys.path.append(packages)
    try:
        import PyOpenColorIO as ocio

        return Baker(ocio, ocio.Config.CreateFromFile(config_path))
    except Exception:  # the library then falls back to sRGB and warns
        return None
