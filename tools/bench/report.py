"""Makes docs/benchmark/README.md and report.html, with their figures and pictures, from the stored results alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import animation_report
import behind
import figures
import maps
import motion_report
import numpy as np
import pictures
import results
import speed
import targets
from document import Block, Figure, HtmlOnly, Table, Text, number, spread, to_html, to_markdown
from modes import MODES
from results import FOLDER, Point, SceneResults
from rooms import CHOICE, ENGINES, ROOMS

HERE = Path(__file__).parent
TITLE = "Gradus: error against CPU time"
OTHERS = [mode for mode in MODES if mode not in ("path", "gradient-none")]
SLOPES = {"PT": "path", "L2": "gradient-l2", "REGULARIZED": "path-regularized"}


def equal_time(scenes: list[SceneResults]) -> list[Block]:
    """Error ratios to plain path tracing at equal CPU time, with export and without, and the inverse: time at equal error."""
    columns = ["scene", *(MODES[mode].label.removeprefix("Gradus ") for mode in OTHERS)]

    def table(value: Callable[[SceneResults, str], float | None], slopes: bool = True) -> Table:
        made = Table([*columns, *(f"slope {name}" for name in SLOPES if slopes)])
        for scene in scenes:
            cells = [number(value(scene, mode)) for mode in OTHERS]
            cells += [number(scene.slope(mode)) for mode in SLOPES.values() if slopes]
            made.rows.append([scene.name, *cells])
        return made

    about = "R: relMSE over that of Gradus PT, export and build included. Below 1 is better than plain path tracing."
    return [
        Text(f"## Error at equal CPU time\n\n{about}"),
        table(lambda scene, mode: scene.ratio(mode, "path")),
        HtmlOnly(Text("The same without export and build (the CPU time of plain path tracing with no samples, by engine):")),
        HtmlOnly(table(lambda scene, mode: scene.ratio(mode, "path", with_export=False), slopes=False)),
        HtmlOnly(Text("HDR-FLIP in place of relMSE:")),
        HtmlOnly(table(lambda scene, mode: scene.ratio(mode, "path", "flip"), slopes=False)),
        Text("Speed-up at equal relMSE against Gradus PT; – where no error is reached by both:"),
        table(lambda scene, mode: scene.speed_up(mode, "path"), slopes=False),
    ]  # fmt: skip


def sample_costs(scenes: list[SceneResults]) -> list[Block]:
    made = Table(["scene", "PT, µs", "Cycles, µs", "PT / Cycles", "gradients: G-PT / PT", "denoiser, µs a pixel"])
    for scene in scenes:
        cells = [scene.sample_cost(f"{mode}@4") for mode in ("path", "cycles")]
        cells += [scene.cost_ratio("path@4", "cycles@4"), scene.cost_ratio("gradient-none@4", "path@4")]
        made.rows.append([scene.name, *map(number, cells), number(scene.denoiser_cost(), ".0f")])
    return [Text("## CPU time of a sample with four bounces"), made]


ROOM_COLUMNS = dict(zip(("PT", "G-PT", "Cycles 4.5", "Cycles 3.4"), ENGINES, strict=True))


def room() -> list[Block]:
    """The box room of three sizes: time per sample, ratios with their range over the repeats, rays, memory."""
    rows = speed.load()
    facts = {row["room"]: row for row in rows}
    costs = speed.costs(rows)
    times = Table(["triangles", *(f"{name}, µs" for name in ROOM_COLUMNS), "PT / Cycles 4.5", "PT / Cycles 3.4", "G-PT / PT", "repeats"])
    counts = Table(["triangles", "mode", "camera rays", "bounce", "shadow", "shift", "shift shadow", "peak memory, MB"])
    choices = Table(["room", "PT, CPU-s", "AUTO, CPU-s", "AUTO / PT"])
    for name in (name for name, room in ROOMS.items() if name in costs and room.turns == CHOICE):
        path, auto = (costs[name].get(turn, speed.Cost()) for turn in CHOICE)
        medians = [number(float(np.median(list(cost.total.values()))) if cost.total else None) for cost in (path, auto)]
        choices.rows.append([name, *medians, spread(auto.total_over(path), ".3f")])
    for name in (name for name, room in ROOMS.items() if name in costs and room.turns == ENGINES):
        found = {label: costs[name].get(key, speed.Cost()) for label, key in ROOM_COLUMNS.items()}
        path, triangles = found["PT"], f"{facts[name]['triangles']:,}"
        ratios = [path.over(found["Cycles 4.5"]), path.over(found["Cycles 3.4"]), found["G-PT"].over(path)]
        medians = [number(cost.median()) for cost in found.values()]
        times.rows.append([triangles, *medians, *map(spread, ratios), str(len(path.per_sample))])
        for label, cost in found.items():
            rays = [number(cost.rays.get(kind)) for kind in ("primary", "bounce", "shadow", "shift", "shift_shadow")]
            counts.rows.append([triangles, label, *rays, f"{cost.peak_memory_bytes / 1e6:.0f}"])
    if not times.rows:
        return []
    size = f"{rows[-1]['width']}×{rows[-1]['height']}"
    about = f"Diffuse box room with nine bumpy spheres, one area lamp, four bounces, {size} pixels; slope between 4 and 16 samples"
    made = [Text(f"## The room\n\n{about}; ratios by repeat: median (lowest–highest)."), times, Text("Rays per sample:"), counts]
    if choices.rows:
        made += [Text("Where gradients cannot pay: direct light alone, and the room behind glass; whole renders of 16 samples."), choices]
    return made


def agreement() -> list[Block]:
    """What agreement.py measured, if it was run."""
    file = FOLDER / "agreement.json"
    if not file.exists():
        return []
    made = Table(["scene", "blocks that agree", "ratio of means", "named difference"])
    for name, row in json.loads(file.read_text()).items():
        made.rows.append([name, f"{100 * row['share']:.1f} %", f"{row['ratio']:.4f}", row["reason"]])
    return [Text("## Agreement with Cycles (A9)\n\nBoth engines' converged images of plain path tracing, blocks of 8×8 pixels."), made]


def shortfalls(scenes: list[SceneResults]) -> list[Block]:
    """Where Cycles with its denoiser is ahead, and whether by bias or by variance."""
    made = Table(["scene", "mode", "R relMSE", "R HDR-FLIP", "spp", "seeds", "bias²", "variance"])
    for scene in scenes:
        late = behind.modes_behind(scene)
        for mode in (*late, behind.THEIRS) if late else ():
            point = scene.points[mode][-1]
            ratios = [scene.ratio(mode, behind.THEIRS, measure) for measure in ("relmse", "flip")]
            parts = point.bias_and_variance() or (None, None)
            counts = [str(point.samples), str(len(point.rows))]
            made.rows.append([scene.name, MODES[mode].label, *map(number, ratios), *counts, *(number(part, ".4f") for part in parts)])
    if not made.rows:
        return []
    about = (
        "R: error over that of Cycles with its denoiser at equal CPU time. Bias² and variance of relMSE at the most samples that were run."
    )
    return [Text(f"## Where Cycles with its denoiser is ahead\n\n{about}"), made]


def details(scene: SceneResults) -> list[Block]:
    made: list[Block] = [Text(f"## {scene.name}\n\n{conditions(scene)}")]
    made.append(Figure(figures.error_figure(scene), "Error against CPU time; in brackets the slope of relMSE over the last decade."))
    if bias := figures.bias_figure(scene):
        made.append(HtmlOnly(Figure(bias, "Variance and bias² of relMSE, from the mean over the seeds.")))
    if slider := pictures.slider(scene.name):
        made += [slider, *filter(None, [pictures.errors_of_pictures(scene.name)])]
    made += [errors(scene, short=True), HtmlOnly(errors(scene, short=False)), HtmlOnly(work(scene))]
    return made


def errors(scene: SceneResults, short: bool) -> Table:
    """The main measures, or the others."""
    first = ["mode", "spp", "seeds"]
    if short:
        made = Table([*first, "CPU-s", "wall s", "relMSE", "relMSE-t", "SMAPE", "HDR-FLIP"])
    else:
        made = Table([*first, "CPU-s without export", "log MSE", "SSIM", "bias²", "variance"])
    for mode in scene.modes():
        fixed = scene.fixed_cost(MODES[mode].engine)
        for point in scene.points[mode]:
            cells = main_measures(point) if short else other_measures(point, fixed)
            made.rows.append([MODES[mode].label, str(point.samples), str(len(point.rows)), *cells])
    return made


def main_measures(point: Point) -> list[str]:
    cpu, wall, trimmed, smape, flip = (point.median(m) for m in ("cpu", "wall", "relmse_trimmed", "smape", "flip"))
    return [
        number(cpu),
        number(wall),
        spread(point.range("relmse"), ".4f"),
        number(trimmed, ".4f"),
        number(smape, ".4f"),
        number(flip, ".4f"),
    ]


def other_measures(point: Point, fixed: float) -> list[str]:
    bias, variance = point.bias_and_variance() or (None, None)
    cells = [number((point.median("cpu") or 0.0) - fixed), number(point.median("log_mse"), ".3g"), number(point.median("ssim"), ".4f")]
    return [*cells, number(bias, ".2g"), number(variance, ".3g")]


STAGES = ("export", "build", "sample", "reconstruct", "upload")
RAYS = ("primary", "bounce", "shadow", "shift", "shift_shadow")


def work(scene: SceneResults) -> Table:
    """Where the CPU time goes, rays per pixel and sample, bytes: of the first seed."""
    made = Table(
        ["mode", "spp", *(f"{s}, CPU-s" for s in STAGES), *(f"{r.replace('_', ' ')} rays" for r in RAYS), "frame, B/pixel", "peak, MB"]
    )
    for mode in scene.modes():
        for point in scene.points[mode]:
            stages, rays, frame, peak = (point.first(n) for n in ("cpu_seconds", "rays", "frame_memory_bytes", "peak_memory_bytes"))
            if peak is None:
                continue
            pixels = point.rows[0]["width"] * point.rows[0]["height"]
            cells = [number((stages or {}).get(stage), ".3f") for stage in STAGES]
            cells += [number(rays[kind] / pixels / point.samples if rays else None) for kind in RAYS]
            made.rows.append(
                [MODES[mode].label, str(point.samples), *cells, number(frame / pixels if frame else None, ".0f"), f"{peak / 1e6:.0f}"]
            )
    return made


def conditions(scene: SceneResults) -> str:
    """Pixels, reference and version of a scene's runs."""
    sizes = sorted({f"{row['width']}×{row['height']}" for row in scene.rows})
    references = sorted({row["reference_samples"] for row in scene.rows if "reference_samples" in row})
    versions = sorted({row["version"] for row in scene.rows})
    machines = sorted({row["machine"] for row in scene.rows})
    return (
        f"{', '.join(sizes)} pixels; references of {', '.join(map(str, references))} samples; version {', '.join(versions)}; "
        f"{', '.join(machines)}."
    )


def blocks() -> list[Block]:
    scenes = results.load()
    made: list[Block] = [Text((FOLDER / "preface.md").read_text()), Text("## Targets"), targets.table(scenes)]
    made += [*equal_time(scenes), *shortfalls(scenes), *animation_report.blocks(), *motion_report.blocks()]
    made += [*room(), *sample_costs(scenes), *agreement()]
    for scene in scenes:
        made += details(scene)
    return made


def main() -> None:
    maps.legend()
    content = blocks()
    (FOLDER / "README.md").write_text(to_markdown(content))
    page = to_html(TITLE, content, (HERE / "report.css").read_text(), (HERE / "report.js").read_text())
    (FOLDER / "report.html").write_text(page)
    print(FOLDER / "report.html")


if __name__ == "__main__":
    main()
