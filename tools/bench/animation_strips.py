"""Strips of the project's own animations: a crop of all frames side by side, and one row of pixels over time.

In a strip over time, changes from left to right are detail or noise, and changes from top to bottom are motion or
flicker. All strips of a scene have the same exposure.
"""

from __future__ import annotations

import numpy as np
import paths
from animation_modes import MODES
from animation_scenes import ANIMATIONS, Animation
from animation_variants import USUAL, Variant
from document import Table
from metrics import displayed, white_of
from paths import OUT
from PIL import Image

SAMPLES, SEED = 16, 0
SHOWN = (
    "path",
    "path-regularized",
    "gradient-l2",
    "gradient-l1",
    "temporal-l2",
    "temporal-l1",
    "temporal-auto",
    "cycles-denoised",
)
REFERENCE = "reference"
CROP = (0.3, 0.35, 0.4, 0.5)  # x, y, width and height as shares of the picture
ROW = 0.65  # place of the row that is shown over time, from the top, as a share of the height
TALL = 6  # pixels that a frame takes in a strip over time
QUALITY = 95


def wanted(animation: Animation, variant: Variant, mode: str, samples: int, seed: int) -> bool:
    """Returns whether strips of a run are stored."""
    return animation.scene.own and mode in SHOWN and (variant, samples, seed) == (USUAL, SAMPLES, SEED)


def store(animation: Animation, mode: str, images: np.ndarray, reference: np.ndarray) -> None:
    """Stores the strips of a mode, and with the first mode those of the converged frames."""
    white = white_of(reference)
    for name, frames in ((mode, images), *(((REFERENCE, reference),) if mode == SHOWN[0] else ())):
        shown = displayed(frames, white)
        _save(film(shown), _film_file(animation, name))
        _save(over_time(shown), _time_file(animation, name))


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
    animation = next(animation for animation in ANIMATIONS if animation.name == name)
    made = Table(["mode", "one row of pixels over time", "all frames, a crop"])
    for mode in (REFERENCE, *SHOWN):
        files = _time_file(animation, mode), _film_file(animation, mode)
        if all((OUT / file).exists() for file in files):
            label = "converged" if mode == REFERENCE else MODES[mode].label
            made.rows.append([label, *(f"![{label}]({file})" for file in files)])
    return made if made.rows else None


def _film_file(animation: Animation, mode: str) -> str:
    return f"{paths.PICTURES}/animation-{animation.name}-{mode}-film.webp"


def _time_file(animation: Animation, mode: str) -> str:
    return f"{paths.PICTURES}/animation-{animation.name}-{mode}-time.webp"


def _save(shown: np.ndarray, file: str) -> None:
    (OUT / file).parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray((255.0 * shown + 0.5).astype(np.uint8)).save(OUT / file, quality=QUALITY, method=6)
