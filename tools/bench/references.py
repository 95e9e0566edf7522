"""Converged images: each engine's own by plain path tracing, with the variance of their mean, cached in the user's cache folder.

Parts are stored as they come, so that an interrupted reference goes on. Seeds 1000 and up are never used by the runs.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numpy as np
from renderers import Renderers
from scenes import Scene

CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "gradus" / "references"
PARTS = 8  # independent renders whose mean is the reference and whose spread is its variance


def reference(
    renderers: Renderers, scene: Scene, engine: str, size: tuple[int, int], samples: int, version: str
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and variance of the mean; `engine` is a mode of plain path tracing."""
    content = hashlib.sha256(scene.path.read_bytes()).hexdigest()[:12]
    key = f"{scene.name}-{content}-{engine}-{size[0]}x{size[1]}-{samples}-{version if engine == 'path' else engine}"
    path = CACHE / f"{key}.npz"
    if path.exists():
        stored = np.load(path)
        return stored["mean"], stored["variance"]
    CACHE.mkdir(parents=True, exist_ok=True)
    files = [path.with_suffix(f".part{i}.npy") for i in range(PARTS)]
    for i, file in enumerate(files):
        if not file.exists():
            _store(file, renderers.render(engine, samples // PARTS, 1000 + i)[0].astype(np.float32))
    parts = np.stack([np.load(file).astype(np.float64) for file in files])
    mean, variance = parts.mean(axis=0), parts.var(axis=0, ddof=1) / PARTS
    whole = path.with_suffix(".whole.npz")
    np.savez_compressed(whole, mean=mean.astype(np.float32), variance=variance.astype(np.float32))
    whole.rename(path)
    for file in files:
        file.unlink()
    return mean, variance


def _store(file: Path, image: np.ndarray) -> None:
    """Under its name only when it is complete."""
    unfinished = file.with_suffix(".unfinished.npy")
    np.save(unfinished, image)
    unfinished.rename(file)
