"""Compares converged images of plain path tracing with those of Cycles and Mitsuba, block by block (catalogue A9).

    agreement.py [--scenes a,b] [--samples 4096] [--width 320]

The images are the references of the stills (references.py), with their variances. A block of 8x8 pixels agrees if its
means differ by at most 2 % or by less than the noise of both (3 standard errors; pixels are independent). A scene
agrees if 95 % of its blocks do. Results go to out/bench/results/agreement.jsonl, pictures of the difference to
out/bench/agreement/. Exit code 1: a scene differs for no known reason.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
import records
from modes import MODES
from paths import OUT
from references import reference
from renderers import RefusedError, Renderers
from scenes import Scene, select
from version import conditions, version_of_build

BLOCK = 8
TOLERANCE = 0.02
SHARE = 0.95
PEERS = ("cycles", "mitsuba")
RESULTS = records.file_of("agreement")

# Scenes that are known to differ, and why.
KNOWN_REASONS: dict[str, str] = {
    "breakfast-room": "floor and walls have faces in one plane; in Cycles light of the sky leaks between them in three "
    "places, which are gone if the floor is lifted by 2 mm",
    "bathroom": "inner and outer faces of the wash basin lie in one plane; Cycles loses light between them (the basin "
    "alone, white in a white world, shows 0.96 instead of 1; in Gradus 1.00)",
    "moving-light": "the walls are double, in one plane; in Cycles each layer shadows the other, so they are black",
}


def blocks(image: np.ndarray) -> np.ndarray:
    """Returns the means of all blocks."""
    height, width = (s - s % BLOCK for s in image.shape[:2])
    cut = image[:height, :width]
    return cut.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def share_and_ratio(ours: tuple[np.ndarray, np.ndarray], theirs: tuple[np.ndarray, np.ndarray]) -> tuple[float, float]:
    """Returns the share of blocks that agree and the ratio of the means.

    Each side is an image and the variance of its pixels.
    """
    a, b = blocks(ours[0]), blocks(theirs[0])
    variance = blocks(ours[1] + theirs[1]) / BLOCK**2
    scale = np.maximum(b.mean(axis=2, keepdims=True), 1e-3)  # gray, so that dark channels do not decide
    difference = np.abs(a - b)
    good = (difference <= TOLERANCE * scale) | (difference <= 3.0 * np.sqrt(variance))
    return float(good.all(axis=2).mean()), float(a.mean() / max(b.mean(), 1e-9))


def compare(
    name: str, ours: tuple[np.ndarray, np.ndarray], theirs: tuple[np.ndarray, np.ndarray]
) -> tuple[float, float]:
    share, ratio = share_and_ratio(ours, theirs)
    print(f"{name:28} blocks that agree {100 * share:5.1f} %   mean ratio {ratio:.4f}", flush=True)
    save_strip(name, ours[0], theirs[0])
    return share, ratio


def compare_scene(scene: Scene, width: int, samples: int) -> list[str]:
    """Compares a scene with each peer that can load it; returns the names of those that differ for no known reason."""
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
            reason = "" if share >= SHARE else KNOWN_REASONS.get(name, "")
            if share < SHARE and not reason:
                print(f"  {name}: differs for no known reason")
                failed.append(name)
            row = {
                "name": name,
                "share": round(share, 4),
                "ratio": round(ratio, 4),
                "reason": reason,
                "samples": samples,
            }
            records.append(row | conditions(version), RESULTS)
    finally:
        renderers.close()
    return failed


def save_strip(name: str, ours: np.ndarray, theirs: np.ndarray) -> None:
    """Writes both images and four times their difference, side by side."""
    import matplotlib.image

    folder = OUT / "agreement"
    folder.mkdir(parents=True, exist_ok=True)
    scale = 0.5 / max(float(np.median(theirs)), 1e-4)
    signed = 0.5 + 4.0 * scale * (ours - theirs)
    strip = np.concatenate(
        [(np.clip(scale * x, 0, 1)) ** (1 / 2.2) for x in (ours, theirs)] + [np.clip(signed, 0, 1)], axis=1
    )
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


if __name__ == "__main__":
    main()
