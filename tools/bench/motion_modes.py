"""What is compared in flicker along the components' ways: windows with and without components, and frames by themselves."""

from __future__ import annotations

from dataclasses import replace

import modes
from modes import GRADUS, Mode

PARTS = {"use_decomposition": True, "components": ""}
WHOLE = {"use_decomposition": False}
WINDOWS, FRAMES = {"use_temporal": True}, {"use_temporal": False}
ALONG_SURFACES = {"component_replays": False}
AUTO = replace(
    modes.MODES["auto"], label="Gradus AUTO + REGULARIZED", settings=modes.MODES["auto"].settings | {"reconstruction": "REGULARIZED"}
)
SOLVERS = {"l2": modes.MODES["gradient-l2"], "regularized": modes.MODES["gradient-regularized"], "auto": AUTO}
"""By what families of modes are named; `auto` is what an animation gets where nothing is chosen."""


def _family(solver: str) -> dict[str, Mode]:
    solved = SOLVERS[solver]

    def mode(label: str, **settings: object) -> Mode:
        return replace(solved, label=f"{solved.label}, {label}", settings=solved.settings | settings)

    return {
        f"frames-{solver}": mode("frame by frame", **FRAMES, **WHOLE),
        f"frames-parts-{solver}": mode("components, frame by frame", **FRAMES, **PARTS),
        f"windows-{solver}": mode("windows", **WINDOWS, **WHOLE),
        f"windows-parts-surfaces-{solver}": mode("windows of components along surfaces", **WINDOWS, **PARTS, **ALONG_SURFACES),
        f"windows-parts-{solver}": mode("windows of components along their own ways", **WINDOWS, **PARTS),
    }


MODES = {
    "path": replace(modes.MODES["path"], settings=modes.MODES["path"].settings | FRAMES | WHOLE),
    "whole": Mode("Gradus PT + REGULARIZED", GRADUS, modes.MODES["path-regularized"].settings | FRAMES | WHOLE),
    "parts": Mode("Gradus PT + REGULARIZED, components", GRADUS, modes.MODES["path-regularized"].settings | FRAMES | PARTS),
    **{name: mode for solver in SOLVERS for name, mode in _family(solver).items()},
}
FLICKER = tuple(mode for mode in MODES if mode.startswith(("frames", "windows")))
USUAL = tuple(mode for mode in FLICKER if not mode.startswith("frames-parts"))  # those are the same pictures as without components
DELIVERED = "windows-parts-auto"  # an animation as it is delivered


def solver_of(name: str) -> str:
    return name.rsplit("-", 1)[1]


def compared_with(name: str) -> str:
    """The same solver over windows without components: what components are to better."""
    return f"windows-{solver_of(name)}"


def along_surfaces(name: str) -> str:
    """The same solver over windows of components that go with the surfaces: what their own ways are to better."""
    return f"windows-parts-surfaces-{solver_of(name)}"
