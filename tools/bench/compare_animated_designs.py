"""Compares Gradus' animations with published reconstructions, reimplemented in designs/, on the same stored frames.

    compare_animated_designs.py --name KITCHEN --stores A,B --references A,B --frames 12-14
                                [--crop X,Y,WIDTH,HEIGHT] [--designs none,svgf]

Stores are folders of a frame store (the add-on's Frame Store) with the same frames, sampled by plain paths with
different seeds: at least two. References are two folders of converged pictures, 0012.exr and so on, of other seeds.
Frames of the stores before and after those that are compared serve as history and as neighbors. With a crop, all
designs are measured in that part of the picture, and SVGF and NFOR, which takes minutes for a frame, do little more.

Noise is the variance between seeds and bias the rest of the squared error. Both are free of the references' noise,
because errors against one of them are multiplied by those against the other one. Times are not compared: the
reimplementations are NumPy.

Every result is appended to out/bench/results/animated_designs.jsonl. The table in out/bench/animated_designs.md has the
last result of each name and design.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import records
from designs import animations, nfor, svgf
from designs.animations import Frame
from designs.films import film_of, mean_of, planes_of
from paths import OUT, TOOL
from records import Row
from temporal_metrics import relative_to, trimmed_mean
from version import conditions, version_of_build

RESULTS = records.file_of("animated_designs")
DOCUMENT = OUT / "animated_designs.md"
REACH = 2  # frames before and after a picture for NFOR
# Pixels around a part that a design reads, too.
NFOR_MARGIN = nfor.RADIUS + 3
SVGF_MARGIN = 2 ** (svgf.LEVELS + 1)

LABELS = {
    "none": "noisy image",
    "oidn": "Open Image Denoise, frame by frame",
    "svgf": "SVGF (Schied et al. 2017)",
    "nfor": "NFOR, frame by frame",
    "nfor-frames": "NFOR over five frames (Bitterli et al. 2016)",
    "regularized-frame": "Gradus REGULARIZED, frame by frame",
    "regularized": "**Gradus REGULARIZED over frames**",
    "delivered": "**Gradus REGULARIZED over frames, with its denoiser**",
}
MEASURES = ("flicker", "flicker_trimmed", "flicker_noise", "flicker_bias", "relmse", "relmse_trimmed", "noise", "bias")


@dataclass(frozen=True)
class Part:
    """The part of the pictures that is measured."""

    rows: slice
    columns: slice

    def of(self, images: np.ndarray) -> np.ndarray:
        """Returns the part of images (..., height, width, 3)."""
        return images[..., self.rows, self.columns, :]

    def widened(self, margin: int, height: int, width: int) -> Part:
        """Returns the part with a margin, inside of pictures of a size."""
        rows = slice(max(self.rows.start - margin, 0), min(self.rows.stop + margin, height))
        return Part(rows, slice(max(self.columns.start - margin, 0), min(self.columns.stop + margin, width)))

    def inside(self, outer: Part) -> Part:
        """Returns this part in the rows and columns of an outer one."""

        def shifted(side: slice, origin: int) -> slice:
            return slice(side.start - origin, side.stop - origin)

        return Part(shifted(self.rows, outer.rows.start), shifted(self.columns, outer.columns.start))


def pictures_of(
    store: Path, numbers: Sequence[int], part: Part, designs: Sequence[str]
) -> Iterator[tuple[str, np.ndarray]]:
    """Yields each design and its pictures (frames, height, width, 3) of a part."""
    for design in designs:
        yield design, BY[design](store, numbers, part)


def without_reconstruction(store: Path, numbers: Sequence[int], part: Part) -> np.ndarray:
    films = (film_of(planes_of(animations.file_of(store, number, "fresh"))) for number in numbers)
    return part.of(np.stack([mean_of(film).image for film in films]))


def by_svgf(store: Path, numbers: Sequence[int], part: Part) -> np.ndarray:
    stored = [number for number in animations.frame_numbers(store) if number <= numbers[-1]]
    frames, inner = frames_around(store, stored, part, SVGF_MARGIN)
    pictures = svgf.reconstruct(frames)
    return inner.of(np.stack([picture for number, picture in zip(stored, pictures, strict=True) if number in numbers]))


def by_nfor(store: Path, numbers: Sequence[int], part: Part, reach: int) -> np.ndarray:
    around = range(numbers[0] - reach, numbers[-1] + reach + 1)
    stored = [number for number in animations.frame_numbers(store) if number in around]
    frames, inner = frames_around(store, stored, part, NFOR_MARGIN)
    chosen = [stored.index(number) for number in numbers]
    return inner.of(np.stack(list(nfor.reconstruct_animation(frames, chosen, reach))))


def frames_around(store: Path, numbers: Sequence[int], part: Part, margin: int) -> tuple[list[Frame], Part]:
    """Returns a part of frames with a margin, and where the part lies in it."""
    height, width = planes_of(animations.file_of(store, numbers[0], "fresh"))["A.R"].shape
    wide = part.widened(margin, height, width)
    return animations.read_frames(store, numbers, (wide.rows, wide.columns)), part.inside(wide)


def by_product(store: Path, numbers: Sequence[int], part: Part, denoised: bool = False) -> np.ndarray:
    """Returns pictures of the tool over frames."""
    with tempfile.TemporaryDirectory() as folder:
        frames = ("--frames", f"{numbers[0]}-{numbers[-1]}")
        _reconstruct(store, Path(folder), "regularized", *frames, *denoiser(denoised))
        return part.of(images_of(Path(folder), numbers))


def frame_by_frame(
    store: Path, numbers: Sequence[int], part: Part, reconstruction: str, *more: str | Path
) -> np.ndarray:
    """Returns pictures of the tool, each from its frame alone."""
    with tempfile.TemporaryDirectory() as folder:
        for number in numbers:
            target = Path(folder) / f"{number:04d}.exr"
            _reconstruct(animations.file_of(store, number, "fresh"), target, reconstruction, *more)
        return part.of(images_of(Path(folder), numbers))


def by_regularized(store: Path, numbers: Sequence[int], part: Part) -> np.ndarray:
    return frame_by_frame(store, numbers, part, "regularized", *denoiser(False))


def by_oidn(store: Path, numbers: Sequence[int], part: Part) -> np.ndarray:
    return frame_by_frame(store, numbers, part, "none", *denoiser(True))


def denoiser(is_used: bool) -> tuple[str | Path, ...]:
    """Returns options of the tool."""
    return ("--denoiser", "oidn", "--denoiser-path", bundled_libraries()) if is_used else ("--denoiser", "none")


def _reconstruct(source: Path, target: Path, reconstruction: str, *more: str | Path) -> None:
    command = [TOOL, "reconstruct", source, "-o", target, "--reconstruction", reconstruction, *more]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def bundled_libraries() -> Path:
    """Returns the folder of the libraries that come with the Python module bpy."""
    found = importlib.util.find_spec("bpy")
    if found is None or found.origin is None:
        raise RuntimeError("Open Image Denoise comes with the Python module bpy, which is not installed")
    return Path(found.origin).parent / "lib"


def images_of(folder: Path, numbers: Sequence[int]) -> np.ndarray:
    def image(number: int) -> np.ndarray:
        planes = planes_of(folder / f"{number:04d}.exr")
        return np.stack([planes[channel] for channel in "RGB"], axis=2)

    return np.stack([image(number) for number in numbers])


BY: dict[str, Callable[[Path, Sequence[int], Part], np.ndarray]] = {
    "none": without_reconstruction,
    "oidn": by_oidn,
    "svgf": by_svgf,
    "nfor": partial(by_nfor, reach=0),
    "nfor-frames": partial(by_nfor, reach=REACH),
    "regularized-frame": by_regularized,
    "regularized": by_product,
    "delivered": partial(by_product, denoised=True),
}


def measured(pictures: np.ndarray, references: np.ndarray) -> dict[str, float]:
    """Returns the measures of pictures (seeds, frames, height, width, 3) against two references (2, frames, ...)."""
    scale = relative_to(references.mean(axis=0))
    noise, error = noise_and_error(pictures, references)
    noise, error = noise / scale, error / scale
    change_noise, change = noise_and_error(np.diff(pictures, axis=1), np.diff(references, axis=1))
    change_noise, change = change_noise / scale[1:], change / scale[1:]
    return {
        "flicker": float(change.mean()),
        "flicker_trimmed": trimmed_mean(change),
        "flicker_noise": float(change_noise.mean()),
        "flicker_bias": float((change - change_noise).mean()),
        "relmse": float(error.mean()),
        "relmse_trimmed": trimmed_mean(error),
        "noise": float(noise.mean()),
        "bias": float((error - noise).mean()),
    }


def noise_and_error(images: np.ndarray, references: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the variance between seeds and the squared error, without the noise of references, for each pixel."""
    errors = (images - references[0]) * (images - references[1])
    return images.var(axis=0, ddof=1).mean(axis=-1), errors.mean(axis=0).mean(axis=-1)


