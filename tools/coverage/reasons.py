"""Known reasons of differences, which are written beside what was measured."""

from __future__ import annotations

from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

import tomllib

FILE = Path(__file__).resolve().parent / "reasons.toml"


@cache
def known() -> list[dict[str, str]]:
    return tomllib.loads(FILE.read_text())["reason"]


def explained(outcome: dict[str, Any]) -> dict[str, Any]:
    """Returns an outcome with the reason of its difference, if one is known."""
    if outcome["verdict"] != "differs":
        return outcome
    for reason in known():
        if fnmatchcase(outcome["name"], reason["rows"]):
            return outcome | {"note": f"{outcome['note']}: {reason['text']}"}
    return outcome
