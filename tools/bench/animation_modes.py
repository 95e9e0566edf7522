"""What is compared in animations: per-frame modes of the still benchmark, the temporal ones beside them, and peers."""

from __future__ import annotations

from dataclasses import replace

import modes
from modes import CYCLES, GRADUS, Mode

TEMPORAL = {"use_temporal": True}
PER_FRAME = ("path", "path-regularized", "gradient-l2", "gradient-weighted", "gradient-l1", "gradient-regularized")
PEERS = ("cycles", "cycles-denoised")


def _temporal(name: str) -> Mode:
    """A mode of gradients, over windows of frames."""
    mode = modes.MODES[name]
    return replace(mode, label=mode.label.replace("G-PT", "T-GPT"), settings=mode.settings | TEMPORAL)


MODES = {
    **{name: modes.MODES[name] for name in PER_FRAME},
    **{name.replace("gradient", "temporal"): _temporal(name) for name in PER_FRAME if name.startswith("gradient")},
    **{name: modes.MODES[name] for name in PEERS},
    # As in a new file: all frames have the same noise, which does not flicker where nothing moves.
    "cycles-denoised-still-seed": replace(
        modes.MODES["cycles-denoised"],
        label="Cycles + denoiser, one seed",
        settings=modes.MODES["cycles-denoised"].settings | {"use_animated_seed": False},
    ),
}
REFERENCES = {GRADUS: "path", CYCLES: "cycles"}  # each engine against its own converged frames


def is_temporal(name: str) -> bool:
    return bool(MODES[name].settings.get("use_temporal"))


def per_frame(name: str) -> str:
    """What a temporal mode is called frame by frame."""
    return name.replace("temporal", "gradient")