def compare(arguments: argparse.Namespace) -> None:
    first, last = (int(number) for number in arguments.frames.split("-"))
    numbers = range(first, last + 1)
    references = np.stack([images_of(Path(folder), numbers) for folder in arguments.references.split(",")])
    height, width = references.shape[2:4]
    x, y, w, h = (int(n) for n in arguments.crop.split(",")) if arguments.crop else (0, 0, width, height)
    part = Part(slice(y, y + h), slice(x, x + w))
    designs = arguments.designs.split(",") if arguments.designs else list(LABELS)
    stores = [Path(folder) for folder in arguments.stores.split(",")]
    for results in zip(*(pictures_of(store, numbers, part, designs) for store in stores), strict=True):
        design, pictures = results[0][0], np.stack([images for _, images in results])
        row = {"name": arguments.name, "design": design, "seeds": len(stores), "frames": [first, last]}
        row |= {"width": w, "height": h} | measured(pictures, part.of(references))
        records.append(row | conditions(version_of_build()), RESULTS)
        print(f"{arguments.name:12} {design:18} F {row['flicker']:.5f} relMSE {row['relmse']:.5f}", flush=True)


def table(rows: list[Row]) -> str:
    """Returns the last result of each name and design."""
    newest = {(row["name"], row["design"]): row for row in rows}
    heads = ["animation", "design", "F", "F trimmed", "F noise", "F bias", "relMSE", "relMSE trimmed", "noise", "bias"]
    lines = [heads, ["---", "---", *["---:"] * len(MEASURES)]]
    for name in dict.fromkeys(name for name, _ in newest):
        for design, label in LABELS.items():
            if row := newest.get((name, design)):
                lines.append([name, label, *(f"{row[measure]:.5f}" for measure in MEASURES)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def write_document() -> None:
    about = "Equal samples; noise and bias are parts of F and of relMSE."
    DOCUMENT.write_text(f"# Animations against published reconstructions\n\n{about}\n\n{table(records.read(RESULTS))}")
    print(DOCUMENT)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for option in ("--name", "--stores", "--references", "--frames"):
        parser.add_argument(option, required=True)
    for option in ("--crop", "--designs"):
        parser.add_argument(option, default="")
    compare(parser.parse_args())
    write_document()


if __name__ == "__main__":
    main()
