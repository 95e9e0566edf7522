"""Raw results: files of JSON lines in `out/bench/results`.

Every run appends one line, so that an interrupted benchmark can go on.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from paths import RESULTS

Row = dict[str, Any]


def file_of(part: str) -> Path:
    """Returns the file of one part of the benchmark."""
    return RESULTS / f"{part}.jsonl"


def read(file: Path) -> list[Row]:
    """Returns all rows in the order in which they were measured, or none if the file does not exist."""
    return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []


def like_last(rows: list[Row], setup: tuple[str, ...]) -> list[Row]:
    """Returns the rows that agree with the last one in the columns `setup`."""
    return [row for row in rows if all(row[name] == rows[-1][name] for name in setup)]


def newest(rows: list[Row], setup: tuple[str, ...]) -> list[Row]:
    """Returns the last row of each scene, of those that agree with the last row of all in the columns `setup`."""
    return list({row["scene"]: row for row in like_last(rows, setup)}.values())


def append(row: Row, file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a") as opened:
        opened.write(json.dumps(shortened(row), separators=(",", ":")) + "\n")


def shortened(value: Any) -> Any:
    """Rounds all floats to six significant digits, which is more than any run repeats."""
    if isinstance(value, dict):
        return {key: shortened(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [shortened(item) for item in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value
