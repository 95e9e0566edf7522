"""Strips of the project's own animations: a crop of all frames side by side, and one row of pixels over time.

In a strip over time, changes from left to right are detail or noise, and changes from top to bottom are motion or
flicker. All strips of a scene have the same exposure.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import paths
from animation_modes import DELIVERED, MODES, ONE_BY_ONE, PEER, STILL_SEED
from animation_scenes import Animation
from animation_variants import USUAL, Variant
from document import Figure, Table
from metrics import displayed, white_of
from paths import OUT
from PIL import Image

SAMPLES, SEED = 4, 0
SHOWN = (ONE_BY_ONE, DELIVERED, PEER, STILL_SEED, "path", "temporal-l2", "temporal-l1")
REFERENCE = "reference"
SIDE_BY_SIDE = ((ONE_BY_ONE, DELIVERED), (PEER, DELIVERED), (STILL_SEED, DELIVERED))  # left and right of each film
MAXIMUM_BYTES = 300_000  # of a film
FRAME_MILLISECONDS = 1000 // 12  # slower than real time, so that flicker is seen
CROP = (0.3, 0.35, 0.4, 0.5)  # x, y, width and height as shares of the picture
ROW = 0.65  # place of the row that is shown over time, from the top, as a share of the height
TALL = 6  # pixels that a frame takes in a strip over time
QUALITY = 95


def wanted(animation: Animation, variant: Variant, mode: str, samples: int, seed: int) -> bool:
    """Returns whether strips of a run are stored."""
    usual = (variant.size, variant.shutter) == (USUAL.size, USUAL.shutter)
    return animation.scene.own and usual and mode in SHOWN and (samples, seed) == (SAMPLES, SEED)


def store(animation: Animation, mode: str, images: np.ndarray, reference: np.ndarray, checked: slice) -> None:
    """Stores the strips of a mode, and with the first mode those of the converged frames.

    Frames that have no converged one stay black there.
    """
    white = white_of(reference)
    converged = np.zeros_like(images)
    converged[checked] = reference
    for name, frames in ((mode, images), *(((REFERENCE, converged),) if mode == SHOWN[0] else ())):
        shown = displayed(frames, white)
        _save(film(shown), _film_file(animation.name, name))
        _save(over_time(shown), _time_file(animation.name, name))


def film(frames: np.ndarray) -> np.ndarray:
    """Returns a crop of all frames, side by side."""
    _, height, width, _ = frames.shape
    x, y, wide, high = (round(share * size) for share, size in zip(CROP, (width, height, width, height), strict=True))
    return np.concatenate(list(frames[:, y : y + high, x : x + wide]), axis=1)


def over_time(frames: np.ndarray) -> np.ndarray:
    """Returns one row of pixels of all frames, the first frame on top."""
    return np.repeat(frames[:, round(ROW * frames.shape[1])], TALL, axis=0)


def table(name: str) -> Table | None:
    """Returns a table of the strips that are stored of a scene, or None if there are none."""
    made = Table(["mode", "one row of pixels over time", "all frames, a crop"])
    for mode in (REFERENCE, *SHOWN):
        files = _time_file(name, mode), _film_file(name, mode)
        if all((OUT / file).exists() for file in files):
            label = "converged" if mode == REFERENCE else MODES[mode].label
            made.rows.append([label, *(f"![{label}]({file})" for file in files)])
    return made if made.rows else None


def films(name: str) -> list[Figure]:
    """Makes the films of a scene from its stored strips, and returns them."""
    made = []
    for pair in SIDE_BY_SIDE:
        files = [OUT / _film_file(name, mode) for mode in pair]
        strips = [np.asarray(Image.open(file)) for file in files if file.exists()]
        if len({strip.shape for strip in strips}) == 1 and len(strips) == len(pair):
            file = f"{paths.PICTURES}/animation-{name}-{pair[0]}-beside-{pair[1]}.webp"
            sides = [np.split(strip, strip.shape[1] // round(CROP[2] * USUAL.size[0]), axis=1) for strip in strips]
            save_film([np.concatenate(frames, axis=1) for frames in zip(*sides, strict=True)], OUT / file)
            made.append(Figure(file, f"{MODES[pair[0]].label} beside {MODES[pair[1]].label}, {SAMPLES} samples"))
    return made


def save_film(frames: list[np.ndarray], file: Path) -> None:
    """Writes an animated picture in the best quality that takes at most MAXIMUM_BYTES.

    Raises RuntimeError if none does.
    """
    first, *others = (Image.fromarray(frame) for frame in frames)
    for quality in range(QUALITY, 0, -10):
        first.save(
            file, save_all=True, append_images=others, duration=FRAME_MILLISECONDS, loop=0, quality=quality, method=4
        )
        if file.stat().st_size <= MAXIMUM_BYTES:
            return
    file.unlink()
    raise RuntimeError(f"{file.name} takes more than {MAXIMUM_BYTES} bytes in any quality")


def _film_file(name: str, mode: str) -> str:
    return f"{paths.PICTURES}/animation-{name}-{mode}-film.webp"


def _time_file(name: str, mode: str) -> str:
    return f"{paths.PICTURES}/animation-{name}-{mode}-time.webp"


def _save(shown: np.ndarray, file: str) -> None:
    (OUT / file).parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray((255.0 * shown + 0.5).astype(np.uint8)).save(OUT / file, quality=QUALITY, method=6)
