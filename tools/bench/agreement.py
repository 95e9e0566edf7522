"""A9: agreement with Cycles. Renders scenes with plain path tracing and with Cycles and compares 8x8 block means.

    agreement.py [--scenes a,b] [--samples 1024] [--width 160]

A block agrees when its means differ by at most 2 %, or by less than the noise of both (3 standard errors, from independent parts). A scene
agrees when 95 % of its blocks do. Pictures of the difference go to out/agreement/. Exit code 1 if a scene that should agree does not.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
from bench import Worker
from scenes import ROOT, Scene, select

BLOCK = 8
PARTS = 8
TOLERANCE = 0.02
SHARE = 0.95

# Scenes that are known to differ, each with its reason.
NAMED_DIFFERENCES: dict[str, str] = {}


def blocks(image: np.ndarray) -> np.ndarray:
    height, width = (s - s % BLOCK for s in image.shape[:2])
    cut = image[:height, :width]
    return cut.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def block_means(worker: Worker, mode: str, samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean image, block means and their variance."""
    parts = [worker.render(mode, samples // PARTS, 2000 + i)[0] for i in range(PARTS)]
    of_blocks = np.stack([blocks(p) for p in parts])
    return np.mean(parts, axis=0), of_blocks.mean(axis=0), of_blocks.var(axis=0, ddof=1) / PARTS


def compare(scene: Scene, width: int, samples: int) -> float:
    """Share of blocks that agree."""
    worker = Worker(scene, width, width * 9 // 16)
    try:
        ours, a, variance_a = block_means(worker, "path", samples)
        theirs, b, variance_b = block_means(worker, "cycles", samples)
    finally:
        worker.close()
    scale = np.maximum(b.mean(axis=2, keepdims=True), 1e-3)  # of the block's gray, so that dark channels do not decide
    difference = np.abs(a - b)
    good = (difference <= TOLERANCE * scale) | (difference <= 3.0 * np.sqrt(variance_a + variance_b))
    share = float(good.all(axis=2).mean())
    ratio = float(a.mean() / max(b.mean(), 1e-9))
    print(f"{scene.name:18} blocks that agree {100 * share:5.1f} %   mean ratio {ratio:.4f}", flush=True)
    save_strip(scene.name, ours, theirs)
    return share


def save_strip(name: str, ours: np.ndarray, theirs: np.ndarray) -> None:
    import matplotlib.image

    folder = ROOT / "out" / "agreement"
    folder.mkdir(parents=True, exist_ok=True)
    scale = 0.5 / max(float(np.median(theirs)), 1e-4)
    signed = 0.5 + 4.0 * scale * (ours - theirs)
    strip = np.concatenate([(np.clip(scale * x, 0, 1)) ** (1 / 2.2) for x in (ours, theirs)] + [np.clip(signed, 0, 1)], axis=1)
    matplotlib.image.imsave(folder / f"{name}.png", strip)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--width", type=int, default=160)
    arguments = parser.parse_args()
    failed = []
    for scene in select(arguments.scenes):
        try:
            agrees = compare(scene, arguments.width, arguments.samples) >= SHARE
        except RuntimeError as error:
            print(f"FAILED {scene.name}: {error}")
            agrees = False
        if not agrees:
            print(f"  {scene.name}: {NAMED_DIFFERENCES.get(scene.name, 'differs without a named reason')}")
            if scene.name not in NAMED_DIFFERENCES:
                failed.append(scene.name)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
