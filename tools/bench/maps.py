"""Errors as colours, on one scale for all maps, and its legend."""

from __future__ import annotations

import figures
import matplotlib
import numpy as np
from figures import plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm

COLORS, SCALE = matplotlib.colormaps["magma"], LogNorm(0.01, 1.0, clip=True)
SIDE = 7  # pixels over which errors are averaged: what a reference's variance takes away, it takes from means


def colored(relative_square: np.ndarray) -> np.ndarray:
    """Root of relative squared errors (height, width) as RGB bytes."""
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(relative_square, SIDE // 2, mode="reflect"), (SIDE, SIDE))
    return COLORS(SCALE(np.sqrt(np.maximum(windows.mean(axis=(2, 3)), 0.0))), bytes=True)[:, :, :3]


def legend() -> str:
    figure, axes = plt.subplots(figsize=(3.6, 0.55), layout="constrained")
    bar = figure.colorbar(
        ScalarMappable(SCALE, COLORS), cax=axes, orientation="horizontal", ticks=[0.01, 0.03, 0.1, 0.3, 1.0], format="{x:g}"
    )
    bar.minorticks_off()
    axes.set_title(f"error relative to the light, {SIDE}×{SIDE} pixels", fontsize=8)
    return figures.save(figure, "error-scale.svg")
