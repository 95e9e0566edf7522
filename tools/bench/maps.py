"""Errors as colors on one scale for all maps, and the legend of that scale."""

from __future__ import annotations

import figures
import matplotlib
import numpy as np
from figures import plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from metrics import blurred

COLORS, SCALE = matplotlib.colormaps["magma"], LogNorm(0.01, 1.0, clip=True)
REACH = 10  # pixels by which the two blurs shrink a picture


def colored(relative_square: np.ndarray) -> np.ndarray:
    """Returns the square root of relative squared errors (height, width) as RGB bytes.

    Errors are blurred by 2 pixels first, because the variance of a reference can be subtracted from means only.
    """
    around = blurred(blurred(np.pad(relative_square, REACH, mode="reflect")))
    return COLORS(SCALE(np.sqrt(np.maximum(around, 0.0))), bytes=True)[:, :, :3]


def legend() -> str:
    """Writes the color scale and returns the name of its file."""
    figure, axes = plt.subplots(figsize=(3.6, 0.55), layout="constrained")
    ticks = [0.01, 0.03, 0.1, 0.3, 1.0]
    colors = ScalarMappable(SCALE, COLORS)
    bar = figure.colorbar(colors, cax=axes, orientation="horizontal", ticks=ticks, format="{x:g}")
    bar.minorticks_off()
    axes.set_title("error relative to the light", fontsize=8)
    return figures.save(figure, "error-scale.svg")
