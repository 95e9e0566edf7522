"""Colour spaces for the native device: Blender's own configuration, and values baked from it where the library cannot read it.

The library's OpenColorIO 2.1 refuses configurations of profile 2.4 (Blender 5.0); the PyOpenColorIO inside Blender reads them
(contract 8.1). A colour space is handed over as a curve over [0, 1] and a matrix into scene-linear, where that describes it exactly.
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
"""Largest difference, relative to 1, between a colour space and its curve and matrix; measured on saturated and dark probes."""
READABLE_PROFILE = (2, 1)
PROBES = ((0.2, 0.5, 0.9), (0.9, 0.1, 0.3), (0.02, 0.6, 0.05), (0.7, 0.7, 0.1))

Convert = Callable[[array], None]
"""Converts RGB triples, one after another in an array('f'), in place into scene-linear."""
CurveAndMatrix = tuple[array, list[float]]


def profile_of(text: str) -> tuple[int, int]:
    """(major, minor) of an OpenColorIO configuration; (1, 0) if it does not say."""
    match = re.search(r"^ocio_profile_version:\s*(\d+)(?:\.(\d+))?", text, re.MULTILINE)
    return (int(match.group(1)), int(match.group(2) or 0)) if match else (1, 0)


def needs_baking(config_path: str) -> bool:
    try:
        with open(config_path, encoding="utf-8", errors="replace") as file:
            return profile_of(file.read(65536)) > READABLE_PROFILE
    except OSError:
        return False


def curve_and_matrix(convert: Convert) -> CurveAndMatrix | None:
    """The curve (CURVE_SAMPLES values, encoded -> linear; empty for a linear space) and row-major matrix that equal `convert`; None if
    none do.

    White (1, 1, 1) fixes the scale: with M the matrix and c the curve, convert(t, t, t) = M · (c(t), c(t), c(t)), and c(1) = 1.
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
    return array("f", (sum(grays[3 * index + row] / row_sums[row] for row in range(3)) / 3.0 for index in range(CURVE_SAMPLES)))


def _look_up(curve: array, value: float) -> float:
    position = min(max(value, 0.0), 1.0) * (len(curve) - 1)
    index = min(int(position), len(curve) - 2)
    fraction = position - index
    return curve[index] * (1.0 - fraction) + curve[index + 1] * fraction


def _is_identity(curve: array) -> bool:
    last = len(curve) - 1
    return all(abs(value - index / last) <= 1e-6 for index, value in enumerate(curve))


class Baker:
    """Colour spaces of one configuration, baked when an image first asks for them: making all takes seconds."""

    def __init__(self, ocio: Any, config: Any) -> None:
        self._ocio = ocio
        self._config = config
        self._known: set[str] = set()

    def bake(self, name: str) -> CurveAndMatrix | None:
        """None for a space that is unknown, or is no curve and matrix."""
        space = self._config.getColorSpace(name)
        if space is None:
            return None
        try:
            processor = self._config.getProcessor(space, self._config.getColorSpace("scene_linear")).getDefaultCPUProcessor()
        except self._ocio.Exception:
            return None
        return curve_and_matrix(lambda rgb: processor.apply(self._ocio.PackedImageDesc(rgb, len(rgb) // 3, 1, 3)))

    def hand_over(self, library: Any, device: int, names: Iterable[str]) -> None:
        """Sets those of `names` on the device that it does not have yet. The library itself warns of one that is still missing."""
        for name in sorted(set(names) - self._known):
            self._known.add(name)
            found = self.bake(name)
            if found is not None:
                space = native.ColorSpace(name=native.text(name), curve_count=len(found[0]), curve=native.pointer(found[0]))
                space.matrix[:] = found[1]
                library.device_set_color_space(device, ctypes.byref(space))


def baker_for(config_path: str, packages: str) -> Baker | None:
    """A baker for a configuration that the library cannot read; None for one that it can, or where PyOpenColorIO is missing or refuses.

    `packages`: folder in which PyOpenColorIO may be.
    """
    if not needs_baking(config_path):
        return None
    if packages and packages not in sys.path:
        sys.path.append(packages)
    try:
        import PyOpenColorIO as ocio

        return Baker(ocio, ocio.Config.CreateFromFile(config_path))
    except Exception:  # whatever it is, the library falls back and says so
        return None
