"""Tables in Markdown."""

from __future__ import annotations


def number(value: float | None, form: str = ".2f") -> str:
    return "–" if value is None else format(value, form)


def header(*columns: str) -> list[str]:
    return [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
