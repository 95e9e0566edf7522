"""Renders pictures of the project's own scenes for the report: modes at the same samples, their errors, and the
converged image.

    pictures.py [--scenes a,b]

Pictures are stored in out/bench/pictures/ as they are displayed, with one exposure per scene; pictures.json has their
errors. Where the results say that Cycles with its denoiser has less error, maps of bias and variance over several seeds
are added. Nothing is timed.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from typing import Any

import behind
import maps
import numpy as np
import paths
import results
from crops import CROP, choose_crops, window
from document import Crop, Slider, Table, number
from metrics import displayed, relative_squared_error, white_of
from modes import MODES, REFERENCES
from paths import OUT
from PIL import Image
from records import shortened
from references import reference
from renderers import Renderers
from scenes import Scene, select
from version import conditions, version_of_build

FACTS = OUT / paths.PICTURES / "pictures.json"
SIZE, REFERENCE = (320, 180), 512  # samples of the converged image
SAMPLES = 16
NOISY = ("path", "cycles")
RECONSTRUCTED = ("gradient-l2", "gradient-l1", "path-regularized", "auto", "auto-denoised", "cycles-denoised")
LOSSLESS, NOISE, MAP = 100, 95, 80  # qualities of reconstructed pictures, noisy pictures and error maps
ERROR, BIAS, DEVIATION = "-error", "-bias", "-deviation"


@dataclass
class Studio:
    """Renders and stores the pictures of one scene."""

    scene: Scene
    renderers: Renderers

    def reference(self, mode: str) -> tuple[np.ndarray, np.ndarray]:
        engine = REFERENCES[MODES[mode].engine]
        return reference(self.renderers, self.scene, engine, SIZE, REFERENCE, version_of_build())

    def works(self, mode: str) -> bool:
        if why := self.renderers.refusal(mode):
            print(f"SKIP {mode} in {self.scene.name}: {why}", flush=True)
        return not why

    def take_pictures(self) -> dict[str, Any]:
        """Stores pictures and error maps; returns the chosen crops and the errors of whole pictures and crops."""
        white = white_of(self.reference("path")[0])
        store(displayed_bytes(self.reference("path")[0], white), self.scene, "reference")
        errors = {}
        for mode in filter(self.works, (*NOISY, *RECONSTRUCTED)):
            image = self.renderers.render(mode, SAMPLES, 0)[0]
            errors[mode] = relative_squared_error(image, *self.reference(mode))
            store(displayed_bytes(image, white), self.scene, mode, NOISE if mode in NOISY else LOSSLESS)
            store(maps.colored(errors[mode]), self.scene, mode + ERROR, MAP)
        crops = choose_crops([errors[mode] for mode in RECONSTRUCTED if mode in errors])
        parts = [(slice(None), slice(None)), *(window(*crop) for crop in crops)]
        return {
            "crops": crops,
            "errors": {mode: [float(error[part].mean()) for part in parts] for mode, error in errors.items()},
        }

    def separate_bias(self, modes: list[str]) -> dict[str, tuple[float, float]]:
        """Stores maps of bias and variance; returns the bias² and variance of each mode."""
        found = {}
        for mode in filter(self.works, modes):
            spread = behind.render_spread(self.renderers, mode, SAMPLES, self.reference(mode))
            found[mode] = spread.parts()
            store(maps.colored(spread.bias_map()), self.scene, mode + BIAS, MAP)
            store(maps.colored(spread.variance_map()), self.scene, mode + DEVIATION, MAP)
        return found


def displayed_bytes(image: np.ndarray, white: float) -> np.ndarray:
    return (255.0 * displayed(image, white) + 0.5).astype(np.uint8)


def store(pixels: np.ndarray, scene: Scene, name: str, quality: int = LOSSLESS) -> None:
    Image.fromarray(pixels).save(
        OUT / file_of(scene.name, name), lossless=quality == LOSSLESS, quality=quality, method=6
    )


def file_of(scene: str, name: str) -> str:
    """Returns the path of a picture, relative to the report."""
    return f"{paths.PICTURES}/{scene}-{name}.webp"


def facts() -> dict[str, Any]:
    """Returns, for each scene, `crops`, `errors` of the whole picture and the crops, and `parts`, bias² and variance,
    by mode.
    """
    return json.loads(FACTS.read_text()) if FACTS.exists() else {}


def remember(scene: str, found: dict[str, Any]) -> None:
    known = facts() | {scene: found}
    FACTS.write_text(json.dumps(shortened({name: known[name] for name in sorted(known)}), indent=1) + "\n")


def slider(scene: str) -> Slider | None:
    """Returns a slider over all stored pictures of a scene, or None if there are none."""
    known = facts().get(scene, {})
    labels = {mode: MODES[mode].label for mode in (*NOISY, *RECONSTRUCTED)}

    def stored(prefix: str, suffix: str) -> dict[str, str]:
        files = {prefix + label: file_of(scene, mode + suffix) for mode, label in labels.items()}
        return {label: file for label, file in files.items() if (OUT / file).exists()}

    groups = {
        "pictures": {"Reference": file_of(scene, "reference")} | stored("", ""),
        "errors": stored("error of ", ERROR),
        f"bias: error of the mean of {behind.SEEDS} results": stored("bias of ", BIAS),
        f"noise: deviation among {behind.SEEDS} results": stored("noise of ", DEVIATION),
    }
    if labels["path"] not in groups["pictures"]:
        return None
    crops = [Crop(x / SIZE[0], y / SIZE[1], SIZE[0] / CROP[0]) for x, y in known.get("crops", [])]
    host = f" Blender {known['blender']}." if "blender" in known else ""
    caption = (
        f"{SAMPLES} samples per pixel; the reference has {REFERENCE}.{host} In the crops the errors of the modes "
        "differ most."
    )
    groups = {heading: files for heading, files in groups.items() if files}
    shown = labels["path-regularized"] if labels["path-regularized"] in groups["pictures"] else "Reference"
    return Slider(groups, caption, (labels["path"], shown), crops, "error-scale.svg" if "errors" in groups else "")


def errors_of_pictures(scene: str) -> Table | None:
    if "crops" not in (known := facts().get(scene, {})):
        return None
    made = Table(["relMSE of the pictures", "whole", "crop 1", "crop 2", f"bias², {behind.SEEDS} seeds", "variance"])
    for mode, errors in known["errors"].items():
        parts = known.get("parts", {}).get(mode, (None, None))
        made.rows.append([MODES[mode].label, *(number(value, ".4f") for value in (*errors, *parts))])
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    arguments = parser.parse_args()
    FACTS.parent.mkdir(parents=True, exist_ok=True)
    modes_behind = {scene.name: behind.modes_behind(scene) for scene in results.load()}
    for scene in (scene for scene in select(arguments.scenes) if scene.own):
        for old in FACTS.parent.glob(f"{scene.name}-*.webp"):
            old.unlink()
        renderers = Renderers(scene, SIZE)
        try:
            studio = Studio(scene, renderers)
            found = conditions(version_of_build()) | studio.take_pictures()
            if late := modes_behind.get(scene.name):
                found["parts"] = studio.separate_bias([*late, behind.THEIRS])
            remember(scene.name, found)
        finally:
            renderers.close()


if __name__ == "__main__":
    main()
