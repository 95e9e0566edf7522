"""Writes out/bench/report.md and report.html, with their figures, from the results in out/bench alone.

Parts that were not run are left out.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable

import agreement
import animation_report
import behind
import figures
import host
import maps
import motion_report
import numpy as np
import path_tracing
import pictures
import profiles
import records
import results
import speed
import targets
from document import Block, Figure, HtmlOnly, Table, Text, number, spread, to_html, to_markdown
from modes import MODES, WITHOUT_ERRORS
from paths import HERE, OUT
from results import Point, SceneResults
from rooms import ENGINES, PILOT, ROOMS

TITLE = "Gradus: error against CPU time"
OTHERS = [mode for mode in MODES if mode not in ("path", *WITHOUT_ERRORS)]
SLOPES = {"PT": "path", "L2": "gradient-l2", "REGULARIZED": "path-regularized"}
PREFACE = f"""# {TITLE}

Made by `make bench-report` from the results in `out/bench/results`. `docs/benchmark/README.md` defines the measures
and conditions. R is relMSE of a mode over that of Gradus PT at equal CPU time. relMSE-t leaves out the worst 0.1 % of
the pixels, so that a wide gap to relMSE shows fireflies. bias² and variance of relMSE are computed from the mean of
the errors and the error of the mean over all seeds."""


def equal_time(scenes: list[SceneResults]) -> list[Block]:
    """Tables of error ratios at equal CPU time, with export and without, and of time ratios at equal error."""
    columns = ["scene", *(MODES[mode].label.removeprefix("Gradus ") for mode in OTHERS)]

    def table(value: Callable[[SceneResults, str], float | None], slopes: bool = True) -> Table:
        made = Table([*columns, *(f"slope {name}" for name in SLOPES if slopes)])
        for scene in scenes:
            cells = [number(value(scene, mode)) for mode in OTHERS]
            cells += [number(scene.slope(mode)) for mode in SLOPES.values() if slopes]
            made.rows.append([scene.name, *cells])
        return made

    without_export = "The same without export and build, the CPU time of plain path tracing with no samples:"
    return [
        Text("## Error at equal CPU time\n\nR, export and build included. Below 1 is better than plain path tracing."),
        table(lambda scene, mode: scene.ratio(mode, "path")),
        HtmlOnly(Text(without_export)),
        HtmlOnly(table(lambda scene, mode: scene.ratio(mode, "path", with_export=False), slopes=False)),
        HtmlOnly(Text("HDR-FLIP instead of relMSE:")),
        HtmlOnly(table(lambda scene, mode: scene.ratio(mode, "path", "flip"), slopes=False)),
        Text("Speed-up at equal relMSE over Gradus PT; a dash stands where the curves share no error:"),
        table(lambda scene, mode: scene.speed_up(mode, "path"), slopes=False),
    ]


def sample_costs(scenes: list[SceneResults]) -> list[Block]:
    """Table of the CPU time of a sample by scene, for scenes that were run with four bounces."""
    made = Table(["scene", "PT, µs", "Cycles, µs", "PT / Cycles", "gradients: G-PT / PT", "denoiser, µs per pixel"])
    for scene in scenes:
        cells = [scene.sample_cost(f"{mode}@4") for mode in ("path", "cycles")]
        cells += [scene.cost_ratio("path@4", "cycles@4"), scene.cost_ratio("gradient-none@4", "path@4")]
        if any(cell is not None for cell in cells):
            made.rows.append([scene.name, *map(number, cells), number(scene.denoiser_cost(), ".0f")])
    return [Text("## CPU time of a sample with four bounces"), made] if made.rows else []


def plain_paths() -> list[Block]:
    """Table of the variance and the time of a sample in scenes, over those of Cycles."""
    rows = path_tracing.newest()
    if not rows:
        return []
    heads = ["scene", "time", "variance", "variance-t", "time × variance-t", "guided", "both guided", "PT, µs"]
    made = Table(heads)
    for row in rows:
        plain = path_tracing.ratios(row, path_tracing.OURS, "cycles") or {}
        cells = [number(plain.get(name)) for name in (*path_tracing.MEASURES, "work")]
        for peer in ("cycles", "cycles-guided"):
            cells.append(number((path_tracing.ratios(row, path_tracing.GUIDED, peer) or {}).get("work")))
        microseconds = 1e6 * path_tracing.median_of(row, path_tracing.OURS, "seconds")
        made.rows.append([row["scene"], *cells, number(microseconds)])
    last = rows[-1]
    about = f"{last['samples']} samples, {last['width']} pixels wide, {last['seeds']} seeds; "
    about += f"commit {last['version']}, Blender {last['blender']}, {last['machine']}"
    meaning = "Gradus over Cycles for each sample; variance-t leaves out the worst 0.1 % of the pixels. "
    meaning += "'Guided' is time × variance-t of Gradus with path guiding over Cycles without and with it."
    return [Text(f"## Plain paths: variance and time of a sample\n\n{meaning} {about}."), made]


def ray_shares() -> list[Block]:
    """Table of the share of ray tracing in the time of plain paths, with the flame graphs."""
    rows = profiles.newest()
    if not rows:
        return []
    made = Table(["scene", "ray tracing", "flame graph"])
    for row in rows:
        picture = f"{profiles.PICTURES}/{row['scene']}.svg"
        made.rows.append([row["scene"], f"{100 * row['rays']:.0f} %", picture])
    last = rows[-1]
    about = f"{last['width']} pixels wide; commit {last['version']}, {last['machine']}"
    return [Text(f"## Ray tracing in the time of plain paths\n\nShare of the stacks inside Embree. {about}."), made]


def rooms() -> list[Block]:
    """Tables of the rooms: time per sample, its ratios with their range over the repeats, rays and memory."""
    rows = speed.load()
    facts = {row["room"]: row for row in rows}
    costs = speed.costs(rows)
    times = Table(
        ["triangles", *(f"{MODES[mode].label}, µs" for mode in ENGINES), "PT / Cycles", "G-PT / PT", "repeats"]
    )
    counts = Table(["triangles", "mode", "camera rays", "bounce", "shadow", "shift", "shift shadow", "peak memory, MB"])
    for name in (name for name, room in ROOMS.items() if name in costs and room.modes == ENGINES):
        found = {mode: costs[name].get(mode, speed.Cost()) for mode in ENGINES}
        path, gradient, cycles = found.values()
        triangles = f"{facts[name]['triangles']:,}"
        medians = [number(cost.median()) for cost in found.values()]
        ratios = [spread(path.over(cycles)), spread(gradient.over(path))]
        times.rows.append([triangles, *medians, *ratios, str(len(path.per_sample))])
        for mode, cost in found.items():
            rays = [number(cost.rays.get(kind)) for kind in RAYS]
            counts.rows.append([triangles, MODES[mode].label, *rays, f"{cost.peak_memory_bytes / 1e6:.0f}"])
    if not times.rows:
        return []
    last = rows[-1]
    size, host = f"{last['width']}×{last['height']}", f"commit {last['version']}, Blender {last['blender']}"
    about = f"Diffuse box room with nine bumpy spheres, one area light, four bounces, {size} pixels; {host}"
    made = [
        Text(f"## Rooms\n\n{about}; slope between 4 and 16 samples; ratios by repeat."),
        times,
        Text("Rays per sample:"),
        counts,
    ]
    return made + pilot(costs)


def pilot(costs: dict[str, dict[str, speed.Cost]]) -> list[Block]:
    """Table of what the pilot costs where gradients cannot pay."""
    made = Table(["room", "PT, CPU-s", "AUTO + L2, CPU-s", "AUTO + L2 / PT"])
    for name in (name for name, room in ROOMS.items() if name in costs and room.modes == PILOT):
        path, auto = (costs[name].get(mode, speed.Cost()) for mode in PILOT)
        medians = [number(float(np.median(list(cost.total.values()))) if cost.total else None) for cost in (path, auto)]
        made.rows.append([name, *medians, spread(auto.total_over(path), ".3f")])
    text = "Rooms where gradients cannot pay: direct light alone, and a room behind glass; whole renders of 16 samples."
    return [Text(text), made] if made.rows else []


def agreements() -> list[Block]:
    """Table of the newest comparison of each scene's converged images."""
    newest = {row["name"]: row for row in records.read(agreement.RESULTS)}
    made = Table(["scene", "blocks that agree", "ratio of means", "known reason", "Blender"])
    for name, row in newest.items():
        share, ratio = f"{100 * row['share']:.1f} %", f"{row['ratio']:.4f}"
        made.rows.append([name, share, ratio, row["reason"], row["blender"]])
    text = (
        "## Agreement of converged images (A9)\n\nPlain path tracing against Cycles or Mitsuba, blocks of 8×8 pixels."
    )
    return [Text(text), made] if made.rows else []


