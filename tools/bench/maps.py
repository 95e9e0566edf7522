"""Errors as colours, on one scale for all maps, and its legend."""

from __future__ import annotations

import figures
import matplotlib
import numpy as np
from figures import plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from metrics import blurred

COLORS, SCALE = matplotlib.colormaps["magma"], LogNorm(0.01, 1.0, clip=True)
REACH = 10  # pixels of the blur


def colored(relative_square: np.ndarray) -> np.ndarray:
    """Root of relative squared errors (height, width), as RGB bytes. Blurred by 2 pixels: a reference's variance can be taken away from
    means alone."""
    around = blurred(blurred(np.pad(relative_square, REACH, mode="reflect")))
    return COLORS(SCALE(np.sqrt(np.maximum(around, 0.0))), bytes=True)[:, :, :3]


def legend() -> str:
    figure, axes = plt.subplots(figsize=(3.6, 0.55), layout="constrained")
    bar = figure.colorbar(
        ScalarMappable(SCALE, COLORS), cax=axes, orientation="horizontal", ticks=[0.01, 0.03, 0.1, 0.3, 1.0], format="{x:g}"
    )
    bar.minorticks_off()
    axes.set_title("error relative to the light", fontsize=8)
    return figures.save(figure, "error-scale.svg")
