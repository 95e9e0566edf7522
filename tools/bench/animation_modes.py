"""Modes of the animation benchmark: modes of stills frame by frame, the same over several frames, and peers."""

from __future__ import annotations

from dataclasses import replace

import modes
from modes import CYCLES, GRADUS, Mode

TEMPORAL = {"use_temporal": True}
PEER, STILL_SEED = "cycles-denoised", "cycles-denoised-still-seed"
ONE_BY_ONE, DELIVERED = "auto-denoised", "temporal-auto-denoised"  # by default, and with temporal off
WITHOUT_DENOISER = "temporal-auto"


def _temporal(label: str, name: str) -> Mode:
    """Returns a mode of stills over several frames."""
    return replace(modes.MODES[name], label=label, settings=modes.MODES[name].settings | TEMPORAL)


# AUTO joins nine frames of plain paths by REGULARIZED, and its denoiser reads all of them. One by one, frames are
# denoised from eight samples on. L2 and L1 have windows of ten frames, half of whose samples replay those of the frame
# before.
MODES = {
    ONE_BY_ONE: replace(modes.MODES["auto-denoised"], label="Gradus AUTO, frames one by one"),
    DELIVERED: _temporal("Gradus AUTO", "auto-denoised"),
    WITHOUT_DENOISER: _temporal("Gradus AUTO without its denoiser", "auto"),
    "path-regularized": modes.MODES["path-regularized"],
    "path-denoised": modes.MODES["path-denoised"],
    PEER: modes.MODES[PEER],
    # As in a new file: all frames have the same noise, which does not flicker where nothing moves.
    STILL_SEED: replace(
        modes.MODES[PEER],
        label="Cycles + denoiser, one seed",
        settings=modes.MODES[PEER].settings | {"use_animated_seed": False},
    ),
    "path": modes.MODES["path"],
    "gradient-l2": modes.MODES["gradient-l2"],
    "temporal-l2": _temporal("Gradus T-GPT + L2", "gradient-l2"),
    "gradient-l1": modes.MODES["gradient-l1"],
    "temporal-l1": _temporal("Gradus T-GPT + L1", "gradient-l1"),
    "cycles": modes.MODES["cycles"],
}
# Sample counts of a quick run. Each mode that is compared with AUTO takes a time within that of its counts.
QUICK = {ONE_BY_ONE: (4, 8), DELIVERED: (4, 16), WITHOUT_DENOISER: (4,), PEER: (4,), STILL_SEED: (4,)}

# Each engine is compared with its own converged frames by this mode.
REFERENCES = {GRADUS: "path", CYCLES: "cycles"}


def is_temporal(name: str) -> bool:
    return bool(MODES[name].settings.get("use_temporal"))


def per_frame(name: str) -> str:
    """Returns the mode that renders what a temporal mode renders, frame by frame.

    Without its denoiser, AUTO is path-regularized for stills.
    """
    stills = {DELIVERED: ONE_BY_ONE, WITHOUT_DENOISER: "path-regularized"}
    return stills.get(name) or name.replace("temporal", "gradient")
