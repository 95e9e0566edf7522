"""What runs are compared with, cached in the user's cache folder: converged frames of each engine, and the level.

Converged frames are two halves by plain path tracing, each of as many parts with seeds of their own: products of errors
against both halves need no estimate of the reference's noise. Sums are stored after each part, so that an interrupted
reference goes on, and one of more samples reuses what is there. The level is what squared errors are divided by: a
smooth picture of every frame, the same for all engines. The runs of the benchmark never use seeds from 1000 on. The
cache does not depend on the commit, because tests check what path tracing converges to; after a change that is meant
to change pictures, remove its files.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from animation_renderer import AnimationRenderer
from references import CACHE, engine_key

PART = 32  # samples per pixel
LEVEL, LEVEL_SAMPLES, LEVEL_SEED = "path-regularized", 8, 3000


@dataclass
class Reference:
    """Converged frames (frames, height, width, 3) from two independent halves."""

    halves: tuple[np.ndarray, np.ndarray]
    samples: int

    @property
    def mean(self) -> np.ndarray:
        return 0.5 * (self.halves[0] + self.halves[1])

    @property
    def variance(self) -> np.ndarray:
        """Returns an unbiased estimate of the variance of the mean, from two halves alone."""
        return 0.25 * (self.halves[0] - self.halves[1]) ** 2


@dataclass
class _Sums:
    """Sums of the parts of both halves that were rendered so far, and the file that stores them."""

    file: Path
    parts: int = 0
    sums: list[np.ndarray] = field(default_factory=lambda: [np.zeros(1), np.zeros(1)])

    def load(self) -> None:
        if self.file.exists():
            stored = np.load(self.file)
            self.parts, self.sums = int(stored["parts"]), [stored["first"], stored["second"]]

    def add(self, images: np.ndarray) -> None:
        half = self.parts % 2
        self.sums[half] = self.sums[half] + images
        self.parts += 1
        _store(self.file, parts=self.parts, first=self.sums[0], second=self.sums[1])

    def reference(self) -> Reference:
        return Reference((2 * self.sums[0] / self.parts, 2 * self.sums[1] / self.parts), self.parts * PART)


def reference(
    renderer: AnimationRenderer, engine: str, samples: int, frames: tuple[int, int] | None = None
) -> Reference:
    """Returns converged frames of at least so many samples; `engine` is a mode of plain path tracing."""
    frames = frames or renderer.animation.frames
    sums = _Sums(file_of(renderer, f"halves-{engine_key(engine)}", frames))
    sums.load()
    while sums.parts % 2 or sums.parts * PART < max(samples, 2 * PART):
        sums.add(renderer.render(engine, PART, 1000 + sums.parts, frames=frames)[0])
        print(f"{renderer.animation.name:18} reference {engine}: {sums.parts * PART} spp", flush=True)
    return sums.reference()


def level(renderer: AnimationRenderer) -> np.ndarray:
    """Returns the gray of all frames (frames, height, width), smooth and nearly right."""
    file = file_of(renderer, "level")
    if not file.exists():
        images = renderer.render(LEVEL, LEVEL_SAMPLES, LEVEL_SEED)[0]
        _store(file, level=images.mean(axis=-1).astype(np.float32))
    return np.load(file)["level"].astype(np.float64)


def file_of(renderer: AnimationRenderer, what: str, frames: tuple[int, int] | None = None) -> Path:
    """Returns the file that caches something, named by all that it depends on except the commit."""
    animation, variant = renderer.animation, renderer.variant
    content = hashlib.sha256(animation.scene.path.read_bytes()).hexdigest()[:12]
    first, last = frames or animation.frames
    blur = f"-shutter-{variant.shutter:g}" if variant.shutter > 0.0 else ""
    width, height = variant.size
    return CACHE / f"animation-{animation.name}-{content}-{first}-{last}-{width}x{height}{blur}-{what}.npz"


def _store(file: Path, **arrays: np.ndarray | float | int) -> None:
    """Writes a file that gets its name only when it is complete."""
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_suffix(".unfinished.npz")
    np.savez(unfinished, **arrays)
    unfinished.rename(file)
