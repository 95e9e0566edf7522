"""Pictures of the project's own scenes for the sliders: modes at the same samples, their errors, and the converged image.

    pictures.py [--scenes a,b] [--reference 512]

Stored in docs/benchmark/pictures/ as they are displayed, one exposure per scene, with what is known of them in pictures.json. Where the
results say that Cycles with its denoiser is ahead, bias and variance are told apart over some seeds; other people's scenes have these
figures alone, no pictures. Nothing is timed here.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from typing import Any

import behind
import maps
import numpy as np
import results
from crops import CROP, choose_crops, window
from document import Crop, Slider, Table, number
from metrics import displayed, relative_squared_error, white_of
from modes import MODES, REFERENCES
from PIL import Image
from references import reference
from renderers import Renderers
from results import FOLDER
from scenes import Scene, select
from version import version_of_build

FOLDER_NAME = "pictures"
FACTS = FOLDER / FOLDER_NAME / "pictures.json"
SIZE = (320, 180)
SAMPLES = 16
NOISY = ("path", "cycles")
RECONSTRUCTED = ("gradient-l2", "gradient-l1", "path-regularized", "auto", "auto-denoised", "cycles-denoised")
ERROR, BIAS, DEVIATION = "-error", "-bias", "-deviation"


@dataclass
class Studio:
    """One scene with its renderers."""

    scene: Scene
    renderers: Renderers
    reference_samples: int
    version: str

    def reference(self, mode: str) -> tuple[np.ndarray, np.ndarray]:
        engine = REFERENCES[MODES[mode].engine]
        return reference(self.renderers, self.scene, engine, SIZE, self.reference_samples, self.version)

    def works(self, mode: str) -> bool:
        if why := self.renderers.refusal(mode):
            print(f"SKIP {mode} in {self.scene.name}: {why}", flush=True)
        return not why

    def take_pictures(self) -> dict[str, Any]:
        """Pictures and error maps; crops and the errors in them."""
        white = white_of(self.reference("path")[0])
        store(displayed_bytes(self.reference("path")[0], white), self.scene, "reference")
        errors = {}
        for mode in filter(self.works, (*NOISY, *RECONSTRUCTED)):
            image, (converged, variance) = self.renderers.render(mode, SAMPLES, 0)[0], self.reference(mode)
            store(displayed_bytes(image, white), self.scene, mode)
            store(maps.colored(relative_squared_error(image, converged)), self.scene, mode + ERROR)
            errors[mode] = relative_squared_error(image, converged, variance)
        crops = choose_crops([errors[mode] for mode in RECONSTRUCTED if mode in errors])
        parts = [(slice(None), slice(None)), *(window(*crop) for crop in crops)]
        return {"crops": crops, "errors": {mode: [float(error[part].mean()) for part in parts] for mode, error in errors.items()}}

    def tell_apart(self, modes: list[str]) -> dict[str, tuple[float, float]]:
        """Bias and variance by modes, with maps of scenes that may be shown."""
        found = {}
        for mode in filter(self.works, modes):
            spread = behind.render_spread(self.renderers, mode, SAMPLES, self.reference(mode))
            found[mode] = spread.parts()
            if self.scene.own:
                store(maps.colored(spread.bias_map()), self.scene, mode + BIAS)
                store(maps.colored(spread.variance_map()), self.scene, mode + DEVIATION)
        return found


def displayed_bytes(image: np.ndarray, white: float) -> np.ndarray:
    return (255.0 * displayed(image, white) + 0.5).astype(np.uint8)


def store(pixels: np.ndarray, scene: Scene, name: str) -> None:
    """Without loss: crops are magnified."""
    Image.fromarray(pixels).save(FOLDER / file_of(scene.name, name), lossless=True, quality=100, method=6)


def file_of(scene: str, name: str) -> str:
    """Relative to the report."""
    return f"{FOLDER_NAME}/{scene}-{name}.webp"


def facts() -> dict[str, Any]:
    """By scene: `crops`, `errors` of the whole picture and of the crops by mode, `parts` (bias² and variance) by mode."""
    return json.loads(FACTS.read_text()) if FACTS.exists() else {}


def remember(scene: str, found: dict[str, Any]) -> None:
    FACTS.write_text(json.dumps(facts() | {scene: found}, indent=1, sort_keys=True) + "\n")


def slider(scene: str) -> Slider | None:
    """All stored pictures of a scene."""
    if "crops" not in (known := facts().get(scene, {})):
        return None
    groups = {
        "pictures": {"Reference": file_of(scene, "reference")} | {MODES[m].label: file_of(scene, m) for m in known["errors"]},
        "errors": {f"error of {MODES[mode].label}": file_of(scene, mode + ERROR) for mode in known["errors"]},
    }
    if parts := known.get("parts"):
        groups[f"bias: error of the mean of {behind.SEEDS} results"] = {
            f"bias of {MODES[mode].label}": file_of(scene, mode + BIAS) for mode in parts
        }
        groups[f"noise: deviation among {behind.SEEDS} results"] = {
            f"noise of {MODES[mode].label}": file_of(scene, mode + DEVIATION) for mode in parts
        }
    crops = [Crop(x / SIZE[0], y / SIZE[1], SIZE[0] / CROP[0]) for x, y in known["crops"]]
    caption = f"{SAMPLES} samples per pixel, the reference apart. Crops are where errors of the reconstructions are furthest apart."
    shown = [MODES[mode].label for mode in ("path", "path-regularized")]
    return Slider(groups, caption, (shown[0], shown[1]), crops, "error-scale.svg")


def errors_of_crops(scene: str) -> Table | None:
    if "crops" not in (known := facts().get(scene, {})):
        return None
    made = Table(["relMSE of the pictures", "whole", "first crop", "second crop"])
    made.rows += [[MODES[mode].label, *(number(error, ".4f") for error in errors)] for mode, errors in known["errors"].items()]
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--reference", type=int, default=512)
    arguments = parser.parse_args()
    (FOLDER / FOLDER_NAME).mkdir(exist_ok=True)
    modes_behind = {scene.name: behind.modes_behind(scene) for scene in results.load()}
    for scene in select(arguments.scenes):
        late = modes_behind.get(scene.name, [])
        if not (scene.own or late):
            continue
        renderers = Renderers(scene, SIZE)
        try:
            studio = Studio(scene, renderers, arguments.reference, version_of_build())
            found: dict[str, Any] = {"version": studio.version, "reference_samples": arguments.reference}
            if late:
                found["parts"] = studio.tell_apart([*late, behind.THEIRS])
            if scene.own:
                found |= studio.take_pictures()
            remember(scene.name, found)
        finally:
            renderers.close()


if __name__ == "__main__":
    main()
