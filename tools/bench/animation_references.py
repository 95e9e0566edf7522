"""Converged frames: each engine's own by plain path tracing, with the variance of their mean, cached in the user's cache folder.

Every part is a rendering of the whole range with a seed of its own; the sums are stored after each, so that an interrupted reference goes
on, and one of more samples takes over what is there. Seeds 1000 and up are never used by the runs. The cache outlives versions: what path
tracing converges to is held by tests; remove the files where it was changed on purpose.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from animation_renderer import AnimationRenderer
from references import CACHE

PART = 64  # samples per pixel
LEAST_PARTS = 4  # for a variance
VECTOR_SAMPLES = 16
STORED_AS = {"path": "path-limits-of-file"}  # what is stored as "path" has the bounce limits of Gradus, not those of the file


@dataclass
class Reference:
    """Mean and variance of the mean (frames, height, width, 3)."""

    mean: np.ndarray
    variance: np.ndarray
    samples: int


@dataclass
class _Sums:
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
    """`engine` is a mode of plain path tracing."""
    sums = _Sums(file_of(renderer, engine))
    sums.load()
    while sums.parts < max(samples // PART, LEAST_PARTS):
        sums.add(renderer.render(engine, PART, 1000 + sums.parts)[0])
        print(f"{renderer.animation.name:18} reference {engine}: {sums.parts * PART} spp", flush=True)
    return sums.reference()


def vectors(renderer: AnimationRenderer) -> np.ndarray | None:
    """Pass Vector of Gradus (frames, height, width, 4). None with motion blur, where a pixel shows points of different motion."""
    if renderer.variant.shutter > 0.0:
        return None
    file = file_of(renderer, "vectors")
    if not file.exists():
        _store(file, vectors=renderer.vectors(VECTOR_SAMPLES).astype(np.float32))
    return np.load(file)["vectors"].astype(np.float64)


def file_of(renderer: AnimationRenderer, what: str) -> Path:
    """Where it is cached, by all that it depends on but the version."""
    animation, variant = renderer.animation, renderer.variant
    content = hashlib.sha256(animation.scene.path.read_bytes()).hexdigest()[:12]
    first, last = animation.frames
    blur = f"-shutter-{variant.shutter:g}" if variant.shutter > 0.0 else ""
    return (
        CACHE
        / f"animation-{animation.name}-{content}-{first}-{last}-{STORED_AS.get(what, what)}-{variant.size[0]}x{variant.size[1]}{blur}.npz"
    )


def _store(file: Path, **arrays: np.ndarray | float | int) -> None:
    """Under its name only when it is complete."""
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_suffix(".unfinished.npz")
    np.savez(unfinished, **arrays)
    unfinished.rename(file)
