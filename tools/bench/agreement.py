"""A9: agreement with Cycles, and with Mitsuba where it loads the scene: 8x8 block means of the converged images of plain path tracing.

    agreement.py [--scenes a,b] [--samples 4096] [--width 320]

The images are the benchmark's references (references.py), with their variances. A block agrees when its means differ by at most 2 %, or by
less than the noise of both (3 standard errors; pixels are independent). A scene agrees when 95 % of its blocks do. The figures go to
docs/benchmark/agreement.json, pictures of the difference to out/agreement/. Exit code 1 if a scene differs without a named reason.
"""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np
from modes import MODES
from references import reference
from renderers import RefusedError, Renderers
from scenes import ROOT, Scene, select
from version import version_of_build

BLOCK = 8
TOLERANCE = 0.02
SHARE = 0.95
PEERS = ("cycles", "mitsuba")
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


def share_and_ratio(ours: tuple[np.ndarray, np.ndarray], theirs: tuple[np.ndarray, np.ndarray]) -> tuple[float, float]:
    """Share of blocks that agree, and the ratio of the means; each side is an image and the variance of its pixels."""
    a, b = blocks(ours[0]), blocks(theirs[0])
    variance = blocks(ours[1] + theirs[1]) / BLOCK**2
    scale = np.maximum(b.mean(axis=2, keepdims=True), 1e-3)  # of the block's gray, so that dark channels do not decide
    difference = np.abs(a - b)
    good = (difference <= TOLERANCE * scale) | (difference <= 3.0 * np.sqrt(variance))
    return float(good.all(axis=2).mean()), float(a.mean() / max(b.mean(), 1e-9))


def compare(name: str, ours: tuple[np.ndarray, np.ndarray], theirs: tuple[np.ndarray, np.ndarray]) -> tuple[float, float]:
    share, ratio = share_and_ratio(ours, theirs)
    print(f"{name:28} blocks that agree {100 * share:5.1f} %   mean ratio {ratio:.4f}", flush=True)
    save_strip(name, ours[0], theirs[0])
    return share, ratio


def compare_scene(scene: Scene, width: int, samples: int) -> list[str]:
    """Stores what was found for each peer that loads the scene; returns those that differ without a named reason."""
    size, version = (width, width * 9 // 16), version_of_build()
    renderers = Renderers(scene, size)
    failed = []
    try:
        ours = reference(renderers, scene, "path", size, samples, version)
        for peer in PEERS:
            name = scene.name if peer == "cycles" else f"{scene.name}, {MODES[peer].label}"
            try:
                theirs = reference(renderers, scene, peer, size, samples, version)
            except RefusedError as error:
                print(f"SKIP {name}: {error}")
                continue
            share, ratio = compare(name, ours, theirs)
            reason = "" if share >= SHARE else NAMED_DIFFERENCES.get(name, "")
            if share < SHARE and not reason:
                print(f"  {name}: differs without a named reason")
                failed.append(name)
            store(name, {"share": round(share, 4), "ratio": round(ratio, 4), "reason": reason, "samples": samples})
    finally:
        renderers.close()
    return failed


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
    parser.add_argument("--samples", type=int, default=4096)
    parser.add_argument("--width", type=int, default=320)
    arguments = parser.parse_args()
    failed = []
    for scene in select(arguments.scenes):
        try:
            failed += compare_scene(scene, arguments.width, arguments.samples)
        except RuntimeError as error:
            print(f"FAILED {scene.name}: {error}")
            failed.append(scene.name)
    sys.exit(1 if failed else 0)


def store(name: str, row: dict) -> None:
    rows = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    rows[name] = row
    RESULTS.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
