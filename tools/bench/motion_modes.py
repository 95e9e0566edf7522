"""What is compared in flicker along the components' ways: windows with and without components, and frames by themselves."""

from __future__ import annotations

from dataclasses import replace

import modes
from modes import GRADUS, Mode

PARTS = {"use_decomposition": True, "components": ""}
WHOLE = {"use_decomposition": False}
WINDOWS, FRAMES = {"use_temporal": True}, {"use_temporal": False}
ALONG_SURFACES = {"component_replays": False}


def _solved(name: str, label: str, **settings: object) -> Mode:
    """A mode of stills with more settings."""
    found = modes.MODES[name]
    return replace(found, label=f"{found.label}, {label}", settings=found.settings | settings)


def _family(solver: str) -> dict[str, Mode]:
    name = f"gradient-{solver}"
    return {
        f"frames-{solver}": _solved(name, "frame by frame", **FRAMES, **WHOLE),
        f"frames-parts-{solver}": _solved(name, "components, frame by frame", **FRAMES, **PARTS),
        f"windows-{solver}": _solved(name, "windows", **WINDOWS, **WHOLE),
        f"windows-parts-surfaces-{solver}": _solved(name, "windows of components along surfaces", **WINDOWS, **PARTS, **ALONG_SURFACES),
        f"windows-parts-{solver}": _solved(name, "windows of components along their own ways", **WINDOWS, **PARTS),
    }


MODES = {
    "path": replace(modes.MODES["path"], settings=modes.MODES["path"].settings | FRAMES | WHOLE),
    "whole": Mode("Gradus PT + REGULARIZED", GRADUS, modes.MODES["path-regularized"].settings | FRAMES | WHOLE),
    "parts": Mode("Gradus PT + REGULARIZED, components", GRADUS, modes.MODES["path-regularized"].settings | FRAMES | PARTS),
    **_family("l2"),
    **_family("regularized"),
}
FLICKER = tuple(mode for mode in MODES if mode.startswith(("frames", "windows")))


def compared_with(name: str) -> str:
    """The same solver over windows without components: what components are to better."""
    return f"windows-{name.rsplit('-', 1)[1]}"
