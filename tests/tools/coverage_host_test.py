"""A crash or a hang of Blender costs one row of the coverage table, and a run resumes where another one stopped."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from coverage import host, reasons  # noqa: E402

WORKER = """
import json, os, pathlib, sys, time
done = pathlib.Path(sys.argv[-1]).read_text().split()
print("noise of a library", flush=True)
for name in ("first", "crashing", "hanging", "last"):
    if name not in done:
        print("RESULT " + json.dumps({"begin": name, "family": "Rows"}), flush=True)
        if name == "crashing":
            os.abort()
        if name == "hanging":
            time.sleep(60)
        print("RESULT " + json.dumps({"family": "Rows", "name": name, "verdict": "agrees", "note": ""}), flush=True)
print("RESULT " + json.dumps({"end": True}), flush=True)
"""


@pytest.fixture
def worker(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Replaces Blender by a worker that crashes in one row and hangs in another."""
    script = tmp_path / "worker.py"
    script.write_text(WORKER)
    monkeypatch.setattr(host, "command_of", lambda _host, _script: [sys.executable, str(script)])
    monkeypatch.setattr(host, "LIMIT", 1.0)
    return script


def verdicts(done: set[str], folder: Path) -> dict[str, Any]:
    return {row["name"]: row["verdict"] for row in host.outcomes("bpy45", "*", done, folder / "log")}


def test_a_crash_or_a_hang_costs_one_row(worker: Path, tmp_path: Path) -> None:
    expected = {"first": "agrees", "crashing": "fails", "hanging": "fails", "last": "agrees"}
    assert verdicts(set(), tmp_path) == expected


def test_rows_that_are_done_are_left_out(worker: Path, tmp_path: Path) -> None:
    assert verdicts({"first", "crashing", "hanging"}, tmp_path) == {"last": "agrees"}


def test_a_worker_that_does_not_start_is_an_error(worker: Path, tmp_path: Path) -> None:
    worker.write_text("raise SystemExit(1)")
    with pytest.raises(RuntimeError, match="before its first row"):
        verdicts(set(), tmp_path)


def test_reasons_are_told_for_differences_only() -> None:
    row = {"name": "Scene.cycles.use_fast_gi=on", "verdict": "differs", "note": "all blocks"}
    assert reasons.explained(row)["note"].startswith("all blocks: Gradus has no")
    assert reasons.explained(row | {"verdict": "agrees"})["note"] == "all blocks"
