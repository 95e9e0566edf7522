"""Pictures of a frame's components, of the project's own scenes: light, motion by a wheel of colours, and how much the next frame
differs from what it predicts, a column for each component."""

from __future__ import annotations

import sys
from pathlib import Path

import maps
import motion_metrics
import numpy as np
from motion_metrics import Passes, Prediction
from PIL import Image, ImageDraw
from results import FOLDER

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import component_sheet  # noqa: E402

FOLDER_NAME = "pictures"
GAP, HEADER, WHEEL = 2, 14, 81  # pixels
NOT_COUNTED = 64  # grey
QUALITY = 88


def file_name(scene: str) -> str:
    return f"{FOLDER_NAME}/motion-{scene}.webp"


def store(scene: str, passes: Passes, found: dict[str, Prediction]) -> None:
    _save(sheet(passes, found), file_name(scene))


def _save(picture: Image.Image, file: str) -> None:
    (FOLDER / FOLDER_NAME).mkdir(parents=True, exist_ok=True)
    picture.save(FOLDER / file, quality=QUALITY, method=6)


def sheet(passes: Passes, found: dict[str, Prediction]) -> Image.Image:
    """Of the components that anything is told of, of one frame; the wheel of colours in a corner of the first one's motion."""
    names = [name for name, prediction in found.items() if prediction.counts.any()]
    longest = max(longest_motion(passes, name) for name in names)
    white = max(float(np.percentile(passes["Combined"][..., :3], component_sheet.BRIGHTEST)), 1e-6)
    rows = {
        "": lambda name: component_sheet.light(passes[f"Path {name}"], white),
        "motion": lambda name: component_sheet.motion(passes, name, longest),
        "error of its prediction": lambda name: errors(found[name].own, found[name].counts),
        "by the surface's motion": lambda name: errors(found[name].surface, found[name].counts),
    }
    height, width = passes["Combined"].shape[:2]
    made = Image.new("RGB", (len(names) * (width + GAP) - GAP, len(rows) * (height + HEADER) - GAP), "white")
    text = ImageDraw.Draw(made)
    for row, (about, show) in enumerate(rows.items()):
        for column, name in enumerate(names):
            place = column * (width + GAP), row * (height + HEADER)
            text.text((place[0] + 2, place[1]), f"{name} {about}", fill="black")
            made.paste(_image(show(name)), (place[0], place[1] + HEADER - GAP))
    made.paste(wheel(longest), (GAP, height + 2 * HEADER))
    return made


def _image(shown: np.ndarray) -> Image.Image:
    return Image.fromarray(np.uint8(np.rint(255.0 * shown)))


def longest_motion(passes: Passes, name: str) -> float:
    """Of one component, from the frame before, in pixels."""
    return float(np.abs(passes[f"Path {name}{motion_metrics.MOTION}"][..., :2]).max())


def errors(squares: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """On the scale of all error maps; what does not count is grey."""
    colors = maps.COLORS(maps.SCALE(np.sqrt(np.where(counts, np.clip(squares, 0.0, 1.0), 0.0))))[..., :3]
    return np.where(counts[..., None], colors, NOT_COUNTED / 255.0)


def wheel(longest: float) -> Image.Image:
    """Motion to all sides, up to the longest."""
    y, x = np.indices((WHEEL, WHEEL)) - WHEEL // 2
    radius = WHEEL // 2
    moved = np.stack([x, -y], axis=-1) * (longest / radius)
    inside = np.hypot(x, y) <= radius
    shown = np.where(inside[..., None], component_sheet.wheel(-moved, longest), 1.0)
    made = Image.new("RGB", (WHEEL, WHEEL + HEADER), "white")
    made.paste(_image(shown))
    ImageDraw.Draw(made).text((2, WHEEL), f"{longest:.1f} pixels", fill="black")
    return made
