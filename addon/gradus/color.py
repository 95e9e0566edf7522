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
from pathlib import Path
from typing import Any

from . import native

CURVE_SAMPLES = 1024
TOLERANCE = 2e-3
"""Largest difference, relative to 1, between a colour space and its curve and matrix; measured on saturated and dark probes."""
READABLE_PROFILE = (2, 1)

Convert = Callable[[Sequence[float]], Sequence[float]]


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


def curve_and_matrix(convert: Convert) -> tuple[array, list[float]] | None:
    """The curve (CURVE_SAMPLES values, encoded -> linear) and row-major matrix that equal `convert` on RGB; None if none do.

    White (1, 1, 1) fixes the scale: with M the matrix and c the curve, convert(t, t, t) = M · (c(t), c(t), c(t)); c(1) = 1.
    """
    columns = [convert([1.0 if i == axis else 0.0 for i in range(3)]) for axis in range(3)]
    zero = convert([0.0, 0.0, 0.0])
    if max(map(abs, zero)) > TOLERANCE:
        return None
    matrix = [columns[column][row] for row in range(3) for column in range(3)]
    row_sums = [sum(matrix[3 * row : 3 * row + 3]) for row in range(3)]
    if min(map(abs, row_sums)) < 1e-6:
        return None
    curve = array("f", (_gray(convert, index / (CURVE_SAMPLES - 1), row_sums) for index in range(CURVE_SAMPLES)))
    for probe in ((0.2, 0.5, 0.9), (0.9, 0.1, 0.3), (0.02, 0.6, 0.05), (0.7, 0.7, 0.1)):
        linear = [_look_up(curve, value) for value in probe]
        expected = convert(list(probe))
        for row in range(3):
            got = sum(matrix[3 * row + column] * linear[column] for column in range(3))
            if not abs(got - expected[row]) <= TOLERANCE:
                return None
    return curve, matrix


def _gray(convert: Convert, value: float, row_sums: Sequence[float]) -> float:
    result = convert([value, value, value])
    return sum(result[row] / row_sums[row] for row in range(3)) / 3.0


def _look_up(curve: array, value: float) -> float:
    position = min(max(value, 0.0), 1.0) * (len(curve) - 1)
    index = min(int(position), len(curve) - 2)
    fraction = position - index
    return curve[index] * (1.0 - fraction) + curve[index + 1] * fraction


def _is_identity(curve: array) -> bool:
    last = len(curve) - 1
    return all(abs(value - index / last) <= 1e-6 for index, value in enumerate(curve))


def bake(config_path: str, packages: str = "") -> Iterable[tuple[str, array, list[float]]]:
    """(name, curve or empty array for a linear one, matrix) of every colour space of the configuration that has this form.

    `packages`: folder to find PyOpenColorIO in. Nothing where it cannot be imported or refuses the configuration.
    """
    if packages and packages not in sys.path:
        sys.path.append(packages)
    try:
        import PyOpenColorIO as ocio

        config = ocio.Config.CreateFromFile(str(Path(config_path)))
    except Exception:  # a missing module, or a configuration that it refuses, too: then the library falls back and says so
        return
    target = config.getColorSpace("scene_linear")
    for space in config.getColorSpaces():
        try:
            processor = config.getProcessor(space, target).getDefaultCPUProcessor()
        except Exception:
            continue
        found = curve_and_matrix(processor.applyRGB)
        if found is not None:
            curve, matrix = found
            yield space.getName(), array("f") if _is_identity(curve) else curve, matrix


def hand_over(library: Any, device: int, config_path: str, packages: str) -> None:
    """Bakes the configuration into the device if the library cannot read it."""
    if not needs_baking(config_path):
        return
    for name, curve, matrix in bake(config_path, packages):
        space = native.ColorSpace(name=native.text(name), curve_count=len(curve), curve=native.pointer(curve))
        space.matrix[:] = matrix
        library.device_set_color_space(device, ctypes.byref(space))
