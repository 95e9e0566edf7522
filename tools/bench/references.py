"""Converged images of stills: each engine's own by plain path tracing, with the variance of their mean, cached in the
user's cache folder.

Parts are stored one by one, so that a reference can be continued. The runs of the benchmark never use seeds from
1000 on.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import hosts
import numpy as np
import paths
from modes import MITSUBA, MODES
from renderers import Renderers
from scenes import Scene

CACHE = paths.CACHE / "references"
PARTS = 8  # independent renders: their mean is the reference, and their spread is its variance


def reference(
    renderers: Renderers, scene: Scene, engine: str, size: tuple[int, int], samples: int, version: str
) -> tuple[np.ndarray, np.ndarray]:
    """Returns the mean and the variance of the mean; `engine` is a mode of plain path tracing."""
    content = hashlib.sha256(scene.path.read_bytes()).hexdigest()[:12]
    key = f"{scene.name}-{content}-{size[0]}x{size[1]}-{samples}-{engine_key(engine, version)}"
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
    unfinished = path.with_suffix(".whole.npz")
    np.savez_compressed(unfinished, mean=mean.astype(np.float32), variance=variance.astype(np.float32))
    unfinished.rename(path)
    for file in files:
        file.unlink()
    return mean, variance


def engine_key(engine: str, version: str = "") -> str:
    """Returns what a cached reference depends on besides scene, size and samples: engine, its version, and the Blender
    that it runs in.
    """
    if MODES[engine].engine == MITSUBA:
        return engine
    return "-".join(filter(None, (engine, version if engine == "path" else "", f"blender{hosts.peer()}")))


def _store(file: Path, image: np.ndarray) -> None:
    """Writes a file that gets its name only when it is complete."""
    unfinished = file.with_suffix(".unfinished.npy")
    np.save(unfinished, image)
    unfinished.rename(file)