def export_and_upload() -> list[Block]:
    """Table of the newest times of each Blender."""
    made = Table(["Blender", "export, s", "upload, ms", "second upload, ms"])
    for row in host.newest():
        cells = [median_of(row["export"], 1.0), median_of(row["upload"], 1e-3), median_of(row["refresh"], 1e-3)]
        made.rows.append([row["host"], *cells])
    about = "Wall time, median (lowest–highest): export of a million triangles, upload of one 1920×1080 RGBA pass."
    return [Text(f"## Export and upload\n\n{about}"), made] if made.rows else []


def median_of(seconds: list[float], unit: float) -> str:
    found = [value / unit for value in seconds]
    return spread((statistics.median(found), min(found), max(found)), ".3g")


def shortfalls(scenes: list[SceneResults]) -> list[Block]:
    """Table of the scenes in which Cycles with its denoiser has less error, with bias and variance."""
    made = Table(["scene", "mode", "relMSE ratio", "HDR-FLIP ratio", "spp", "seeds", "bias²", "variance"])
    for scene in scenes:
        late = behind.modes_behind(scene)
        for mode in (*late, behind.THEIRS) if late else ():
            point = scene.points[mode][-1]
            ratios = [scene.ratio(mode, behind.THEIRS, measure) for measure in ("relmse", "flip")]
            parts = point.bias_and_variance() or (None, None)
            counts = [str(point.samples), str(len(point.rows))]
            cells = [*map(number, ratios), *counts, *(number(part, ".4f") for part in parts)]
            made.rows.append([scene.name, MODES[mode].label, *cells])
    about = "Ratios to Cycles + denoiser at equal CPU time; bias² and variance of relMSE at the highest sample count."
    return [Text(f"## Where Cycles with its denoiser is ahead\n\n{about}"), made] if made.rows else []


