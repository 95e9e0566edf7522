"""Makes docs/benchmark/README.md and its figures from docs/benchmark/results.jsonl (newest version of each scene and mode)."""

from __future__ import annotations

import json
from collections import defaultdict

import matplotlib
import matplotlib.image
import numpy as np
from metrics import equal_time_ratio, slope
from scenes import ROOT, SCENES
from table import header, number

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FOLDER = ROOT / "docs" / "benchmark"
PICTURES = ROOT / "out" / "bench"
NAMES = {
    "path": "Gradus PT",
    "gradient-l2": "Gradus G-PT + L2",
    "gradient-l1": "Gradus G-PT + L1",
    "cycles": "Cycles",
    "cycles-denoised": "Cycles + denoiser",
    "cycles-default": "Cycles, its defaults",
}
STRIP = ("path", "gradient-l2", "gradient-l1", "cycles", "cycles-denoised", "reference")
STRIP_SAMPLES = 16


def load() -> dict[str, dict[str, dict[int, list[dict]]]]:
    """scene -> mode -> samples -> rows of the newest version that has that scene and mode; the modes of the speed runs end in "@4"."""
    rows = [json.loads(line) for line in (FOLDER / "results.jsonl").read_text().splitlines()]
    newest: dict[tuple[str, str], tuple] = {(r["scene"], mode_of(r)): (r["version"], r["width"]) for r in rows}  # in order of time
    table: dict = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for row in rows:
        if newest[row["scene"], mode_of(row)] == (row["version"], row["width"]):
            table[row["scene"]][mode_of(row)][row["samples"]].append(row)
    return table


def mode_of(row: dict) -> str:
    return f"{row['mode']}@{row['bounces']}" if "bounces" in row else row["mode"]


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


def ratio(modes: dict, a: str, b: str) -> float | None:
    return equal_time_ratio(curve(modes[a]), curve(modes[b])) if a in modes and b in modes else None


def strip(scene: str) -> str | None:
    """One row of pictures at equal samples, each engine beside its peers; None where the pictures are not here."""
    files = [PICTURES / f"{scene}-{mode}.npy" for mode in (m if m == "reference" else f"{m}-{STRIP_SAMPLES}" for m in STRIP)]
    if not all(f.exists() for f in files):
        return None
    images = [np.load(f) for f in files]
    white = float(np.percentile(images[-1], 98.0))
    shown = [np.clip(image / max(white, 1e-6), 0.0, 1.0) ** (1.0 / 2.2) for image in images]
    gap = np.ones((shown[0].shape[0], 2, 3))
    row = np.concatenate([part for image in shown for part in (image, gap)][:-1], axis=1)
    name = f"{scene}-strip.png"
    matplotlib.image.imsave(FOLDER / name, row)
    return name


def summary(table: dict, order: list[str]) -> list[str]:
    text = ["## Error at equal CPU time", ""] + header("scene", "R of L2", "R of L1", "R of Cycles", "slope PT", "slope L2")
    for scene in order:
        modes = table[scene]
        slopes = [number(slope(curve(modes[m])) if m in modes else None) for m in ("path", "gradient-l2")]
        ratios = [number(ratio(modes, m, "path")) for m in ("gradient-l2", "gradient-l1", "cycles")]
        text.append(f"| {scene} | {' | '.join(ratios + slopes)} |")
    return text


def speed(table: dict, order: list[str]) -> list[str]:
    text = ["", "## CPU time of a sample with four bounces", ""]
    text += header("scene", "PT, µs", "Cycles, µs", "PT / Cycles", "gradients: G-PT / PT")
    for scene in order:
        path, gradient, cycles = (sample_cost(table[scene][f"{m}@4"]) for m in ("path", "gradient-none", "cycles"))
        against_cycles = path / cycles if path and cycles else None
        overhead = gradient / path if gradient and path else None
        text.append(f"| {scene} | {number(path)} | {number(cycles)} | {number(against_cycles)} | {number(overhead)} |")
    return text


def details(scene: str, modes: dict) -> list[str]:
    text = ["", f"## {scene}", "", conditions(modes), "", f"![error against CPU time]({plot(scene, modes)})", ""]
    if picture := strip(scene):
        text += [f"![{', '.join(NAMES.get(m, m) for m in STRIP)}]({picture})", ""]
        text += [f"*{STRIP_SAMPLES} samples, from left to right: {', '.join(NAMES.get(m, m) for m in STRIP)}.*", ""]
    text += header("mode", "spp", "seeds", "CPU-s", "wall s", "relMSE", "lowest–highest", "relMSE-t", "SMAPE")
    for mode in NAMES:
        for samples, rows in sorted(modes.get(mode, {}).items()):
            errors = [r["relmse"] for r in rows]
            median = {k: float(np.median([r[k] for r in rows])) for k in ("cpu", "wall", "relmse", "relmse_trimmed", "smape")}
            text.append(
                f"| {NAMES[mode]} | {samples} | {len(rows)} | {median['cpu']:.2f} | {median['wall']:.2f} | {median['relmse']:.5f} "
                f"| {min(errors):.5f}–{max(errors):.5f} | {median['relmse_trimmed']:.5f} | {median['smape']:.4f} |"
            )
    return text


def conditions(modes: dict) -> str:
    """Pixels, reference and version of a scene's runs."""
    rows = [row for counts in modes.values() for runs in counts.values() for row in runs]
    sizes = sorted({f"{row['width']}×{row['height']}" for row in rows})
    references = sorted({row["reference_samples"] for row in rows if "reference_samples" in row})
    versions = sorted({row["version"] for row in rows})
    return f"{', '.join(sizes)} pixels; references of {', '.join(map(str, references))} samples; version {', '.join(versions)}."


def agreement() -> list[str]:
    """What agreement.py measured, if it was run."""
    file = FOLDER / "agreement.json"
    if not file.exists():
        return []
    text = ["", "## Agreement with Cycles (A9)", ""] + header("scene", "blocks that agree", "ratio of means", "named difference")
    for name, row in json.loads(file.read_text()).items():
        text.append(f"| {name} | {100 * row['share']:.1f} % | {row['ratio']:.4f} | {row['reason']} |")
    return text


def main() -> None:
    table = load()
    order = [s.name for s in SCENES if s.name in table]
    text = [(FOLDER / "preface.md").read_text().rstrip(), ""] + summary(table, order) + speed(table, order) + agreement()
    for scene in order:
        text += details(scene, table[scene])
    (FOLDER / "README.md").write_text("\n".join(text) + "\n")
    print(FOLDER / "README.md")


if __name__ == "__main__":
    main()
