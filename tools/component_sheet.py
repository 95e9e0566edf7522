"""Shows the components of a frame side by side: a column for each component, a row for each pass that is not empty.

    component_sheet.py FRAME.exr SHEET.webp

Motion is shown by its direction as hue and its length as brightness; pixels that are not tracked are grey.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR
from PIL import Image, ImageDraw

GAP, HEADER = 2, 14  # pixels between pictures, and for the line of text above each
BRIGHTEST = 98.0  # percentile that is shown as white

Passes = dict[str, np.ndarray]
DrawRow = Callable[[Passes, str, float], np.ndarray]


def read(path: Path) -> Passes:
    """Returns the passes of a file by name without layer, each (height, width, channels) with the top row first."""
    planes: dict[str, dict[str, np.ndarray]] = {}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            for name, channel in part.channels.items():
                full, _, letter = name.rpartition(".")
                planes.setdefault(full.partition(".")[2], {})[letter] = channel.pixels
    return {
        name: np.stack([found[letter] for letter in sorted(found, key="RGBXYZWVA".find)], axis=2)
        for name, found in planes.items()
    }


def components(passes: Passes) -> list[str]:
    """Returns the names of components in the order of their first passes in the file.

    A name has no blanks, and every component has the pass Tracked, which also identifies one called Irradiance.
    """
    words = (name.split(" ") for name in passes if name.startswith("Path "))
    return [found[1] for found in words if found[2:] == ["Tracked"]]


def light(image: np.ndarray, white: float) -> np.ndarray:
    return np.clip(image[..., :3] / white, 0.0, 1.0) ** (1.0 / 2.2)


def longest_motion(passes: Passes) -> float:
    """Returns the longest motion of any component in pixels."""
    return max(float(np.abs(passes[f"Path {name} Motion"][..., :2]).max()) for name in components(passes))


def wheel(vectors: np.ndarray, longest: float) -> np.ndarray:
    """Returns colours that show the direction of vectors as hue and their length as brightness.

    vectors: previous − current in pixels, y upwards. `longest` is the length that is shown with full brightness.
    """
    length = np.clip(np.hypot(vectors[..., 0], vectors[..., 1]) / max(longest, 1e-6), 0.0, 1.0)
    hue = np.arctan2(-vectors[..., 1], -vectors[..., 0]) / (2.0 * np.pi)
    colors = np.clip(np.abs((hue[..., None] * 6.0 + np.array((0.0, 4.0, 2.0))) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    return colors * np.sqrt(length)[..., None]


def motion(passes: Passes, component: str, longest: float | None = None) -> np.ndarray:
    """Returns a picture of a component's motion from the frame before to this one, on one scale for all components."""
    tracked = passes[f"Path {component} Tracked"][..., 0] > 0.0
    longest = longest_motion(passes) if longest is None else longest
    return np.where(tracked[..., None], wheel(passes[f"Path {component} Motion"], longest), 0.25)


ROWS: dict[str, DrawRow] = {
    "": lambda passes, name, white: light(passes[f"Path {name}"], white),
    "Reflectance": lambda passes, name, _: light(passes[f"Path {name} Reflectance"], 1.0),
    "Irradiance": lambda passes, name, white: light(passes[f"Path {name} Irradiance"], 2.0 * white),
    "Normal": lambda passes, name, _: 0.5 + 0.5 * np.clip(passes[f"Path {name} Normal"], -1.0, 1.0),
    "Motion": lambda passes, name, _: motion(passes, name),
}
"""Functions that draw the rows of the sheet. The last argument is the radiance that is shown as white."""


def sheet(passes: Passes) -> Image.Image:
    """Returns the picture of all components."""
    names = components(passes)
    rows = {
        suffix: show
        for suffix, show in ROWS.items()
        if any(passes[f"Path {name} {suffix}".strip()].any() for name in names)
    }
    white = max(float(np.percentile(passes["Combined"][..., :3], BRIGHTEST)), 1e-6)
    height, width = passes["Combined"].shape[:2]
    made = Image.new("RGB", (len(names) * (width + GAP) - GAP, len(rows) * (height + HEADER) - GAP), "white")
    text = ImageDraw.Draw(made)
    for row, (suffix, show) in enumerate(rows.items()):
        for column, name in enumerate(names):
            left, top = column * (width + GAP), row * (height + HEADER)
            text.text((left + 2, top), f"{name} {suffix}", fill="black")
            made.paste(
                Image.fromarray(np.uint8(np.rint(255.0 * show(passes, name, white)))), (left, top + HEADER - GAP)
            )
    return made


if __name__ == "__main__":
    source, target = map(Path, sys.argv[1:])
    target.parent.mkdir(parents=True, exist_ok=True)
    sheet(read(source)).save(target, quality=90)
