"""Modes of the motion benchmark: frames by themselves and windows of frames, with and without components."""

from __future__ import annotations

from dataclasses import replace

import modes
from modes import GRADUS, Mode

COMPONENTS = {"use_decomposition": True, "components": ""}
COMBINED = {"use_decomposition": False}
WINDOWS, FRAMES = {"use_temporal": True}, {"use_temporal": False}
ALONG_SURFACES = {"component_replays": False}
# What an animation gets by default, but for the denoiser.
AUTO = replace(
    modes.MODES["auto"],
    label="Gradus AUTO + REGULARIZED",
    settings=modes.MODES["auto"].settings | {"reconstruction": "REGULARIZED"},
)
SOLVERS = {"l2": modes.MODES["gradient-l2"], "regularized": modes.MODES["gradient-regularized"], "auto": AUTO}


def _family(solver: str) -> dict[str, Mode]:
    """Returns the modes of one solver."""
    solved = SOLVERS[solver]

    def mode(label: str, **settings: object) -> Mode:
        return replace(solved, label=f"{solved.label}, {label}", settings=solved.settings | settings)

    return {
        f"frames-{solver}": mode("frame by frame", **FRAMES, **COMBINED),
        f"frames-components-{solver}": mode("components, frame by frame", **FRAMES, **COMPONENTS),
        f"windows-{solver}": mode("windows", **WINDOWS, **COMBINED),
        f"windows-components-surfaces-{solver}": mode(
            "windows of components along surfaces", **WINDOWS, **COMPONENTS, **ALONG_SURFACES
        ),
        f"windows-components-{solver}": mode("windows of components along their own motion", **WINDOWS, **COMPONENTS),
    }


MODES = {
    "path": replace(modes.MODES["path"], settings=modes.MODES["path"].settings | FRAMES | COMBINED),
    "combined": Mode("Gradus PT + REGULARIZED", GRADUS, modes.MODES["path-regularized"].settings | FRAMES | COMBINED),
    "components": Mode(
        "Gradus PT + REGULARIZED, components", GRADUS, modes.MODES["path-regularized"].settings | FRAMES | COMPONENTS
    ),
    **{name: mode for solver in SOLVERS for name, mode in _family(solver).items()},
}
FLICKER = tuple(mode for mode in MODES if mode.startswith(("frames", "windows")))
# Frames of components by themselves are the same pictures as frames without components.
USUAL = tuple(mode for mode in FLICKER if not mode.startswith("frames-components"))
DELIVERED = "windows-components-auto"  # the default of an animation with components


def solver_of(name: str) -> str:
    return name.rsplit("-", 1)[1]


def compared_with(name: str) -> str:
    """Returns the mode of the same solver over windows without components."""
    return f"windows-{solver_of(name)}"


def along_surfaces(name: str) -> str:
    """Returns the mode of the same solver over windows of components that follow the motion of surfaces."""
    return f"windows-components-surfaces-{solver_of(name)}"
