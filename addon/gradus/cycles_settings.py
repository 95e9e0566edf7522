"""Settings of Cycles that have a counterpart here: limits of bounces, exposure and the pixel filter.

A scene that was made for Cycles keeps them, while those of Gradus start at their defaults, which equal Cycles'
defaults. Clamping is not copied, because it adds bias, and Cycles clamps by default.
"""

from __future__ import annotations

from typing import Any

from . import settings

SAME_NAME = (
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "transparent_max_bounces",
    "film_exposure",
    "filter_width",
)


def values(scene: Any) -> dict[str, Any]:
    """Returns values for settings of Gradus from the scene's Cycles settings, or {} if Cycles is disabled."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return {}
    found = {name: getattr(cycles, name) for name in SAME_NAME}
    found["pixel_filter"] = cycles.pixel_filter_type  # the same identifiers
    return found


def copy(scene: Any) -> None:
    """Copies the settings of Cycles."""
    for name, value in values(scene).items():
        setattr(scene.gradus, name, value)


def untouched(scene: Any) -> dict[str, Any]:
    """Returns the settings of Cycles that differ from those of Gradus and were never set for Gradus in this scene."""
    ours = scene.gradus
    return {
        name: value
        for name, value in values(scene).items()
        if not ours.is_property_set(name) and getattr(ours, name) != value
    }


def warnings(scene: Any, given: set[str]) -> list[str]:
    """Returns warnings about settings that differ from Cycles. given: settings that the command line sets."""
    listed = ", ".join(
        f"{settings.BY_NAME[name].label} ({name}) {_text(getattr(scene.gradus, name))} instead of {_text(value)}"
        for name, value in untouched(scene).items()
        if name not in given
    )
    ignored = ", ".join(_ignored(scene))
    texts = {
        "Settings differ from those that the scene has for Cycles (use Light Paths > Copy from Cycles)": listed,
        "Cycles would follow settings that Gradus does not have": ignored,
    }
    return [f"{start}: {items}" for start, items in texts.items() if items]


def _ignored(scene: Any) -> list[str]:
    """Returns the settings of Cycles that were chosen, change its picture and have no counterpart."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return []
    switches = {
        "Reflective Caustics off": not cycles.caustics_reflective,
        "Refractive Caustics off": not cycles.caustics_refractive,
        "Filter Glossy": cycles.is_property_set("blur_glossy") and cycles.blur_glossy > 0.0,
        "Fast GI Approximation": cycles.use_fast_gi,
        "Rolling Shutter": scene.render.use_motion_blur and cycles.rolling_shutter_type != "NONE",
    }
    return [name for name, is_on in switches.items() if is_on]


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
