"""Pictures of the project's own scenes for the sliders: every mode at the same samples, and the converged image of plain path tracing.

    pictures.py [--scenes a,b] [--reference 512]

Stored in docs/benchmark/pictures/ as they are displayed, one exposure per scene. Nothing is timed here.
"""

from __future__ import annotations

import argparse

import numpy as np
from document import Slider
from metrics import displayed, white_of
from modes import MODES
from PIL import Image
from references import reference
from renderers import Renderers
from results import FOLDER
from scenes import Scene, select
from version import version_of_build

FOLDER_NAME = "pictures"
SIZE = (320, 180)
SAMPLES = 16
LABELS = {mode: MODES[mode].label for mode in MODES if mode != "gradient-none"} | {"reference": "Reference"}


def render(scene: Scene, reference_samples: int) -> None:
    renderers = Renderers(scene, SIZE)
    try:
        converged, _ = reference(renderers, scene, "path", SIZE, reference_samples, version_of_build())
        white = white_of(converged)
        store(converged, white, scene, "reference")
        for mode in (name for name in LABELS if name != "reference"):
            if why := renderers.refusal(mode):
                print(f"SKIP {mode} in {scene.name}: {why}", flush=True)
            else:
                store(renderers.render(mode, SAMPLES, 0)[0], white, scene, mode)
    finally:
        renderers.close()


def store(image: np.ndarray, white: float, scene: Scene, name: str) -> None:
    (FOLDER / FOLDER_NAME).mkdir(exist_ok=True)
    pixels = (255.0 * displayed(image, white) + 0.5).astype(np.uint8)
    Image.fromarray(pixels).save(FOLDER / file_of(scene.name, name), quality=80, method=6)


def file_of(scene: str, name: str) -> str:
    """Relative to the report."""
    return f"{FOLDER_NAME}/{scene}-{name}.webp"


def slider(scene: str) -> Slider | None:
    """All stored pictures of a scene."""
    files = {label: file_of(scene, name) for name, label in LABELS.items() if (FOLDER / file_of(scene, name)).exists()}
    if len(files) < 2:
        return None
    shown = [LABELS[name] for name in ("path", "gradient-l2")]
    return Slider(files, f"{SAMPLES} samples per pixel, the reference apart.", (shown[0], shown[1]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--reference", type=int, default=512)
    arguments = parser.parse_args()
    for scene in (scene for scene in select(arguments.scenes) if scene.own):
        render(scene, arguments.reference)


if __name__ == "__main__":
    main()
