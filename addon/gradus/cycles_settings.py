"""Settings of Cycles that say what the picture shows, and that ours can take over: limits of bounces, exposure, pixel filter.

A scene that was made for Cycles keeps them; ours begin at their own defaults, which are Cycles'. Clamps are not among them: they are bias,
and Cycles' default of 10 stands for a denoiser that we do not need.
"""

from __future__ import annotations

from typing import Any

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
    """Setting of ours -> what the scene's Cycles settings say; {} where Cycles is switched off."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return {}
    found = {name: getattr(cycles, name) for name in SAME_NAME}
    found["pixel_filter"] = cycles.pixel_filter_type  # the same identifiers
    return found


def copy(scene: Any) -> None:
    """Makes ours equal to Cycles'."""
    for name, value in values(scene).items():
        setattr(scene.gradus, name, value)


def untouched(scene: Any) -> dict[str, Any]:
    """Those that Cycles has at another value, and that nobody has set for us in this scene."""
    ours = scene.gradus
    return {name: value for name, value in values(scene).items() if not ours.is_property_set(name) and getattr(ours, name) != value}


def warnings(scene: Any, given: set[str]) -> list[str]:
    """What a render has to say about it. given: settings that the command line sets."""
    listed = ", ".join(
        f"{name} {_text(getattr(scene.gradus, name))} (Cycles: {_text(value)})"
        for name, value in untouched(scene).items()
        if name not in given
    )
    return (
        [f"Settings are not those that the scene has for Cycles (Light Paths > Copy from Cycles takes them over): {listed}"]
        if listed
        else []
    )


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
