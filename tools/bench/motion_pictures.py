"""Pictures of components of the project's own scenes.

A sheet shows each component of a frame in a column: its light, its motion by a color wheel, and the errors of the
prediction of the next frame. A strip shows one component over all frames.
"""

from __future__ import annotations

import sys

import maps
import motion_metrics
import numpy as np
from motion_metrics import SPECULAR, Passes, Prediction
from paths import HERE, OUT, PICTURES
from PIL import Image, ImageDraw

sys.path.insert(0, str(HERE.parent))
import component_sheet  # noqa: E402

GAP, HEADER, WHEEL = 2, 14, 81  # pixels
NOT_COUNTED = 64  # gray level of pixels that are not measured
QUALITY = 88


def file_name(scene: str) -> str:
    return f"{PICTURES}/motion-{scene}.webp"


def strip_name(scene: str) -> str:
    return f"{PICTURES}/motion-strip-{scene}.webp"


def store(scene: str, passes: Passes, found: dict[str, Prediction]) -> None:
    _save(sheet(passes, found), file_name(scene))


def store_strip(scene: str, passes: Passes) -> None:
    """Stores the strip of the brightest reflection or refraction, if there is one."""
    if name := brightest(passes):
        _save(strip(passes, name), strip_name(scene))


def _save(picture: Image.Image, file: str) -> None:
    (OUT / file).parent.mkdir(parents=True, exist_ok=True)
    picture.save(OUT / file, quality=QUALITY, method=6)


def brightest(passes: Passes) -> str:
    """Returns the reflection or refraction with most light, or "" if there is none."""
    light = {name: float(passes[f"Path {name}"].sum()) for name in SPECULAR if f"Path {name}" in passes}
    name = max(light, key=lambda name: light[name], default="")
    return name if light.get(name, 0.0) > 0.0 else ""


def strip(passes: Passes, name: str) -> Image.Image:
    """Draws one component over all frames, and below each frame the relative difference from the next one along the
    motion.

    The second row follows the component's own motion and the third row that of the surface; pixels are gray where
    either leaves the picture. Passes are (frames, height, width, channels).
    """
    white = max(float(np.percentile(passes["Combined"][..., :3], component_sheet.BRIGHTEST)), 1e-6)
    count = len(passes["Combined"])
    steps = [differences(passes, name, frame) for frame in range(count - 1)]
    rows = {
        f"{name}, frame after frame": [component_sheet.light(frame, white) for frame in passes[f"Path {name}"]],
        "the next frame's difference, by its own motion": [errors(own, counts) for own, _, counts in steps],
        "by the surface's motion": [errors(surface, counts) for _, surface, counts in steps],
    }
    height, width = passes["Combined"].shape[1:3]
    made = Image.new("RGB", (count * (width + GAP) - GAP, len(rows) * (height + HEADER) - GAP), "white")
    for row, (about, shown) in enumerate(rows.items()):
        top = row * (height + HEADER)
        ImageDraw.Draw(made).text((2, top), about, fill="black")
        for column, picture in enumerate(shown):
            made.paste(_image(picture), (column * (width + GAP), top + HEADER - GAP))
    return made


def differences(passes: Passes, name: str, frame: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the relative squared differences from the next frame by own motion and by the surface's, and the pixels
    that count.
    """
    now, following = (motion_metrics.gray(passes[f"Path {name}"][at]) for at in (frame, frame + 1))
    vectors = motion_metrics.vectors_of_component(motion_metrics.of_frame(passes, frame), name)
    own, surface = (motion_metrics.warped(following, steps) - now for steps in (vectors.own, vectors.surface))
    lit = now > motion_metrics.DARK * motion_metrics.gray(passes["Combined"][frame]).mean()
    counts = vectors.tracked & lit & np.isfinite(own) & np.isfinite(surface)
    return *((np.where(counts, difference, 0.0) / np.maximum(now, 1e-9)) ** 2 for difference in (own, surface)), counts


def sheet(passes: Passes, found: dict[str, Prediction]) -> Image.Image:
    """Draws all components of a frame that have measured pixels, with the color wheel in a corner of the first one's
    motion.
    """
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
    """Returns the longest motion of a component since the frame before, in pixels."""
    return float(np.abs(passes[f"Path {name}{motion_metrics.MOTION}"][..., :2]).max())


def errors(squares: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Returns errors on the scale of all error maps; pixels that do not count are gray."""
    colors = maps.COLORS(maps.SCALE(np.sqrt(np.where(counts, np.clip(squares, 0.0, 1.0), 0.0))))[..., :3]
    return np.where(counts[..., None], colors, NOT_COUNTED / 255.0)


def wheel(longest: float) -> Image.Image:
    """Draws the color wheel of motion up to the longest one."""
    y, x = np.indices((WHEEL, WHEEL)) - WHEEL // 2
    radius = WHEEL // 2
    moved = np.stack([x, -y], axis=-1) * (longest / radius)
    inside = np.hypot(x, y) <= radius
    shown = np.where(inside[..., None], component_sheet.wheel(-moved, longest), 1.0)
    made = Image.new("RGB", (WHEEL, WHEEL + HEADER), "white")
    made.paste(_image(shown))
    ImageDraw.Draw(made).text((2, WHEEL), f"{longest:.1f} pixels", fill="black")
    return made
