"""Pictures of a scene by Cycles and by Gradus."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from . import images


def picture(scene: bpy.types.Scene, folder: Path, engine: str, samples: int = 16, **changed: Any) -> np.ndarray:
    """Renders an image and returns means of blocks of 4×4 pixels. `changed` are settings of Gradus."""
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    settings = {
        "samples": samples,
        "integrator": "PATH",
        "reconstruction": "NONE",
        "pixel_filter": "BOX",
        "filter_width": 1.0,
    }
    image = images.render(scene, folder, **(settings | changed))["Combined"][..., :3]
    return image.reshape(9, 4, 16, 4, 3).mean(axis=(1, 3))


def pictures(scene: bpy.types.Scene, folder: Path, samples: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Returns the picture of Cycles and that of Gradus."""
    return picture(scene, folder, "CYCLES", samples), picture(scene, folder, "GRADUS", samples)
