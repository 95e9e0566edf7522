"""The shutter of Blender's motion blur, and the times at which objects are sampled while it is open."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from typing import Any

MAX_KEYS = 129  # limit of the library
_CURVE_POINTS = 257


@dataclass(frozen=True)
class Shutter:
    """The shutter. Times are in frames, relative to the rendered frame."""

    open: float
    close: float
    curve: array | None = None  # its opening at equidistant times from open to close; None if it is constant

    def times(self, keys: int) -> list[float]:
        """Returns equidistant times from opening to closing."""
        return [self.open + (self.close - self.open) * (key / (keys - 1)) for key in range(keys)]


def shutter_of(scene: Any, view_layer: Any) -> Shutter | None:
    """Returns the shutter, or None without motion blur."""
    render = scene.render
    if not (render.use_motion_blur and view_layer.use_motion_blur) or render.motion_blur_shutter <= 0.0:
        return None
    length = render.motion_blur_shutter
    start = {"START": 0.0, "END": -length}.get(_position(scene), -0.5 * length)
    # The curve of the original scene, because evaluated copies are not updated when it changes.
    return Shutter(start, start + length, _curve(scene.original.render.motion_blur_shutter_curve))


def position_owner(scene: Any) -> Any:
    """Returns the owner of the property motion_blur_position.

    From 4.2 on these are the render settings, before that Cycles' settings. Returns None if Cycles is disabled.
    """
    owners = (scene.render, getattr(scene, "cycles", None))
    return next((owner for owner in owners if hasattr(owner, "motion_blur_position")), None)


def _position(scene: Any) -> str:
    """Returns the place of the frame in the exposure: START, CENTER or END."""
    return getattr(position_owner(scene), "motion_blur_position", "CENTER")


def _curve(mapping: Any) -> array | None:
    mapping.initialize()
    curve = mapping.curves[0]
    values = array("f", [mapping.evaluate(curve, i / (_CURVE_POINTS - 1)) for i in range(_CURVE_POINTS)])
    return None if all(value == values[0] for value in values) else values


@dataclass(frozen=True)
class Blur:
    """The number of time keys of an object, which is 0 without motion blur, and whether its deformation is blurred."""

    keys: int = 0
    deform: bool = False


NO_BLUR = Blur()


def blur_of(obj: Any, parent: Any = None) -> Blur:
    """Returns the motion blur of an object, or of its instances by `parent`, as in Cycles.

    Both switches must be on, and the larger number of steps counts. If Cycles is disabled, its defaults are used.
    """
    owners = [getattr(owner, "cycles", None) for owner in ((obj,) if parent is None else (obj, parent))]
    if not all(getattr(settings, "use_motion_blur", True) for settings in owners):
        return NO_BLUR
    steps = max(max(getattr(settings, "motion_steps", 1), 1) for settings in owners)
    deform = getattr(owners[0], "use_deform_motion", True)
    return Blur(min(2**steps + 1, MAX_KEYS), deform)
