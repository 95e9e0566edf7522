"""The figures of the report, as SVG beside it; the same results give the same files."""

from __future__ import annotations

import matplotlib
import numpy as np
from modes import CYCLES, GRADUS, MODES
from results import FOLDER, SceneResults

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "gradus", "font.size": 8, "path.simplify": True})
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter  # noqa: E402

DASHES = {GRADUS: "-", CYCLES: "--"}


def error_figure(scene: SceneResults) -> str:
    """relMSE, relMSE without the worst 0.1 %, and HDR-FLIP against CPU seconds; the legend tells the slope over the last decade."""
    measures = {"relmse": "relMSE", "relmse_trimmed": "relMSE-t", "flip": "HDR-FLIP"}
    measures = {m: label for m, label in measures.items() if any(scene.curve(mode, m) for mode in scene.modes())}
    figure, panels = plt.subplots(1, len(measures), figsize=(3.5 * len(measures), 3.6), squeeze=False, layout="constrained")
    for axes, (measure, label) in zip(panels[0], measures.items(), strict=True):
        for mode in scene.modes():
            if points := scene.curve(mode, measure):
                slope = scene.slope(mode)
                name = f"{MODES[mode].label} ({slope:.2f})" if slope is not None else MODES[mode].label
                axes.loglog(*zip(*points, strict=True), DASHES.get(MODES[mode].engine, ":"), marker=".", color=color(mode), label=name)
        axes.set_xlabel("CPU seconds")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_title(f"{scene.name}: {label}")
        axes.grid(True, alpha=0.25)
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=len(measures) + 1, fontsize=7)
    return save(figure, f"{scene.name}.svg")


def bias_figure(scene: SceneResults) -> str | None:
    """bias² and variance against samples, of all modes for which the sums over seeds are known."""
    figure, axes = plt.subplots(figsize=(4.2, 3.3), layout="constrained")
    drawn = 0
    for mode in scene.modes():
        found = [(point.samples, parts) for point in scene.points[mode] if (parts := point.bias_and_variance())]
        if len(found) < 2:
            continue
        samples = [n for n, _ in found]
        axes.loglog(samples, [variance for _, (_, variance) in found], "-", color=color(mode), label=MODES[mode].label)
        axes.loglog(samples, [max(bias, np.nan) if bias > 0 else np.nan for _, (bias, _) in found], ":", marker=".", color=color(mode))
        drawn += 1
    if not drawn:
        plt.close(figure)
        return None
    axes.set_xlabel("samples per pixel")
    axes.set_title(f"{scene.name}: variance (lines) and bias² (dots)")
    axes.grid(True, alpha=0.25)
    axes.legend(fontsize=6)
    return save(figure, f"{scene.name}-bias.svg")


def color(mode: str) -> str:
    """The same in every figure."""
    return f"C{list(MODES).index(mode)}"


def save(figure: plt.Figure, name: str) -> str:
    figure.savefig(FOLDER / name, metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return name