def details(scene: SceneResults) -> list[Block]:
    """All that is known of a scene."""
    made: list[Block] = [Text(f"## {scene.name}\n\n{conditions(scene)}")]
    made.append(
        Figure(
            figures.error_figure(scene), "Error against CPU time; the slope of relMSE over the last decade in brackets."
        )
    )
    if bias := figures.bias_figure(scene):
        made.append(HtmlOnly(Figure(bias, "Variance and bias² of relMSE, from the mean over the seeds.")))
    if slider := pictures.slider(scene.name):
        made += [slider, *filter(None, [pictures.errors_of_pictures(scene.name)])]
    return [*made, main_errors(scene), HtmlOnly(other_errors(scene)), HtmlOnly(work(scene))]


def main_errors(scene: SceneResults) -> Table:
    made = Table(["mode", "spp", "seeds", "CPU-s", "wall s", "relMSE", "relMSE-t", "SMAPE", "HDR-FLIP"])
    for mode, point in points_of(scene):
        cells = [number(point.median("cpu")), number(point.median("wall")), spread(point.range("relmse"), ".4f")]
        cells += [number(point.median(measure), ".4f") for measure in ("relmse_trimmed", "smape", "flip")]
        made.rows.append([MODES[mode].label, str(point.samples), str(len(point.rows)), *cells])
    return made


