"""When the shutter is open, as Blender's settings have it, and at which of these moments an object is looked at."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from typing import Any

MAX_KEYS = 129  # of the library
_CURVE_POINTS = 257


@dataclass(frozen=True)
class Shutter:
    """Times in frames, relative to the one rendered."""

    open: float
    close: float
    curve: array | None = None  # how far it is open, evenly from opening to closing; None = all the time

    def times(self, keys: int) -> list[float]:
        """`keys` moments, evenly from opening to closing. Those of fewer keys are among those of more."""
        return [self.open + (self.close - self.open) * (key / (keys - 1)) for key in range(keys)]


def shutter_of(scene: Any, view_layer: Any) -> Shutter | None:
    """None: the picture is a moment."""
    render = scene.render
    if not (render.use_motion_blur and view_layer.use_motion_blur) or render.motion_blur_shutter <= 0.0:
        return None
    length = render.motion_blur_shutter
    start = {"START": 0.0, "END": -length}.get(_position(scene), -0.5 * length)
    # The original's curve: evaluated copies do not learn of changes to it.
    return Shutter(start, start + length, _curve(scene.original.render.motion_blur_shutter_curve))


def position_owner(scene: Any) -> Any:
    """What has the property motion_blur_position: from 4.2 on the render settings, before Cycles'; None where Cycles is switched off."""
    owners = (scene.render, getattr(scene, "cycles", None))
    return next((owner for owner in owners if hasattr(owner, "motion_blur_position")), None)


def _position(scene: Any) -> str:
    """START, CENTER or END of the exposure is the frame."""
    return getattr(position_owner(scene), "motion_blur_position", "CENTER")


def _curve(mapping: Any) -> array | None:
    mapping.initialize()
    curve = mapping.curves[0]
    values = array("f", [mapping.evaluate(curve, i / (_CURVE_POINTS - 1)) for i in range(_CURVE_POINTS)])
    return None if all(value == values[0] for value in values) else values


@dataclass(frozen=True)
class Blur:
    """Time keys of an object; 0 = it is sharp."""

    keys: int = 0
    deform: bool = False


SHARP = Blur()


def blur_of(obj: Any, parent: Any = None) -> Blur:
    """As Cycles has it: the instancer's switches count, too, and the larger number of steps. Its defaults where Cycles is switched off."""
    owners = [getattr(owner, "cycles", None) for owner in ((obj,) if parent is None else (obj, parent))]
    if not all(getattr(settings, "use_motion_blur", True) for settings in owners):
        return SHARP
    steps = max(max(getattr(settings, "motion_steps", 1), 1) for settings in owners)
    deform = getattr(owners[0], "use_deform_motion", True)
    return Blur(min(2**steps + 1, MAX_KEYS), deform)
