"""Reads and writes docs/coverage.md, which is the only store of verdicts: a run replaces those of its Blender."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PATH = ROOT / "docs" / "coverage.md"

HOSTS = {"3.4": "3.4", "bpy45": "4.5", "bpy50": "5.0", "bpy52": "5.2"}
"""The Blenders by the names of the test runner, and the heads of their columns."""

VERDICTS = {
    "agrees": "the pictures agree",
    "no effect": "they agree, and Cycles renders the same without the feature: it ignores it, or the scene does",
    "falls back": "Gradus renders something else, or nothing, and says so",
    "differs": "the pictures differ without a warning",
    "missing": "Cycles has a pass that Gradus does not have",
    "fails": "Gradus crashes, hangs or stops with an error of no clear meaning",
    "not shown": "the scene cannot be made, or Cycles cannot render it",
}

AGREEMENT = frozenset({"agrees", "no effect"})

UNSUPPORTED = (
    "ShaderNodeVolume*",
    "ShaderNodeOutput*.inputs[[]Volume]",
    "ShaderNodeBsdfHair*",
    "ShaderNodeTexPointDensity*",
    "Object type CURVES",
    "Object type POINTCLOUD",
    "Object type VOLUME",
    "Particles HAIR PATH",
)
"""Names of rows about volumes, hair, curves and points, which Gradus does not render."""

HEAD = """# What Gradus renders as Cycles does

Each line is a feature that Blender's own description of its types (RNA) lists: a value of a property, an input that
varies over a surface, an output, a kind of object. `make coverage` renders a scene of 48×32 pixels for each with Gradus
and with Cycles of the same Blender, and writes this page; `make coverage HOSTS=bpy45 ROWS='ShaderNodeMath*'` renders
some of them again. Pictures agree if 95 % of the blocks of 8×8 pixels are within 2 % and the mean is within 1 %. A part
of the lines is rendered in every test run and must keep its verdict. A cell is empty where a version does not have the
feature, or was not rendered since the line is there. Numbers lead to the notes at the end.
"""


@dataclass
class Cell:
    verdict: str
    note: str = ""


@dataclass
class Document:
    """Verdicts by family, row and host."""

    cells: dict[str, dict[str, dict[str, Cell]]] = field(default_factory=dict)

    def put(self, host: str, outcome: dict[str, Any]) -> None:
        rows = self.cells.setdefault(outcome["family"], {})
        rows.setdefault(outcome["name"], {})[host] = Cell(outcome["verdict"], outcome["note"])

    def forget(self, host: str) -> None:
        """Removes all verdicts of a host, and rows that no host has."""
        for family, rows in self.cells.items():
            for by_host in rows.values():
                by_host.pop(host, None)
            self.cells[family] = {name: by_host for name, by_host in rows.items() if by_host}

    def verdicts(self, host: str) -> dict[str, str]:
        return {
            name: by_host[host].verdict
            for rows in self.cells.values()
            for name, by_host in rows.items()
            if host in by_host
        }

    def share(self, host: str, left_out: Collection[str] = ()) -> float:
        """Returns the share of rows that agree, of those that can be shown. left_out: patterns of names."""
        shown = [
            verdict
            for name, verdict in self.verdicts(host).items()
            if verdict != "not shown" and not any(fnmatchcase(name, pattern) for pattern in left_out)
        ]
        return sum(verdict in AGREEMENT for verdict in shown) / max(len(shown), 1)

    def text(self) -> str:
        hosts = [host for host in HOSTS if self.verdicts(host)]
        notes = Notes()
        parts = [HEAD, self._totals(hosts)]
        for family, rows in self.cells.items():
            if rows:
                parts.append(f"## {family}\n\n{_table(rows, hosts, notes)}")
        return "\n".join([*parts, notes.text()])

    def _totals(self, hosts: list[str]) -> str:
        counts = {host: Counter(self.verdicts(host).values()) for host in hosts}
        lines = [f"| | {' | '.join(HOSTS[host] for host in hosts)} | |", "|---|" + "---:|" * len(hosts) + "---|"]
        for verdict, meaning in VERDICTS.items():
            numbers = " | ".join(str(counts[host][verdict]) for host in hosts)
            lines.append(f"| {verdict} | {numbers} | {meaning} |")
        lines.append(f"| **all** | {' | '.join(str(sum(counts[host].values())) for host in hosts)} | |")
        for left_out, rows in (
            ((), "all lines"),
            (UNSUPPORTED, "lines that are not about volumes, hair, curves or points"),
        ):
            shares = " | ".join(f"{self.share(host, left_out):.1%}" for host in hosts)
            lines.append(f"| **share** | {shares} | of {rows}, those that agree, among those that can be shown |")
        return "\n".join(lines) + "\n"


class Notes:
    """Numbers the texts that cells refer to."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}

    def number(self, text: str) -> int:
        return self._numbers.setdefault(text, len(self._numbers) + 1)

    def text(self) -> str:
        lines = [f"{number}. {text}" for text, number in self._numbers.items()]
        return "## Notes\n\nWhat Gradus said, or how pictures differ.\n\n" + "\n".join(lines) + "\n"


def _table(rows: dict[str, dict[str, Cell]], hosts: list[str], notes: Notes) -> str:
    lines = [f"| feature | {' | '.join(HOSTS[host] for host in hosts)} |", "|---|" + "---|" * len(hosts)]
    for name, by_host in rows.items():
        cells = (_cell(by_host.get(host), notes) for host in hosts)
        lines.append(f"| `{name}` | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(cell: Cell | None, notes: Notes) -> str:
    if cell is None:
        return ""
    return f"{cell.verdict} {notes.number(_line(cell.note))}" if cell.note else cell.verdict


def _line(text: str) -> str:
    return " ".join(text.replace("|", "/").split())


def read(path: Path = PATH) -> Document:
    """Returns the document that write() wrote, or an empty one if there is none."""
    document = Document()
    if not path.exists():
        return document
    text = path.read_text()
    notes = dict(re.findall(r"^(\d+)\. (.+)$", text.partition("\n## Notes\n")[2], re.MULTILINE))
    heads = {title: host for host, title in HOSTS.items()}
    family, hosts = "", []
    for line in text.splitlines():
        if line.startswith("## "):
            family = line.removeprefix("## ")
        elif line.startswith("| feature |"):
            hosts = [heads[title.strip()] for title in line.split("|")[2:-1]]
        elif line.startswith("| `"):
            name, *cells = (part.strip() for part in line.split("|")[1:-1])
            for host, cell in zip(hosts, cells, strict=True):
                if cell:
                    verdict, number = re.fullmatch(r"([a-z ]+?)(?: (\d+))?", cell).groups()
                    note = notes.get(number, "")
                    document.put(host, {"family": family, "name": name.strip("`"), "verdict": verdict, "note": note})
    return document


def write(document: Document, path: Path = PATH) -> None:
    path.write_text(document.text())
