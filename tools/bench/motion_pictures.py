"""Pictures of a frame's components, of the project's own scenes: light, motion by a wheel of colours, and how much the next frame
differs from what it predicts, a column for each component."""

from __future__ import annotations

import sys
from pathlib import Path

import maps
import numpy as np
from animation_variants import Variant
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


def store(scene: str, variant: Variant, passes: Passes, found: dict[str, Prediction]) -> None:
    """Of the usual variant alone."""
    if variant.shutter == 0.0:
        (FOLDER / FOLDER_NAME).mkdir(parents=True, exist_ok=True)
        sheet(passes, found).save(FOLDER / file_name(scene), quality=QUALITY, method=6)


def sheet(passes: Passes, found: dict[str, Prediction]) -> Image.Image:
    """Of the components that anything is told of; the wheel of colours in a corner of the first one's motion."""
    first = {name: frames[0] for name, frames in passes.items()}
    names = [name for name, prediction in found.items() if prediction.counts.any()]
    longest = component_sheet.longest_motion(first)
    white = max(float(np.percentile(first["Combined"][..., :3], component_sheet.BRIGHTEST)), 1e-6)
    rows = {
        "": lambda name: component_sheet.light(first[f"Path {name}"], white),
        "motion": lambda name: component_sheet.motion(first, name, longest),
        "error of its prediction": lambda name: errors(found[name].own, found[name].counts),
        "by the surface's motion": lambda name: errors(found[name].surface, found[name].counts),
    }
    height, width = first["Combined"].shape[:2]
    made = Image.new("RGB", (len(names) * (width + GAP) - GAP, len(rows) * (height + HEADER) - GAP), "white")
    text = ImageDraw.Draw(made)
    for row, (about, show) in enumerate(rows.items()):
        for column, name in enumerate(names):
            place = column * (width + GAP), row * (height + HEADER)
            text.text((place[0] + 2, place[1]), f"{name} {about}", fill="black")
            made.paste(Image.fromarray(np.uint8(np.rint(255.0 * show(name)))), (place[0], place[1] + HEADER - GAP))
    made.paste(wheel(longest), (GAP, height + 2 * HEADER))
    return made


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
    made.paste(Image.fromarray(np.uint8(np.rint(255.0 * shown))))
    ImageDraw.Draw(made).text((2, WHEEL), f"{longest:.1f} pixels", fill="black")
    return made
