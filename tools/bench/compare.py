"""Compares two commits whose stills were measured: error of a mode over that of path tracing at equal samples, and rays
of a sample.

    compare.py OLD NEW [--modes gradient-l2,gradient-regularized] [--width 160]

This judges a change that has no switch: commit it, run `make bench-errors`, compare. Figures in brackets leave out the
worst 0.1 % of the pixels.
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np
import records
from results import STILLS

MEASURES = ("relmse", "relmse_trimmed")
Rows = dict[tuple[str, str, int], list[records.Row]]  # by scene, mode and samples


def rows_of(version: str, width: int) -> Rows:
    found: Rows = defaultdict(list)
    for row in records.read(STILLS):
        if (row["version"], row["width"]) == (version, width) and "bounces" not in row:
            found[row["scene"], row["mode"], row["samples"]].append(row)
    return found


def errors(rows: Rows, scene: str, mode: str, samples: int) -> np.ndarray:
    """Returns, for each measure, the mean error of a mode over that of path tracing, over the seeds that both have."""
    both = [{row["seed"]: row for row in rows[scene, name, samples]} for name in (mode, "path")]
    seeds = both[0].keys() & both[1].keys()
    means = [[np.mean([found[seed][measure] for seed in seeds]) for measure in MEASURES] for found in both]
    return np.array(means[0]) / np.array(means[1])


def rays(rows: Rows, scene: str, mode: str, samples: int) -> float:
    """Returns the rays of a sample."""
    counts = next((row["rays"] for row in rows[scene, mode, samples] if "rays" in row), None)
    return sum(counts.values()) / counts["primary"] if counts else np.nan


def table(old: Rows, new: Rows, mode: str) -> None:
    keys = sorted(key for key in old.keys() & new.keys() if key[1] == mode)
    print(f"\n| {mode} | samples | old | new | rays |\n|---|---|---|---|---|")
    changes = []
    for key in keys:
        pair = [errors(rows, *key) for rows in (old, new)]
        cost = [rays(rows, *key) for rows in (old, new)]
        changes.append(np.log([*(pair[1] / pair[0]), cost[1] / cost[0]]))
        cells = [f"{e:.3f} ({t:.3f})" for e, t in pair]
        print(f"| {key[0]} | {key[2]} | {cells[0]} | {cells[1]} | {cost[0]:.2f}, {cost[1]:.2f} |")
    if changes:
        error, trimmed, cost = np.exp(np.mean(changes, axis=0))
        print(f"| new over old, geometric mean | | | {error:.3f} ({trimmed:.3f}) | {cost:.3f} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--modes", default="gradient-l2,gradient-regularized")
    parser.add_argument("--width", type=int, default=160)
    arguments = parser.parse_args()
    old, new = (rows_of(version, arguments.width) for version in (arguments.old, arguments.new))
    for mode in arguments.modes.split(","):
        table(old, new, mode)


if __name__ == "__main__":
    main()
