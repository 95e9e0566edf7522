"""What Blender's side costs in each Blender: export and upload. Runs host_worker.py in each and writes docs/benchmark/host.md."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

from scenes import ROOT
from version import cpu_name

WORKER = str(Path(__file__).with_name("host_worker.py"))
HOSTS = (
    [os.environ.get("BLENDER") or "blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3", "--python", WORKER],
    [str(ROOT / ".venv/bpy45/bin/python3"), WORKER],
    [str(ROOT / ".venv/bpy50/bin/python3"), WORKER],
)
PREFACE = """# Export and upload

Made by `make bench-host` ({cpu}). Wall time, median of {count} (lowest–highest). Export: a mesh of a million triangles into a new
native scene; the aim is 1 s. Upload: one RGBA pass of 1920×1080 into a new render result, whose memory Blender touches for the first time
then, and once more into the same, as when the picture grows; the aim is 20 ms.

| Blender | export, s | upload, ms | again, ms |
|---|---|---|---|
"""


def measure(command: list[str]) -> dict:
    process = subprocess.run(command, capture_output=True, text=True, timeout=300)
    for line in process.stdout.splitlines():
        if line.startswith("RESULT "):
            return json.loads(line[7:])
    raise RuntimeError(f"{command[0]} ended with code {process.returncode}:\n{process.stderr[-2000:]}")


def spread(seconds: list[float], unit: float) -> str:
    middle, low, high = (value / unit for value in (statistics.median(seconds), min(seconds), max(seconds)))
    return f"{middle:.3g} ({low:.3g}–{high:.3g})"


def main() -> None:
    results = [measure(command) for command in HOSTS]
    text = PREFACE.format(cpu=cpu_name(), count=len(results[0]["export"]))
    for r in results:
        text += f"| {r['blender']} | {spread(r['export'], 1.0)} | {spread(r['upload'], 1e-3)} | {spread(r['refresh'], 1e-3)} |\n"
    (ROOT / "docs" / "benchmark" / "host.md").write_text(text)
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