def other_errors(scene: SceneResults) -> Table:
    made = Table(["mode", "spp", "seeds", "CPU-s without export", "log MSE", "SSIM", "bias²", "variance"])
    for mode, point in points_of(scene):
        bias, variance = point.bias_and_variance() or (None, None)
        cells = [number((point.median("cpu") or 0.0) - scene.fixed_cost(MODES[mode].engine))]
        cells += [number(point.median("log_mse"), ".3g"), number(point.median("ssim"), ".4f")]
        cells += [number(bias, ".2g"), number(variance, ".3g")]
        made.rows.append([MODES[mode].label, str(point.samples), str(len(point.rows)), *cells])
    return made


def points_of(scene: SceneResults) -> list[tuple[str, Point]]:
    return [(mode, point) for mode in scene.modes() for point in scene.points[mode]]


STAGES = ("export", "build", "sample", "reconstruct", "upload")
RAYS = ("primary", "bounce", "shadow", "shift", "shift_shadow")


def work(scene: SceneResults) -> Table:
    """Table of CPU seconds by stage, rays per pixel and sample, and memory, of the first seed."""
    columns = [*(f"{stage}, CPU-s" for stage in STAGES), *(f"{kind.replace('_', ' ')} rays" for kind in RAYS)]
    made = Table(["mode", "spp", *columns, "film, B/pixel", "peak, MB"])
    for mode, point in points_of(scene):
        stages, rays, film, peak = (
            point.first(n) for n in ("cpu_seconds", "rays", "film_memory_bytes", "peak_memory_bytes")
        )
        if peak is None:
            continue
        pixels = point.rows[0]["width"] * point.rows[0]["height"]
        cells = [number((stages or {}).get(stage), ".3f") for stage in STAGES]
        cells += [number(rays[kind] / pixels / point.samples if rays else None) for kind in RAYS]
        cells += [number(film / pixels if film else None, ".0f"), f"{peak / 1e6:.0f}"]
        made.rows.append([MODES[mode].label, str(point.samples), *cells])
    return made


def conditions(scene: SceneResults) -> str:
    """Returns size, references, commit, Blender and machine of a scene's runs."""
    sizes = sorted({f"{row['width']}×{row['height']}" for row in scene.rows})
    references = sorted({row["reference_samples"] for row in scene.rows if "reference_samples" in row})
    commits, blenders, machines = (
        sorted({row[name] for row in scene.rows}) for name in ("version", "blender", "machine")
    )
    return (
        f"{', '.join(sizes)} pixels; references of {', '.join(map(str, references))} samples; "
        f"commit {', '.join(commits)}; Blender {', '.join(blenders)}; {', '.join(machines)}."
    )


def overview(scenes: list[SceneResults]) -> list[Block]:
    """The two figures of docs/benchmark/README.md."""
    files = {
        figures.summary_figure(scenes): "relMSE against CPU time in a few scenes",
        figures.ratio_figure(scenes): "relMSE over that of Cycles with its denoiser at equal CPU time",
    }
    return [Figure(file, caption) for file, caption in files.items() if file]


def blocks() -> list[Block]:
    scenes = results.load()
    made: list[Block] = [Text(PREFACE), *overview(scenes), Text("## Targets"), targets.table(scenes)]
    made += [*equal_time(scenes), *shortfalls(scenes)] if scenes else []
    made += [*animation_report.blocks(), *motion_report.blocks()]
    made += [*plain_paths(), *ray_shares(), *rooms(), *sample_costs(scenes), *agreements(), *export_and_upload()]
    for scene in scenes:
        made += details(scene)
    return made


def main() -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    maps.legend()
    content = blocks()
    (OUT / "report.md").write_text(to_markdown(content))
    page = to_html(TITLE, content, (HERE / "report.css").read_text(), (HERE / "report.js").read_text())
    (OUT / "report.html").write_text(page)
    print(OUT / "report.html")


if __name__ == "__main__":
    main()
