"""Settings of Cycles that have a counterpart here: bounces, caustics, Filter Glossy, exposure and the pixel filter.

A scene that was made for Cycles keeps them: unless Follow Cycles is off, they stand for those that were never set for
Gradus. Clamping is neither followed nor copied, because it adds bias, and Cycles clamps by default.
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
    "blur_glossy",
    "caustics_reflective",
    "caustics_refractive",
    "film_exposure",
    "filter_width",
)

_NAMES = {name: name for name in SAME_NAME} | {"pixel_filter": "pixel_filter_type"}
"""The name that Cycles has for each setting. The identifiers of pixel filters are the same."""


def values(scene: Any) -> dict[str, Any]:
    """Returns values for settings of Gradus from the scene's Cycles settings, or {} if Cycles is disabled."""
    cycles = getattr(scene, "cycles", None)
    return {} if cycles is None else {ours: getattr(cycles, theirs) for ours, theirs in _NAMES.items()}


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


def owner(scene: Any, name: str, is_followed: bool) -> tuple[Any, str]:
    """Returns what has the value of a setting that renders use: the settings of Gradus or of Cycles, and its name."""
    cycles = getattr(scene, "cycles", None) if is_followed and name in _NAMES else None
    if cycles is None or scene.gradus.is_property_set(name):
        return scene.gradus, name
    return cycles, _NAMES[name]


def warnings(scene: Any, given: set[str], is_followed: bool) -> list[str]:
    """Returns warnings about settings that differ from Cycles. given: settings that the command line sets."""
    differing = {} if is_followed else untouched(scene)
    listed = ", ".join(
        f"{settings.BY_NAME[name].label} ({name}) {_text(getattr(scene.gradus, name))} instead of {_text(value)}"
        for name, value in differing.items()
        if name not in given
    )
    ignored = ", ".join(_ignored(scene))
    texts = {
        "Settings differ from those that the scene has for Cycles (use Light Paths > Copy from Cycles)": listed,
        "Cycles would follow settings that Gradus does not have": ignored,
    }
    return [f"{start}: {items}" for start, items in texts.items() if items]


def clamp_warnings(scene: Any, clamp_direct: float) -> list[str]:
    """Returns a warning if direct light is clamped and Cycles chooses among several lights without its light tree.

    A light that is chosen rarely adds more at once, so that a clamp cuts more of it. Cycles has a light tree since 3.5.
    """
    has_tree = getattr(getattr(scene, "cycles", None), "use_light_tree", False)
    lights = sum(obj.type == "LIGHT" for obj in scene.objects) + (scene.world is not None)
    if clamp_direct <= 0.0 or has_tree or lights < 2:
        return []
    return [
        f"Clamp Direct is {clamp_direct:g}: without a light tree, Cycles chooses among the {lights} lights in another way "
        "than Gradus, so that it clamps other parts of their light"
    ]


def _ignored(scene: Any) -> list[str]:
    """Returns the settings of Cycles that were chosen, change its picture and have no counterpart."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return []
    switches = {
        "Fast GI Approximation": cycles.use_fast_gi,
        "Use Pixel Jitter": getattr(cycles, "use_pixel_jitter", False),  # of developers, since 5.2
        "Texture Limit": scene.render.use_simplify and cycles.texture_limit_render != "OFF",
        "Rolling Shutter": scene.render.use_motion_blur and cycles.rolling_shutter_type != "NONE",
    }
    return [name for name, is_on in switches.items() if is_on]


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
