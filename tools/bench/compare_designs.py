"""Compares Gradus' reconstructions with published ones, reimplemented in designs/, on the same stored films.

    compare_designs.py [--scenes a,b] [--width 160] [--samples 16] [--reference 1024]

Every result is appended to out/bench/results/designs.jsonl. The table in out/bench/designs.md has the last result of
each scene and design with the settings of the very last one. References are those of the stills (references.py).
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import reconstruction_time
import records
from designs import chapter8, nfor, poisson
from designs.films import Film, film_of, mean_of, planes_of
from designs.poisson import Reweighting
from metrics import rel_mse
from paths import OUT, TOOL
from records import Row
from references import reference
from renderers import RefusedError, Renderers
from scenes import Scene, select
from version import conditions, version_of_build

RESULTS = records.file_of("designs")
DOCUMENT = OUT / "designs.md"
SEED = 1

Reconstruct = Callable[[Film], np.ndarray]
PRODUCT = {"none": "noisy image", "l1": "Gradus L1", "regularized": "**Gradus REGULARIZED**"}


def _l1(reweighting: Reweighting) -> Reconstruct:
    return lambda film: poisson.l1(mean_of(film), chapter8.ALPHA_L1, reweighting)


def _chapter8(scales: tuple[chapter8.Scale, ...], reweighting: Reweighting) -> Reconstruct:
    return lambda film: chapter8.reconstruct(film, scales, reweighting)


def _nfor_with_l1(film: Film) -> np.ndarray:
    a, b = (poisson.l1(half, chapter8.ALPHA_L1, Reweighting.L1) for half in film)
    return nfor.reconstruct(film, (a, b))


PUBLISHED: dict[str, tuple[str, Reconstruct]] = {
    "l1-thesis": ("L1 of the thesis, α 0.2", _l1(Reweighting.L1)),
    "l1-thesis-printed": ("the same, W as printed", _l1(Reweighting.PRINTED)),
    "chapter8": ("chapter 8, α and β as printed", _chapter8(chapter8.PRINTED, Reweighting.L1)),
    "chapter8-printed": ("the same, W as printed", _chapter8(chapter8.PRINTED, Reweighting.PRINTED)),
    "chapter8-tuned": ("chapter 8, tuned", _chapter8(chapter8.TUNED, Reweighting.L1)),
    "chapter8-tuned-printed": ("the same, W as printed", _chapter8(chapter8.TUNED, Reweighting.PRINTED)),
    "nfor": ("NFOR", nfor.reconstruct),
    "nfor-l1": ("NFOR, L1 of the other half as a feature", _nfor_with_l1),
}
LABELS = PRODUCT | {name: label for name, (label, _) in PUBLISHED.items()}


def by_product(path: Path, mode: str) -> np.ndarray:
    """Returns the reconstruction of a stored film by the tool."""
    target = path.with_name(f"{mode}.exr")
    subprocess.run(
        [TOOL, "reconstruct", path, "-o", target, "--reconstruction", mode], check=True, stdout=subprocess.DEVNULL
    )
    planes = planes_of(target)
    return np.stack([planes[channel] for channel in "RGB"], axis=2)


def images_of(path: Path) -> Iterator[tuple[str, np.ndarray, float | None]]:
    """Yields design, image and CPU seconds. The product's seconds come from reconstruction_time.py, at full-HD size."""
    for mode in PRODUCT:
        yield mode, by_product(path, mode), None
    film = film_of(planes_of(path))
    for name, (_, reconstruct) in PUBLISHED.items():
        start = time.process_time()
        image = reconstruct(film)
        yield name, image, time.process_time() - start


def compare(scene: Scene, arguments: argparse.Namespace) -> None:
    size = arguments.width, arguments.width * 9 // 16
    renderers = Renderers(scene, size)
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "film.exr"
            renderers.store_film("gradient-regularized", arguments.samples, SEED, path)
            mean, variance = reference(renderers, scene, "path", size, arguments.reference, version_of_build())
            for design, image, seconds in images_of(path):
                row = {"scene": scene.name, "design": design, "relmse": rel_mse(image, mean, variance), "cpu": seconds}
                row |= {
                    "width": size[0],
                    "height": size[1],
                    "samples": arguments.samples,
                    "reference": arguments.reference,
                }
                records.append(row | conditions(version_of_build()), RESULTS)
                print(f"{scene.name:18} {design:15} relMSE {row['relmse']:.5f}", flush=True)
    finally:
        renderers.close()


def newest(rows: list[Row]) -> dict[str, dict[str, Row]]:
    """Returns the last row of each scene and design with the settings of the very last one, of scenes with both L1s."""
    found: dict[str, dict[str, Row]] = {}
    for row in rows:
        if any(row[name] != rows[-1][name] for name in ("width", "height", "samples", "reference")):
            continue
        found.setdefault(row["scene"], {})[row["design"]] = row
    return {scene: designs for scene, designs in found.items() if {"l1", "l1-thesis"} <= designs.keys()}


def seconds_per_megapixel(design: str, rows: list[Row]) -> float | None:
    """Returns the median CPU seconds of a design."""
    if design in PUBLISHED:
        return statistics.median(row["cpu"] / (row["width"] * row["height"]) * 1e6 for row in rows)
    times = [row["reconstruct"] for row in reconstruction_time.newest() if row["mode"] == f"gradient-{design}"]
    width, height = reconstruction_time.SIZE
    return statistics.median(times) / (width * height) * 1e6 if times else None


def table(rows: list[Row]) -> str:
    by_scene = newest(rows)
    heads = ["design", "over L1", "over the thesis' L1", "geometric mean", *by_scene, "CPU-s per megapixel"]
    lines = [_line(heads), _line(["---", *["---:"] * (len(heads) - 1)])]
    for design, label in LABELS.items():
        rows_of = {scene: designs[design] for scene, designs in by_scene.items() if design in designs}
        if not rows_of:
            continue
        seconds = seconds_per_megapixel(design, list(rows_of.values()))
        cells = [f"{_mean_ratio(by_scene, design, base):.2f}" for base in ("l1", "l1-thesis")]
        cells.append(f"{statistics.geometric_mean(row['relmse'] for row in rows_of.values()):.4f}")
        cells += [f"{rows_of[scene]['relmse']:.4f}" if scene in rows_of else "–" for scene in by_scene]
        lines.append(_line([label, *cells, "–" if seconds is None else f"{seconds:.3g}"]))
    return "\n".join(lines) + "\n"


def _mean_ratio(by_scene: dict[str, dict[str, Row]], design: str, base: str) -> float:
    return statistics.geometric_mean(
        designs[design]["relmse"] / designs[base]["relmse"] for designs in by_scene.values() if design in designs
    )


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def write_document() -> None:
    rows = records.read(RESULTS)
    row = rows[-1]
    size = f"{row['width']}×{row['height']}"
    samples = f"{row['samples']} samples with four offset paths, one seed; references of {row['reference']} samples"
    about = f"relMSE, {size}, {samples}."
    DOCUMENT.write_text(f"# REGULARIZED against published reconstructions\n\n{about}\n\n{table(rows)}")
    print(DOCUMENT)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--width", type=int, default=160)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--reference", type=int, default=1024)
    arguments = parser.parse_args()
    for scene in select(arguments.scenes):
        try:
            compare(scene, arguments)
        except (RuntimeError, RefusedError, subprocess.CalledProcessError) as error:
            print(f"FAILED {scene.name}: {error}", flush=True)
    if newest(records.read(RESULTS)):
        write_document()


if __name__ == "__main__":
    main()
