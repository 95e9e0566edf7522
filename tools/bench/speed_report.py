"""The table of speed.py's results: CPU time per sample, ratios with their range over the repeats, rays, memory."""

from __future__ import annotations

from speed import Cost, costs, load
from table import header, number

PATH, GRADIENT, CYCLES, CYCLES_34 = ("path", "4.5"), ("gradient-none", "4.5"), ("cycles", "4.5"), ("cycles", "3.4")


def spread(ratio: tuple[float, float, float] | None) -> str:
    return "–" if ratio is None else f"{ratio[0]:.2f} ({ratio[1]:.2f}–{ratio[2]:.2f})"


def table() -> list[str]:
    rows = load()
    facts = {row["room"]: row for row in rows}
    text = header("triangles", "PT, µs", "Cycles 4.5", "Cycles 3.4", "PT / Cycles 4.5", "PT / Cycles 3.4", "G-PT / PT", "repeats")
    for room, modes in sorted(costs(rows).items(), key=lambda item: facts[item[0]]["triangles"]):
        path, gradient, cycles, old = (modes.get(key, Cost()) for key in (PATH, GRADIENT, CYCLES, CYCLES_34))
        cells = [number(cost.median()) for cost in (path, cycles, old)]
        cells += [spread(path.over(cycles)), spread(path.over(old)), spread(gradient.over(path)), str(len(path.per_sample))]
        text.append(f"| {facts[room]['triangles']:,} | {' | '.join(cells)} |")
    text += ["", *header("triangles", "mode", "camera rays", "bounce", "shadow", "shift", "shift shadow", "peak memory, MB")]
    for room, modes in sorted(costs(rows).items(), key=lambda item: facts[item[0]]["triangles"]):
        for (mode, host), cost in modes.items():
            rays = [number(cost.rays.get(kind)) for kind in ("primary", "bounce", "shadow", "shift", "shift_shadow")]
            text.append(
                f"| {facts[room]['triangles']:,} | {mode}, Blender {host} | {' | '.join(rays)} | {cost.peak_memory_bytes / 1e6:.0f} |"
            )
    return text


if __name__ == "__main__":
    print("\n".join(table()))
