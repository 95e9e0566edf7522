"""Converged frames: each engine's own by plain path tracing, with the variance of their mean, cached in the user's
cache folder.

Each part renders the whole range of frames with another seed. Sums are stored after each part, so that an interrupted
reference goes on, and one of more samples reuses what is there. The runs of the benchmark never use seeds from 1000 on.
The cache does not depend on the commit, because tests check what path tracing converges to; after a change that is
meant to change pictures, remove its files.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from animation_renderer import AnimationRenderer
from references import CACHE, engine_key

PART = 64  # samples per pixel
MINIMUM_PARTS = 4  # from which a variance is estimated
VECTOR_SAMPLES = 16


@dataclass
class Reference:
    """Converged frames and the variance of their mean (frames, height, width, 3)."""

    mean: np.ndarray
    variance: np.ndarray
    samples: int


@dataclass
class _Sums:
    """Sums of the parts that were rendered so far, and the file that stores them."""

    file: Path
    parts: int = 0
    sum: np.ndarray | float = 0.0
    squares: np.ndarray | float = 0.0

    def load(self) -> None:
        if self.file.exists():
            stored = np.load(self.file)
            self.parts, self.sum, self.squares = int(stored["parts"]), stored["sum"], stored["squares"]

    def add(self, images: np.ndarray) -> None:
        self.parts, self.sum, self.squares = self.parts + 1, self.sum + images, self.squares + images**2
        _store(self.file, parts=self.parts, sum=self.sum, squares=self.squares)

    def reference(self) -> Reference:
        mean = np.asarray(self.sum) / self.parts
        variance = (np.asarray(self.squares) / self.parts - mean**2) / (self.parts - 1)
        return Reference(mean, np.maximum(variance, 0.0), self.parts * PART)


def reference(renderer: AnimationRenderer, engine: str, samples: int) -> Reference:
    """Returns converged frames of at least so many samples; `engine` is a mode of plain path tracing."""
    sums = _Sums(file_of(renderer, engine_key(engine)))
    sums.load()
    while sums.parts < max(samples // PART, MINIMUM_PARTS):
        sums.add(renderer.render(engine, PART, 1000 + sums.parts)[0])
        print(f"{renderer.animation.name:18} reference {engine}: {sums.parts * PART} spp", flush=True)
    return sums.reference()


def vectors(renderer: AnimationRenderer) -> np.ndarray | None:
    """Returns the pass Vector (frames, height, width, 4), or None with motion blur, where a pixel shows points of
    different motion.
    """
    if renderer.variant.shutter > 0.0:
        return None
    file = file_of(renderer, "vectors")
    if not file.exists():
        _store(file, vectors=renderer.vectors(VECTOR_SAMPLES).astype(np.float32))
    return np.load(file)["vectors"].astype(np.float64)


def file_of(renderer: AnimationRenderer, what: str) -> Path:
    """Returns the file that caches something, named by all that it depends on except the commit."""
    animation, variant = renderer.animation, renderer.variant
    content = hashlib.sha256(animation.scene.path.read_bytes()).hexdigest()[:12]
    first, last = animation.frames
    blur = f"-shutter-{variant.shutter:g}" if variant.shutter > 0.0 else ""
    width, height = variant.size
    return CACHE / f"animation-{animation.name}-{content}-{first}-{last}-{width}x{height}{blur}-{what}.npz"


def _store(file: Path, **arrays: np.ndarray | float | int) -> None:
    """Writes a file that gets its name only when it is complete."""
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_suffix(".unfinished.npz")
    np.savez(unfinished, **arrays)
    unfinished.rename(file)
