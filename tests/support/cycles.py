"""Pictures of a scene by Cycles and by Gradus."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from . import images


def passes(scene: bpy.types.Scene, folder: Path, engine: str, samples: int = 16, **changed: Any) -> images.Passes:
    """Renders an image without a denoiser and returns its passes. `changed` are settings of Gradus."""
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
    return images.render(scene, folder, **(settings | changed))


def blocks(image: np.ndarray) -> np.ndarray:
    """Returns means of blocks of 4×4 pixels of an image of 64×36."""
    return image.reshape(9, 4, 16, 4, -1).mean(axis=(1, 3))


def picture(scene: bpy.types.Scene, folder: Path, engine: str, samples: int = 16, **changed: Any) -> np.ndarray:
    """Renders an image and returns blocks() of its colours. `changed` are settings of Gradus."""
    return blocks(passes(scene, folder, engine, samples, **changed)["Combined"][..., :3])


def pictures(scene: bpy.types.Scene, folder: Path, samples: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Returns the picture of Cycles and that of Gradus."""
    return picture(scene, folder, "CYCLES", samples), picture(scene, folder, "GRADUS", samples)
