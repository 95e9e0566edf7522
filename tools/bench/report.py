"""Makes docs/benchmark/README.md and its figures from docs/benchmark/results.jsonl (newest version of each scene and mode)."""

from __future__ import annotations

import json
from collections import defaultdict

import matplotlib
import numpy as np
from metrics import equal_time_ratio, slope
from scenes import ROOT, SCENES

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FOLDER = ROOT / "docs" / "benchmark"
NAMES = {
    "path": "Gradus PT",
    "gradient-l2": "Gradus G-PT + L2",
    "gradient-l1": "Gradus G-PT + L1",
    "cycles": "Cycles",
    "cycles-denoised": "Cycles + denoiser",
}


def load() -> dict[str, dict[str, dict[int, list[dict]]]]:
    """scene -> mode -> samples -> rows of the newest version that has that scene and mode, largest width."""
    rows = [json.loads(line) for line in (FOLDER / "results.jsonl").read_text().splitlines()]
    newest: dict[tuple[str, str], str] = {(r["scene"], r["mode"]): r["version"] for r in rows}  # the file is in order of time
    table: dict = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for row in rows:
        if newest[row["scene"], row["mode"]] == row["version"]:
            table[row["scene"]][row["mode"]][row["samples"]].append(row)
    return table


def curve(by_samples: dict[int, list[dict]], measure: str = "relmse") -> list[tuple[float, float]]:
    """(median CPU seconds, median error) per sample count."""
    return [
        (float(np.median([r["cpu"] for r in rows])), max(float(np.median([r[measure] for r in rows])), 1e-9))
        for _, rows in sorted(by_samples.items())
    ]


def plot(scene: str, modes: dict[str, dict[int, list[dict]]]) -> str:
    figure, axes = plt.subplots(figsize=(5, 3.6))
    for mode, label in NAMES.items():
        if mode in modes:
            times, errors = zip(*curve(modes[mode]), strict=True)
            axes.loglog(times, errors, "o-", label=label)
    axes.set_xlabel("CPU seconds")
    axes.set_ylabel("relMSE")
    axes.set_title(scene)
    axes.grid(True, which="both", alpha=0.3)
    axes.legend(fontsize=7)
    figure.tight_layout()
    name = f"{scene}.png"
    figure.savefig(FOLDER / name, dpi=110, metadata={"Software": None})
    plt.close(figure)
    return name


def sample_cost(by_samples: dict[int, list[dict]]) -> float | None:
    """CPU microseconds per sample: slope between the smallest and the largest count, so that export and build drop out."""
    counts = sorted(by_samples)
    if len(counts) < 2:
        return None
    low, high = by_samples[counts[0]], by_samples[counts[-1]]
    cpu = np.median([r["cpu"] for r in high]) - np.median([r["cpu"] for r in low])
    return float(1e6 * cpu / (low[0]["width"] * low[0]["height"] * (counts[-1] - counts[0])))


def number(value: float | None, form: str = ".2f") -> str:
    return "–" if value is None else format(value, form)


def ratio(modes: dict, a: str, b: str) -> float | None:
    return equal_time_ratio(curve(modes[a]), curve(modes[b])) if a in modes and b in modes else None


def main() -> None:
    table = load()
    text = [(FOLDER / "preface.md").read_text().rstrip(), "", "## Summary", ""]
    text += ["| scene | R of L2 | R of L1 | slope PT | slope L2 | µs per sample PT | Cycles | PT/Cycles | shifts: G-PT/PT |"]
    text += ["|---|---|---|---|---|---|---|---|---|"]
    order = [s.name for s in SCENES if s.name in table]
    for scene in order:
        modes = table[scene]
        cost = {m: sample_cost(modes[m]) if m in modes else None for m in NAMES}
        against_cycles = cost["path"] / cost["cycles"] if cost["path"] and cost["cycles"] else None
        overhead = cost["gradient-l2"] / cost["path"] if cost["gradient-l2"] and cost["path"] else None
        text.append(
            f"| {scene} | {number(ratio(modes, 'gradient-l2', 'path'))} | {number(ratio(modes, 'gradient-l1', 'path'))} "
            f"| {number(slope(curve(modes['path'])) if 'path' in modes else None)} "
            f"| {number(slope(curve(modes['gradient-l2'])) if 'gradient-l2' in modes else None)} "
            f"| {number(cost['path'])} | {number(cost['cycles'])} | {number(against_cycles)} | {number(overhead)} |"
        )
    for scene in order:
        modes = table[scene]
        text += ["", f"## {scene}", "", f"![error against CPU time]({plot(scene, modes)})", ""]
        text += ["| mode | spp | seeds | CPU-s | relMSE | lowest–highest | relMSE-t | SMAPE |", "|---|---|---|---|---|---|---|---|"]
        for mode in NAMES:
            for samples, rows in sorted(modes.get(mode, {}).items()):
                errors = [r["relmse"] for r in rows]
                median = {k: float(np.median([r[k] for r in rows])) for k in ("cpu", "relmse", "relmse_trimmed", "smape")}
                text.append(
                    f"| {NAMES[mode]} | {samples} | {len(rows)} | {median['cpu']:.2f} | {median['relmse']:.5f} "
                    f"| {min(errors):.5f}–{max(errors):.5f} | {median['relmse_trimmed']:.5f} | {median['smape']:.4f} |"
                )
    (FOLDER / "README.md").write_text("\n".join(text) + "\n")
    print(FOLDER / "README.md")


if __name__ == "__main__":
    main()
