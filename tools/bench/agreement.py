"""A9: agreement with Cycles. Compares 8x8 block means of the converged images of plain path tracing and of Cycles.

    agreement.py [--scenes a,b] [--samples 1024] [--width 160]

The images are the benchmark's references (bench.py), with their variances. A block agrees when its means differ by at most 2 %, or by less
than the noise of both (3 standard errors; pixels are independent). A scene agrees when 95 % of its blocks do. The figures go to
docs/benchmark/agreement.json, pictures of the difference to out/agreement/. Exit code 1 if a scene differs without a named reason.
"""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np
from bench import Worker, reference
from scenes import ROOT, Scene, select
from version import version_of_build

BLOCK = 8
TOLERANCE = 0.02
SHARE = 0.95
RESULTS = ROOT / "docs" / "benchmark" / "agreement.json"

# Scenes that are known to differ, each with its reason.
NAMED_DIFFERENCES: dict[str, str] = {
    "breakfast-room": "floor and walls have faces in one plane: in Cycles the sky shines through between them, in three patches on the "
    "floor, which are gone when the floor is lifted by 2 mm",
    "bathroom": "inner and outer faces of the wash basin lie in one plane: Cycles loses light between them (the basin alone, white in a "
    "white world, shows 0.96 in place of 1; here 1.00)",
    "moving-light": "the walls are double, in one plane: black in Cycles, where each layer shades the other; lit here",
}


def blocks(image: np.ndarray) -> np.ndarray:
    height, width = (s - s % BLOCK for s in image.shape[:2])
    cut = image[:height, :width]
    return cut.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def compare(scene: Scene, width: int, samples: int) -> tuple[float, float]:
    """Share of blocks that agree, and the ratio of the means."""
    size = (width, width * 9 // 16)
    worker = Worker(scene, *size)
    try:
        version = version_of_build()
        ours, variance_ours = reference(worker, scene, "path", size, samples, version)
        theirs, variance_theirs = reference(worker, scene, "cycles", size, samples, version)
    finally:
        worker.close()
    a, b = blocks(ours), blocks(theirs)
    variance = blocks(variance_ours + variance_theirs) / BLOCK**2
    scale = np.maximum(b.mean(axis=2, keepdims=True), 1e-3)  # of the block's gray, so that dark channels do not decide
    difference = np.abs(a - b)
    good = (difference <= TOLERANCE * scale) | (difference <= 3.0 * np.sqrt(variance))
    share = float(good.all(axis=2).mean())
    ratio = float(a.mean() / max(b.mean(), 1e-9))
    print(f"{scene.name:18} blocks that agree {100 * share:5.1f} %   mean ratio {ratio:.4f}", flush=True)
    save_strip(scene.name, ours, theirs)
    return share, ratio


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
            share, ratio = compare(scene, arguments.width, arguments.samples)
        except RuntimeError as error:
            print(f"FAILED {scene.name}: {error}")
            failed.append(scene.name)
            continue
        reason = "" if share >= SHARE else NAMED_DIFFERENCES.get(scene.name, "")
        if share < SHARE and not reason:
            print(f"  {scene.name}: differs without a named reason")
            failed.append(scene.name)
        store(scene.name, {"share": round(share, 4), "ratio": round(ratio, 4), "reason": reason, "samples": arguments.samples})
    sys.exit(1 if failed else 0)


def store(name: str, row: dict) -> None:
    rows = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    rows[name] = row
    RESULTS.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
