"""Tests of values by scene against a bound, for the table of targets."""

from __future__ import annotations

import numpy as np

Found = tuple[str, bool | None]  # what was found, and whether the target is met
NOT_MEASURED: Found = ("not measured", None)


def every(found: dict[str, float], maximum: float) -> Found:
    """Tests all values against a maximum; the text has their median and the worst one."""
    if not found:
        return NOT_MEASURED
    worst = max(found, key=lambda name: found[name])
    met = sum(value <= maximum for value in found.values())
    return _counted(found, met, f"worst {found[worst]:.2f} ({worst})")


def median(found: dict[str, float], maximum: float) -> Found:
    """Tests the median of all values against a maximum."""
    if not found:
        return NOT_MEASURED
    value = middle_of(found)
    return f"{value:.2f} over {len(found)}", value <= maximum


def at_least(found: dict[str, float], minimum: float) -> Found:
    """Tests all values against a minimum; the text has their median and the lowest one."""
    if not found:
        return NOT_MEASURED
    lowest = min(found, key=lambda name: found[name])
    met = sum(value >= minimum for value in found.values())
    return _counted(found, met, f"lowest {found[lowest]:.2f} ({lowest})")


def within(found: dict[str, float], maximum: float) -> Found:
    """Tests how far all values are from 0; the text has the extremes."""
    if not found:
        return NOT_MEASURED
    low, high = min(found, key=lambda name: found[name]), max(found, key=lambda name: found[name])
    met = sum(abs(value) <= maximum for value in found.values())
    text = f"{met} of {len(found)}; {100 * found[low]:+.1f} % ({low}) to {100 * found[high]:+.1f} % ({high})"
    return text, met == len(found)


def _counted(found: dict[str, float], met: int, extreme: str) -> Found:
    return f"{met} of {len(found)}; median {middle_of(found):.2f}, {extreme}", met == len(found)


def middle_of(found: dict[str, float]) -> float:
    return float(np.median(list(found.values())))
