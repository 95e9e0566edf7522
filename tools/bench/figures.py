"""Figures of the report, as SVG files beside it. The same results give the same files."""

from __future__ import annotations

import matplotlib
import numpy as np
from modes import CYCLES, GRADUS, MODES, Mode
from paths import OUT
from results import SceneResults

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "gradus", "font.size": 8, "path.simplify": True})
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter  # noqa: E402

DASHES = {GRADUS: "-", CYCLES: "--"}
PEER = "cycles-denoised"
OURS = ("path-regularized", "auto-denoised")
SUMMARY_SCENES = ("hero", "kitchen", "glass-teapot")
SUMMARY_MODES = ("path", "gradient-l2", "gradient-l1", *OURS, PEER)


def error_figure(scene: SceneResults) -> str:
    """Draws relMSE, relMSE without the worst 0.1 %, and HDR-FLIP against CPU seconds.

    The legend has the slopes of relMSE.
    """
    measures = {"relmse": "relMSE", "relmse_trimmed": "relMSE-t", "flip": "HDR-FLIP"}
    measures = {m: label for m, label in measures.items() if any(scene.curve(mode, m) for mode in scene.modes())}
    size = (3.5 * len(measures), 3.6)
    figure, panels = plt.subplots(1, len(measures), figsize=size, squeeze=False, layout="constrained")
    for axes, (measure, label) in zip(panels[0], measures.items(), strict=True):
        for mode in scene.modes():
            slope = scene.slope(mode)
            _draw(axes, scene, mode, measure, MODES[mode].label + (f" ({slope:.2f})" if slope is not None else ""))
        _label_times(axes, f"{scene.name}: {label}")
    _legend_below(figure, panels[0][0], len(measures) + 1)
    return save(figure, f"{scene.name}.svg")


def summary_figure(scenes: list[SceneResults]) -> str | None:
    """Draws relMSE of the main modes against CPU seconds in a few scenes."""
    shown = [scene for scene in scenes if scene.name in SUMMARY_SCENES and "path" in scene.points]
    if not shown:
        return None
    figure, panels = plt.subplots(1, len(shown), figsize=(3.2 * len(shown), 3.4), squeeze=False, layout="constrained")
    for axes, scene in zip(panels[0], shown, strict=True):
        for mode in SUMMARY_MODES:
            _draw(axes, scene, mode, "relmse", MODES[mode].label)
        _label_times(axes, scene.name)
    panels[0][0].set_ylabel("relMSE")
    _legend_below(figure, panels[0][0], 3)
    return save(figure, "error-curves.svg")


def ratio_figure(scenes: list[SceneResults]) -> str | None:
    """Draws relMSE of the main modes over that of Cycles with its denoiser at equal CPU time, a row for each scene."""
    found = [(scene.name, *(scene.ratio(mode, PEER) for mode in OURS)) for scene in scenes]
    rows = sorted((row for row in found if row[-1] is not None), key=lambda row: row[-1], reverse=True)
    if not rows:
        return None
    figure, axes = plt.subplots(figsize=(7.0, 0.8 + 0.18 * len(rows)), layout="constrained")
    for column, mode in enumerate(OURS, 1):
        points = [(row[column], place) for place, row in enumerate(rows) if row[column] is not None]
        if points:
            axes.plot(
                *zip(*points, strict=True), "so"[column - 1], color=color(mode), label=MODES[mode].label, markersize=4.5
            )
    axes.axvline(1.0, linestyle="--", color=color(PEER), label=MODES[PEER].label)
    axes.set_xscale("log")
    axes.set_yticks(range(len(rows)), [row[0] for row in rows])
    axes.set_xlabel(f"relMSE over that of {MODES[PEER].label} at equal CPU time; lower is better")
    _format_logarithmic(axes)
    axes.legend(loc="lower left")
    return save(figure, "error-ratios.svg")


def animation_figure(scene: SceneResults, modes: dict[str, Mode], name: str) -> str:
    """Draws relMSE and F against CPU seconds; noise alone is dotted."""
    figure, panels = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
    for axes, (measure, label) in zip(panels, {"relmse": "relMSE", "flicker": "F"}.items(), strict=True):
        for place, mode in enumerate(modes):
            style = {"color": matplotlib.colormaps["tab20"](place), "marker": "."}
            if points := scene.curve(mode, measure):
                axes.loglog(*zip(*points, strict=True), DASHES[modes[mode].engine], label=modes[mode].label, **style)
            if points := scene.curve(mode, f"{measure}_noise"):
                axes.loglog(*zip(*points, strict=True), ":", **style)
        _label_times(axes, f"{scene.name}: {label} (dotted: its noise)")
    _legend_below(figure, panels[0], 3)
    return save(figure, name)


def bias_figure(scene: SceneResults) -> str | None:
    """Draws bias² and variance against samples for all modes for which the sums over seeds are known."""
    figure, axes = plt.subplots(figsize=(4.2, 3.3), layout="constrained")
    drawn = 0
    for mode in scene.modes():
        found = [(point.samples, parts) for point in scene.points[mode] if (parts := point.bias_and_variance())]
        if len(found) < 2:
            continue
        samples = [n for n, _ in found]
        axes.loglog(samples, [variance for _, (_, variance) in found], "-", color=color(mode), label=MODES[mode].label)
        biases = [bias if bias > 0.0 else np.nan for _, (bias, _) in found]
        axes.loglog(samples, biases, ":", marker=".", color=color(mode))
        drawn += 1
    if not drawn:
        plt.close(figure)
        return None
    axes.set_xlabel("samples per pixel")
    axes.set_title(f"{scene.name}: variance (lines) and bias² (dots)")
    axes.grid(True, alpha=0.25)
    axes.legend(fontsize=6)
    return save(figure, f"{scene.name}-bias.svg")


def color(mode: str) -> tuple[float, ...]:
    """Returns the color that a mode has in every figure."""
    return matplotlib.colormaps["tab20"](list(MODES).index(mode))


def save(figure: plt.Figure, name: str) -> str:
    OUT.mkdir(parents=True, exist_ok=True)
    figure.savefig(OUT / name, metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return name


def _draw(axes: plt.Axes, scene: SceneResults, mode: str, measure: str, label: str) -> None:
    if points := scene.curve(mode, measure):
        dashes = DASHES.get(MODES[mode].engine, ":")
        axes.loglog(*zip(*points, strict=True), dashes, marker=".", color=color(mode), label=label)


def _label_times(axes: plt.Axes, title: str) -> None:
    axes.set_xlabel("CPU seconds")
    axes.set_title(title)
    _format_logarithmic(axes)


def _format_logarithmic(axes: plt.Axes) -> None:
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(True, alpha=0.25)


def _legend_below(figure: plt.Figure, axes: plt.Axes, columns: int) -> None:
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=columns, fontsize=7)
