"""Modes of the animation benchmark: modes of stills frame by frame, the same over windows of frames, and peers."""

from __future__ import annotations

from dataclasses import replace

import modes
from modes import CYCLES, GRADUS, Mode

TEMPORAL = {"use_temporal": True}
PER_FRAME = ("path", "path-regularized", "gradient-l2", "gradient-l1", "gradient-regularized", "auto-denoised")
PEERS = ("cycles", "cycles-denoised")


def _temporal(label: str, name: str) -> Mode:
    """Returns a mode of stills over windows of frames."""
    return replace(modes.MODES[name], label=label, settings=modes.MODES[name].settings | TEMPORAL)


MODES = {
    **{name: modes.MODES[name] for name in PER_FRAME},
    "temporal-l2": _temporal("Gradus T-GPT + L2", "gradient-l2"),
    "temporal-l1": _temporal("Gradus T-GPT + L1", "gradient-l1"),
    "temporal-regularized": _temporal("Gradus T-GPT + REGULARIZED", "gradient-regularized"),
    "temporal-auto": _temporal("Gradus AUTO over windows", "auto"),
    "temporal-auto-denoised": _temporal("Gradus AUTO over windows + AUTO denoiser", "auto-denoised"),
    **{name: modes.MODES[name] for name in PEERS},
    # As in a new file: all frames have the same noise, which does not flicker where nothing moves.
    "cycles-denoised-still-seed": replace(
        modes.MODES["cycles-denoised"],
        label="Cycles + denoiser, one seed",
        settings=modes.MODES["cycles-denoised"].settings | {"use_animated_seed": False},
    ),
}

# Each engine is compared with its own converged frames by this mode.
REFERENCES = {GRADUS: "path", CYCLES: "cycles"}


def is_temporal(name: str) -> bool:
    return bool(MODES[name].settings.get("use_temporal"))


def per_frame(name: str) -> str:
    """Returns the mode that renders what a temporal mode renders, frame by frame.

    For stills, AUTO chooses path-regularized.
    """
    stills = {"temporal-auto": "path-regularized", "temporal-auto-denoised": "auto-denoised"}
    return stills.get(name) or name.replace("temporal", "gradient")
