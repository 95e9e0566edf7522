"""IES profiles: the intensity of a luminaire by direction, as manufacturers publish it (ANSI/IES LM-63)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

_TYPE_C, _TYPE_B, _TYPE_A = 1, 2, 3
_WATTS_PER_CANDELA = 4.0 * math.pi / 177.83
"""Converts an intensity to the power of a point light, with the luminous efficacy of D65 in lm/W, as Cycles does."""
_MAXIMUM_ANGLES = 100_000  # of one kind; real profiles have a few hundred
_MAXIMUM = 1e30  # of intensities, so that a spline through them stays finite in single precision
_TOLERANCE = 1e-4  # degrees


@dataclass
class Profile:
    """The power in watts that a point light with the same intensity would have, for each direction."""

    horizontal: list[float]  # degrees about the axis, increasing
    vertical: list[float]  # degrees from straight down, increasing
    rows: list[list[float]]  # by horizontal angle, then by vertical angle

    def table(self) -> tuple[float, ...]:
        """Returns the floats of operation IES."""
        angles = (math.radians(angle) for angle in (*self.horizontal, *self.vertical))
        return (float(len(self.horizontal)), *angles, *(value for row in self.rows for value in row))


def parse(text: str) -> Profile | None:
    """Returns the profile of a file's text, or None if it has none.

    Like Cycles, it is more forgiving than the standard: angles of any range are accepted.
    """
    _, found, rest = ("\n" + text).partition("\nTILT=")
    tilt, _, body = rest.partition("\n")
    try:
        numbers = (float(word) for word in body.replace(",", " ").split())
        if tilt.strip().startswith("INCLUDE"):
            next(numbers)  # how the lamp is mounted
            _take(numbers, 2 * int(next(numbers)))
        profile = _read(numbers) if found else None
    except (ValueError, OverflowError, StopIteration):
        return None
    if profile is None or len(profile.vertical) < 2 or len(profile.horizontal) < 2:
        return None
    is_ordered = all(list(angles) == sorted(angles) for angles in (profile.horizontal, profile.vertical))
    values = (*profile.horizontal, *profile.vertical, *(value for row in profile.rows for value in row))
    return profile if is_ordered and all(abs(value) < _MAXIMUM for value in values) else None


def _take(numbers: Iterator[float], count: int) -> list[float]:
    """Returns the next numbers. Raises ValueError if there are fewer, or an unreasonable number is asked for."""
    if not 0 <= count <= _MAXIMUM_ANGLES:
        raise ValueError(f"{count} values")
    taken = list(islice(numbers, count))
    if len(taken) < count:
        raise ValueError("the file is too short")
    return taken


def _read(numbers: Iterator[float]) -> Profile | None:
    """Reads what follows the tilt of the lamp."""
    _lamps, _lumens, multiplier, v_count, h_count, kind = _take(numbers, 6)
    _unit, _width, _length, _height, ballast, ballast_lamp, _watts = _take(numbers, 7)
    vertical, horizontal = _take(numbers, int(v_count)), _take(numbers, int(h_count))
    scale = multiplier * ballast * ballast_lamp * _WATTS_PER_CANDELA
    rows = [[scale * value for value in _take(numbers, len(vertical))] for _ in horizontal]
    convert = {_TYPE_A: _from_type_a, _TYPE_B: _from_type_b, _TYPE_C: _from_type_c}.get(int(kind))
    return convert(horizontal, vertical, rows) if convert is not None and horizontal and vertical else None


def _close(a: float, b: float) -> bool:
    return abs(a - b) < _TOLERANCE


def _both_sides(angles: list[float], rows: list[list[float]]) -> tuple[list[float], list[list[float]]]:
    """Mirrors a table that begins at 0°, so that it covers negative angles, too."""
    if not _close(angles[0], 0.0):
        return angles, rows
    return [-angle for angle in angles[:0:-1]] + angles, rows[:0:-1] + rows


def _from_type_a(horizontal: list[float], vertical: list[float], rows: list[list[float]]) -> Profile:
    """Type A: vertical angles from -90° to 90°, and horizontal ones that turn the other way, about 180°."""
    angles, rows = _both_sides(horizontal, rows)
    return Profile([180.0 - angle for angle in reversed(angles)], [angle + 90.0 for angle in vertical], rows[::-1])


def _from_type_b(horizontal: list[float], vertical: list[float], rows: list[list[float]]) -> Profile:
    """Type B has a horizontal axis. As in Cycles, the axes swap their roles; users turn the light."""
    by_vertical = [list(column) for column in zip(*rows, strict=True)]
    angles, by_vertical = _both_sides(vertical, by_vertical)
    columns = [list(column) for column in zip(*by_vertical, strict=True)]
    others, columns = _both_sides(horizontal, columns)
    by_vertical = [list(column) for column in zip(*columns, strict=True)]
    return Profile([angle + 90.0 for angle in angles], [angle + 90.0 for angle in others], by_vertical)


def _from_type_c(horizontal: list[float], vertical: list[float], rows: list[list[float]]) -> Profile:
    """Type C is the target: vertical angles from straight down, horizontal ones over a full turn.

    Profiles of symmetric luminaires have only a part of the turn.
    """
    if _close(horizontal[0], 90.0):
        horizontal = [angle - 90.0 for angle in horizontal]
    if len(horizontal) == 1:
        return Profile([0.0, 360.0], vertical, rows * 2)
    for half in (90.0, 180.0):
        if _close(horizontal[-1], half):
            horizontal = horizontal + [2.0 * half - angle for angle in horizontal[-2::-1]]
            rows = rows + rows[-2::-1]
    if _close(horizontal[0], 0.0) and not _close(horizontal[-1], 360.0):
        # Some files leave out 360°, which is the same as 0°. Their steps show it.
        gap = 360.0 - horizontal[-1]
        if _close(gap, horizontal[1] - horizontal[0]) or _close(gap, horizontal[-1] - horizontal[-2]):
            horizontal, rows = [*horizontal, 360.0], [*rows, rows[0]]
    return Profile(horizontal, vertical, rows)
